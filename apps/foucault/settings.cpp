#include "settings.h"

#include "foucault/rawlog/recording_notes.h"

namespace foucault::app {

void OutputOptions::fields(ConfigFields& f) {
  f.text("rate", rate, {"epochs", "imu"},
         "rows of the solution: at GNSS epochs, or at IMU samples too");
  f.number("statistics_from_s", statistics_from_s, kNotNegative,
           "statistics in metrics.json begin this long after the first fix");
}

void VehicleOptions::fields(ConfigFields& f) {
  f.text("kind", kind, {"auto", "car", "any"},
         "car: its wheels do not slip sideways; any: nothing is assumed; auto: the recording shows "
         "it");
}

navigation::EpochRate OutputOptions::epoch_rate() const {
  return rate == "imu" ? navigation::EpochRate::imu : navigation::EpochRate::epochs;
}

Settings::Settings() {
  aids.zero_velocity = aids.nonholonomic = aids.wheel_speed = aids.heading = "auto";
}

Settings Settings::of_paper() {
  Settings settings;
  settings.aids.mode = settings.calibrate.mode = "none";
  return settings;
}

void Settings::fields(ConfigFields& f) {
  f.section("imu", imu, "noise of the IMU, and how its samples are to be read");
  f.section("alignment", alignment, "initial attitude");
  f.section("gnss", gnss, "which fixes are used, and how much they are trusted");
  f.section("gaps", gaps, "holes in the IMU stream");
  f.section("vehicle", vehicle, "what moves");
  f.section("aids", aids, "what is measured beside positions");
  f.section("calibrate", calibrate, "what is estimated beside the biases");
  f.section("fgo", fgo, "factor graph: methods refined, rough, full and batch");
  f.section("batch", batch, "method batch");
  f.section("ekf", ekf, "Kalman filter: methods ekf and rts");
  f.section("rawlog", rawlog, "what is taken from a log with several sensors");
  f.section("outages", outages, "simulated outages: commands evaluate and tune");
  f.section("output", output, "what is written");
}

namespace {

/// Where the notes do not tell it, one that is there was given by somebody.
bool lever_arm_is_known(const std::string& log, const rawlog::RecordingNotes& notes,
                        const Settings& settings) {
  if (notes.lever_arm != "not_told") return notes.lever_arm == "given";
  return !rawlog::RawlogSource(log, imu::SampleKind::interval_mean, settings.rawlog)
              .lever_arm()
              .isZero();
}

}  // namespace

Settings settings_for(const std::string& log, const Settings& settings) {
  Settings completed = settings;
  const rawlog::RecordingNotes notes = rawlog::read_notes(log);
  completed.imu = settings.imu.completed_by(notes.imu);
  constexpr double kGivenLeverArm = 0.05;  // [m]
  constexpr double kUnknownLeverArm = 1;
  std::optional<double>& sigma = completed.calibrate.lever_arm_sigma_m;
  if (!sigma && settings.calibrate.lever_arm != "off") {
    sigma = lever_arm_is_known(log, notes, settings) ? kGivenLeverArm : kUnknownLeverArm;
  }
  completed.rawlog.fix_delay_s = completed.calibrate.time_offset_s;
  measurement::AidOptions& aids = completed.aids;
  const std::string rolls = settings.vehicle.kind == "car" ? "on" : "off";
  if (settings.vehicle.kind != "auto" && aids.nonholonomic == "auto") aids.nonholonomic = rolls;
  if (settings.vehicle.kind == "any" && aids.wheel_speed == "auto") aids.wheel_speed = "off";
  return completed;
}

std::string settings_help() {
  Settings settings;
  return describe_config(settings);
}

}  // namespace foucault::app
