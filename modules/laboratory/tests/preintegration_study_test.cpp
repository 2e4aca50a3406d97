#include "foucault/laboratory/preintegration_study.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "foucault/core/error.h"

namespace foucault::laboratory {
namespace {

constexpr double kRate = 200;  // [Hz]

StudyPlan short_plan() {
  StudyPlan plan;
  plan.durations_s = {0.1, 1};
  plan.rates_hz = {kRate};
  plan.fine_rates_hz = {};
  return plan;
}

MotionStudy study_of(const std::string& name, const StudyPlan& plan, int intervals) {
  const PreintegrationStudy study(lab_motion(name), plan);
  std::vector<PreintegrationStudy::Record> records;
  for (int i = 0; i < intervals; ++i) records.push_back(study.measure(i));
  return study.summarize(records);
}

MotionError rms(const MotionStudy& study, LabGroup group, const std::string& name, double T = 1) {
  return find_row(study, group, name, kRate, T).rms;
}

// The claim of the laboratory: over 1 s at 200 Hz the error of `full` is the increments' own
// discretization. The rest is the turning of gravity's gradient, at most 28 nm/s at 250 m/s.
TEST(PreintegrationStudy, FullIsAtTheLevelOfTheIncrements) {
  for (const char* name : {"vibration", "airliner"}) {
    const MotionStudy study = study_of(name, short_plan(), 4);
    const MotionError full = rms(study, LabGroup::model, "full");
    const MotionError floor = rms(study, LabGroup::model, "discretization");
    EXPECT_NEAR(full.position, floor.position, 0.01 * floor.position) << name;
    EXPECT_NEAR(full.attitude, floor.attitude, 0.05 * floor.attitude + 1e-15) << name;
    EXPECT_NEAR(full.velocity, floor.velocity, 0.01 * floor.velocity + 2.8e-8) << name;
    EXPECT_GT(rms(study, LabGroup::model, "rough_local").position, 50 * floor.position) << name;
    EXPECT_GT(rms(study, LabGroup::model, "refined").position, 50 * floor.position) << name;
  }
}

TEST(PreintegrationStudy, RefinedLosesWithDistance) {
  StudyPlan plan = short_plan();
  plan.origin_distances_km = {100};
  const MotionStudy study = study_of("motorway", plan, 2);
  const double expected = 9.79 * 1e5 / 6.371e6 / 2;  // g d/R T^2/2
  EXPECT_NEAR(rms(study, LabGroup::distance, "refined").position, expected, 0.01 * expected);
}

TEST(PreintegrationStudy, ModelsDifferAsTheyAreDefined) {
  const MotionStudy study = study_of("motorway", short_plan(), 3);
  const MotionError rough = rms(study, LabGroup::model, "rough_local");
  EXPECT_NEAR(rough.attitude, 7.292115e-5, 1e-9);
  const MotionError coriolis = rms(study, LabGroup::ablation, "coriolis");
  const MotionError rotation = rms(study, LabGroup::ablation, "earth_rotation");
  EXPECT_LT(rough.position, coriolis.position + rotation.position);
  const MotionError refined = rms(study, LabGroup::model, "refined_local");
  const MotionError change = rms(study, LabGroup::ablation, "gravity_change");
  EXPECT_NEAR(refined.velocity, change.velocity, 1e-3 * change.velocity);
}

TEST(PreintegrationStudy, NoiseIsThatOfThePreset) {
  const MotionStudy study = study_of("city", short_plan(), 1);
  const imu::ImuNoise noise = imu::imu_preset("ADIS16465");
  // Three axes of angular random walk; the bias wanders by far less in 1 s.
  EXPECT_NEAR(rms(study, LabGroup::noise, "ADIS16465").attitude,
              noise.gyro_noise_density * std::sqrt(3.0), 1e-3 * noise.gyro_noise_density);
  EXPECT_GT(rms(study, LabGroup::noise, "ICM20602").position,
            rms(study, LabGroup::noise, "navigation").position);
}

TEST(PreintegrationStudy, SummaryIsTheRootMeanSquare) {
  const PreintegrationStudy study(lab_motion("city"), short_plan());
  const PreintegrationStudy::Record one = study.measure(0);
  PreintegrationStudy::Record seven = one;
  seven.rows[0].rms.position = 7 * one.rows[0].rms.position;
  const MotionStudy summary = study.summarize({one, seven});
  EXPECT_EQ(summary.intervals, 2);
  EXPECT_NEAR(summary.rows[0].rms.position, 5 * one.rows[0].rms.position,
              1e-12 * one.rows[0].rms.position);
  EXPECT_NEAR(summary.rows[0].rms.attitude, one.rows[0].rms.attitude, 1e-15);
}

TEST(PreintegrationStudy, FineRatesAreOfTheShortDuration) {
  StudyPlan plan = short_plan();
  plan.fine_rates_hz = {1000, 2000};
  plan.fine_duration_s = 0.1;
  const MotionStudy study = study_of("vibration", plan, 1);
  const double coarse = find_row(study, LabGroup::model, "full", 1000, 0.1).rms.attitude;
  const double fine = find_row(study, LabGroup::model, "full", 2000, 0.1).rms.attitude;
  EXPECT_GT(coarse / fine, 12);  // coning leaves an error of fourth order, 16
  EXPECT_THROW(find_row(study, LabGroup::model, "full", 2000, 1), std::out_of_range);
}

TEST(PreintegrationStudy, RefusesWhatDoesNotFit) {
  StudyPlan plan = short_plan();
  plan.durations_s = {0.1234};
  EXPECT_THROW(PreintegrationStudy(lab_motion("city"), plan), std::invalid_argument);
  EXPECT_THROW(lab_motion("boat"), UsageError);
}

}  // namespace
}  // namespace foucault::laboratory
