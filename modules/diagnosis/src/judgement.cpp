#include "foucault/diagnosis/judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/core/time_mismatch.h"
#include "foucault/diagnosis/side_facts.h"

namespace foucault::diagnosis {
namespace {

constexpr double kAgree = 0.9;  // of correlations, as in turn_match.cpp

/// Collects findings.
class Judgement {
 public:
  void ok(const std::string& subject, const std::string& text) {
    findings.push_back({Severity::ok, subject, text, ""});
  }
  void warn(const std::string& subject, const std::string& text, const std::string& remedy) {
    findings.push_back({Severity::warning, subject, text, remedy});
  }
  void error(const std::string& subject, const std::string& text, const std::string& remedy) {
    findings.push_back({Severity::error, subject, text, remedy});
  }
  bool has_error() const {
    return std::any_of(findings.begin(), findings.end(),
                       [](const Finding& f) { return f.severity == Severity::error; });
  }
  std::vector<Finding> findings;
};

double length(const StreamFacts& stream) {
  return seconds_between(stream.first_ns, stream.last_ns);
}

void judge_stream(const StreamFacts& stream, const std::string& name, double longest_harmless,
                  Judgement& out) {
  if (stream.count == 0) {
    return out.error(name, "no data", "import a recording that has them");
  }
  const std::string text = fmt::format(
      "{} in {:.1f} s, one every {:.4g} s, {} holes, the longest {:.3g} s", stream.count,
      length(stream), stream.interval_s, stream.holes, stream.longest_hole_s);
  if (stream.longest_hole_s > longest_harmless) {
    out.warn(name, text, "look for lost data; results are worse after holes");
  } else if (stream.interval_s > longest_harmless) {
    out.warn(name, text, "record more often; results are worse between stamps so far apart");
  } else {
    out.ok(name, text);
  }
}

void judge_samples(const LogFacts& facts, Judgement& out) {
  for (const std::string& line : facts.bad_fixes) {
    out.warn(kFixesSubject, line,
             "`foucault run` does without; find out why the receiver writes them");
  }
  for (const std::string& line : facts.bad_samples) {
    out.warn(kSamplesSubject, line, "`foucault run` bridges what is missing; find out why it is");
  }
}

void judge_overlap(const LogFacts& facts, Judgement& out) {
  if (facts.imu.count == 0 || facts.gnss.count == 0) return;
  const double later = seconds_between(facts.imu.first_ns, facts.gnss.first_ns);
  if (facts.overlap_s <= 0) {
    return out.error("overlap", "IMU and GNSS have no time in common",
                     "GNSS begins " + describe_mismatch(later));
  }
  const std::string text = fmt::format("{:.1f} s in common", facts.overlap_s);
  if (facts.overlap_s < 0.5 * std::min(length(facts.imu), length(facts.gnss))) {
    return out.warn("overlap", text, "GNSS begins " + describe_mismatch(later));
  }
  out.ok("overlap", text);
}

/// Receivers gave GPS weeks modulo 1024, and tables still do. Clocks that begin before GPS did
/// count from their start, or were never set, and mean no date.
void judge_date(const LogFacts& facts, Judgement& out) {
  constexpr int64_t kYear2000Ns = 946'684'800 * kNanosecondsPerSecond;
  constexpr int64_t kRound = 1024;  // weeks
  const int64_t first_ns = facts.imu.count > 0 ? facts.imu.first_ns : facts.gnss.first_ns;
  if (first_ns < kGpsEpochNs || first_ns >= kYear2000Ns) return;
  const int64_t round_ns = kRound * kNanosecondsPerWeek;
  out.warn("date",
           fmt::format("the recording is of {}, or of {} or {} if its GPS weeks are modulo 1024",
                       utc_text(first_ns), utc_text(first_ns + round_ns),
                       utc_text(first_ns + 2 * round_ns)),
           "add 1024 or 2048 to the weeks of the import, unless the date is right");
}

void judge_reference(const LogFacts& facts, Judgement& out) {
  const ReferenceFacts& reference = facts.reference;
  if (reference.compared == 0) return;
  const std::string text =
      fmt::format("{:.4g} m (RMS) from fixes, lever arm{} included, {} poses", reference.rms_m,
                  reference.moved ? "" : " and half a second of motion", reference.compared);
  if (2 * reference.far <= reference.compared) return out.ok("reference", text);
  out.warn("reference", text + "; a run is not compared with it",
           "correct columns and units of the reference in the import");
}

void judge_sigmas(const LogFacts& facts, Judgement& out) {
  if (facts.sigmas.bad > 0) {
    out.warn("sigmas",
             fmt::format("{} of {} fixes have a sigma that is zero, negative or not finite",
                         facts.sigmas.bad, facts.gnss.count),
             "give sigmas in the import, or gnss.sigma_floor_m");
  }
  if (facts.sigmas.bad == facts.gnss.count) return;
  const std::string range =
      fmt::format("horizontal {:.3g} to {:.3g} m", facts.sigmas.smallest_m, facts.sigmas.largest_m);
  if (facts.sigmas.smallest_m < 0.001 || facts.sigmas.largest_m > 1000) {
    return out.warn("sigmas", range + ", which no receiver has",
                    "correct their unit in the import");
  }
  if (facts.rest.fix_pairs >= 20 && facts.rest.fix_scatter > 3) {
    return out.warn("sigmas",
                    fmt::format("{}; at rest fixes scatter {:.1f} times as much", range,
                                facts.rest.fix_scatter),
                    fmt::format("gnss.sigma_scale={:.0f}", std::ceil(facts.rest.fix_scatter)));
  }
  out.ok("sigmas", range);
}

/// What the velocities must be for the way to be k times as long.
std::string velocity_remedy(const VelocityFacts& v) {
  struct Unit {
    double scale;
    const char* remedy;
  };
  constexpr Unit kUnits[] = {{1852.0 / 3600, "velocity_unit: knots"},
                             {1 / 3.6, "velocity_unit: km_h"},
                             {0.01, "velocity_unit: cm_s"},
                             {0.001, "velocity_unit: mm_s"}};
  constexpr double kNear = 0.1;
  if (!v.mirrored && std::abs(v.angle) < kNear) {
    for (const Unit& unit : kUnits) {
      if (std::abs(v.scale / unit.scale - 1) < kNear) {
        return fmt::format("gnss: {{{}}} in the import's mapping", unit.remedy);
      }
    }
  }
  return "correct columns, signs and unit of the velocities in the import, or latitude and "
         "longitude; else leave them out of the import (gnss: {velocity: false} in its mapping)";
}

std::string velocity_text(const VelocityFacts& v) {
  std::string text = fmt::format(
      "the way between fixes is {:.3g} times as long as their "
      "velocities make it",
      v.scale);
  const double degrees = v.angle / kDegree;
  if (v.mirrored && std::abs(std::abs(degrees) - 90) < 10) {
    return text + ", and north and east seem to be exchanged";
  }
  if (v.mirrored) return text + ", and mirrored: a sign is wrong";
  return text + fmt::format(", {:.0f} deg to the right of them", degrees);
}

/// Velocities that are not used do no harm, but say what the import makes of the file.
void judge_velocities(const LogFacts& facts, Judgement& out) {
  constexpr int64_t kEnough = 20;
  constexpr double kHarmless = 0.1;  // chosen: latencies and filters of receivers make less of it
  constexpr double kSigmas = 5;
  const VelocityFacts& v = facts.velocities;
  if (v.pairs < kEnough || v.sigma > kHarmless) return;
  const double off = std::max({std::abs(v.scale - 1), std::abs(v.angle), v.mirrored ? 1.0 : 0.0});
  if (off < std::max(kHarmless, kSigmas * v.sigma)) return out.ok("velocities", velocity_text(v));
  out.warn("velocities", velocity_text(v), velocity_remedy(v));
}

void judge_lever_arm(const LogFacts& facts, Judgement& out) {
  if (!facts.lever_arm_m) return;
  const std::string text = fmt::format("{:.3f} m", *facts.lever_arm_m);
  if (!facts.lever_arm_known) {
    out.warn("lever arm", "not known, zero is taken", "give it in the import (--lever-arm X,Y,Z)");
  } else if (*facts.lever_arm_m > 10) {
    out.warn("lever arm", text, "is it in metres, and from the IMU to the antenna?");
  } else {
    out.ok("lever arm", text);
  }
}

void judge_density(const std::string& name, const std::string& key, double measured,
                   double configured, double unit, const std::string& unit_name, Judgement& out) {
  const double ratio = measured / configured;
  const std::string text = fmt::format("{:.3g} {} at rest, {:.3g} configured", measured / unit,
                                       unit_name, configured / unit);
  if (ratio > 3) {
    out.warn(
        name, text,
        fmt::format("{}={:.2g}, or the preset of this IMU (auto: learned)", key, measured / unit));
  } else if (ratio < 0.1) {
    out.warn(name, text, "the configuration is of a much worse IMU; choose its own preset");
  } else {
    out.ok(name, text);
  }
}

/// Densities that the whole recording has shown are not held against what shakes it at rest.
void judge_noise(const LogFacts& facts, const imu::ImuNoise& configured, Judgement& out) {
  constexpr int64_t kEnough = 10;  // [s]; the median of ten differences is known to 40 %
  if (facts.rest.seconds < kEnough) {
    return out.ok("IMU noise", fmt::format("{} s of rest, too little to tell", facts.rest.seconds));
  }
  if (!configured.learned) {
    judge_density("gyroscope noise", "imu.arw_deg_sqrt_h", facts.rest.gyro_noise_density,
                  configured.gyro_noise_density, kDegree / 60, "deg/sqrt(h)", out);
    judge_density("accelerometer noise", "imu.vrw_m_s_sqrt_h", facts.rest.accel_noise_density,
                  configured.accel_noise_density, 1.0 / 60, "m/s/sqrt(h)", out);
  }
  constexpr double kEarthRate = 7.3e-5;
  const double expected = std::hypot(configured.gyro_bias_sigma, configured.gyro_turn_on_sigma);
  const std::string bias =
      fmt::format("{:.3g} deg/h at rest, {:.3g} deg/h configured",
                  facts.rest.gyro_mean / kDegree * 3600, expected / kDegree * 3600);
  const double noise = configured.gyro_noise_density / std::sqrt(facts.rest.seconds);
  constexpr double kSettling = 5e-6;  // 1 deg/h, of a vehicle at rest; chosen
  if (facts.rest.gyro_mean > 5 * std::hypot(expected, noise) + kEarthRate + kSettling) {
    out.warn("gyroscope bias", bias,
             fmt::format("imu.gyro_turn_on_deg_h={:.0f}",
                         std::ceil(facts.rest.gyro_mean / kDegree * 3600)));
  } else {
    out.ok("gyroscope bias", bias);
  }
}

/// Drift that changes is what a bias does by itself; more than that no filter expects.
/// Where units or axes are wrong, rates are none.
void judge_rate(const LogFacts& facts, const imu::ImuNoise& configured, Judgement& out) {
  constexpr double kSeveral = 3;
  const CommutationFacts& c = facts.commutation;
  if (c.seconds == 0 || out.has_error()) return;
  const std::string text = fmt::format(
      "rotations between samples cost {:.2g} deg/h and {:.2g} deg/sqrt(h) at least (the gyroscopes "
      "have {:.2g} and {:.2g}), one every {:.4g} s",
      c.drift / kDegree * 3600, c.random / kDegree * 60,
      configured.gyro_bias_sigma / kDegree * 3600, configured.gyro_noise_density / kDegree * 60,
      facts.imu.interval_s);
  const bool drifts = c.drift > kSeveral * configured.gyro_bias_sigma;
  if (drifts || c.random > kSeveral * configured.gyro_noise_density) {
    return out.warn("IMU rate", text,
                    "record the IMU faster or damp its vibration; attitude is worse than its "
                    "sigmas say");
  }
  out.ok("IMU rate", text);
}

void judge_force(const LogFacts& facts, Judgement& out) {
  if (facts.imu.count == 0) return;
  if (const std::optional<WrongForce> wrong = wrong_force(facts.force)) {
    return out.error("specific force", wrong->text, wrong->remedy);
  }
  const Eigen::Vector3d& f = facts.force.mean;
  std::string text =
      fmt::format("mean {:.2f}, {:.2f}, {:.2f} m/s^2 forward, right, down", f.x(), f.y(), f.z());
  if (facts.force.factor) {
    text += fmt::format("; {:.3f} (sigma {:.3f}) times what gravity and motion make it",
                        facts.force.factor->value, facts.force.factor->sigma);
  }
  const bool has_direction = f.norm() > 0.5 * facts.force.length;  // else it rolls and loops
  if (has_direction && -f.z() <= 0.5 * f.norm()) {
    const std::optional<WrongForce> side =
        facts.turns ? wrong_side(*facts.turns, facts.accelerations, f) : std::nullopt;
    const bool is_sign = is_upside_down(f) && side;
    out.error("gravity", text + ": up is not up",
              is_sign ? side->remedy : "correct the axes of the import");
  } else {
    out.ok("gravity", text);
  }
}

void judge_axes(const LogFacts& facts, Judgement& out) {
  constexpr double kClear = 0.6;  // of the correlation; chosen: less is a vehicle of its own ways
  constexpr double kSideways = 45 * kDegree;
  if (facts.turns) {
    if (const auto side = wrong_side(*facts.turns, facts.accelerations, facts.force.mean)) {
      const bool is_gross = std::abs(facts.turns->correlation) > kAgree;
      return is_gross ? out.error("axes", side->text, side->remedy)
                      : out.warn("axes", side->text, side->remedy);
    }
  }
  if (!facts.accelerations)
    return out.ok("axes", "the fixes do not tell accelerations well enough to judge");
  const AccelerationFit& fit = *facts.accelerations;
  const double angle = fit.angle.value;
  const std::string text = fmt::format(
      "forces are {:.0f} deg (sigma {:.0f}) to the {} of accelerations by fixes, correlation "
      "{:.2f}",
      std::abs(angle) / kDegree, fit.angle.sigma / kDegree, angle >= 0 ? "right" : "left",
      fit.correlation);
  const bool is_clear = fit.correlation > kClear && !fit.mirrored &&
                        std::abs(angle) > kSideways + 3 * fit.angle.sigma;
  if (!is_clear) return out.ok("axes", text);
  const bool is_backward = std::abs(angle) > kPi - kSideways;
  out.warn("axes", text,
           is_backward ? "forward is backward; correct the axes of the import, unless the vehicle "
                         "went backward"
                       : "forward is sideways; correct the axes of the import, unless the vehicle "
                         "goes where it does not point");
}

/// Turns alone see an IMU ahead of the axle, slip of tyres, steps and a reversal as an offset of
/// tenths of a second; forces do not. An
/// antenna ahead of where it is said to be looks like one to both: if nothing is said of it, turns,
/// which know that arm as well as they can, must see the offset too.
bool is_late(const LogFacts& facts, const std::optional<Measured>& by_forces) {
  constexpr double kHarmless = 0.04;  // [s]; a lever arm wrong by 0.4 m at 10 m/s
  /// What tyres that slip by 4 mrad per m/s^2 make of turns at 10 m/s.
  constexpr double kSlip = 0.1;  // [s]
  constexpr double kSure = 3;    // sigmas
  const TurnMatch& turns = *facts.turns;
  if (!by_forces) return false;
  if (std::abs(by_forces->value) < kHarmless + kSure * by_forces->sigma) return false;
  // An arm that is told wrongly is seen by forces alone, or by turns the other way.
  if (turns.offset_s * by_forces->value <= 0) return false;
  if (std::abs(turns.offset_s) > kSure * turns.offset_sigma_s) return true;
  const double apart = std::abs(by_forces->value - turns.offset_s);
  const bool go_together =
      apart < kSlip + kSure * std::hypot(by_forces->sigma, turns.offset_sigma_s);
  return go_together && facts.lever_arm_m.value_or(0) > 0;
}

std::string describe_offset(const Measured& offset) {
  return fmt::format("{:.3f} s (sigma {:.3f}) {} those of GNSS", std::abs(offset.value),
                     offset.sigma, offset.value >= 0 ? "after" : "before");
}

std::string describe_turns(const TurnMatch& match, const std::optional<Measured>& by_forces) {
  std::string text = "stamps of the IMU are ";
  if (by_forces) text += describe_offset(*by_forces) + " by accelerations, ";
  text += describe_offset({match.offset_s, match.offset_sigma_s}) + " by turns";
  text += fmt::format("; {} courses, correlation {:.3f}, gyroscopes turn {:.3f} times as much",
                      match.samples, match.correlation, match.slope);
  if (match.gyro_factor) {
    text += fmt::format(", in gentle turns {:.3f} (sigma {:.3f})", match.gyro_factor->value,
                        match.gyro_factor->sigma);
  }
  if (match.drift) {
    text += fmt::format(", the offset grows by {:.0f} ppm (sigma {:.0f})", 1e6 * match.drift->value,
                        1e6 * match.drift->sigma);
  }
  return text;
}

/// A clock that runs fast; crystals are within 100 ppm. Short recordings, in which the vehicle may
/// have changed its ways, and 50 ms are a drift of more, tell nothing of it.
void judge_drift(const TurnMatch& match, Judgement& out) {
  constexpr double kHarmless = 50e-6, kLargestSigma = 50e-6, kSure = 4;
  if (!match.drift || match.drift->sigma > kLargestSigma) return;
  if (std::abs(match.drift->value) < kHarmless + kSure * match.drift->sigma) return;
  out.warn("clock drift",
           fmt::format("the offset of the IMU's stamps grows by {:.0f} ppm (sigma {:.0f})",
                       1e6 * match.drift->value, 1e6 * match.drift->sigma),
           "one of the clocks runs fast: correct the stamps by that before the import");
}

/// A bank makes the turns about the vehicle's vertical less, and nothing makes them more. Left
/// alone, 3 % cost metres beside fixes of centimetres.
void judge_gyro_scale(const TurnMatch& match, Judgement& out) {
  constexpr double kHarmless = 0.02, kSure = 5;
  const std::optional<MeasuredFactor>& factor = match.gyro_factor;
  if (!factor || !match.is_enough() || factor->value < 1 + kHarmless + kSure * factor->sigma)
    return;
  out.warn("gyroscope scale",
           fmt::format("the gyroscopes turn {:.3f} (sigma {:.3f}) times as much as the course",
                       factor->value, factor->sigma),
           fmt::format("calibrate.gyro_scale=on with calibrate.gyro_scale_sigma_ppm={:.0f}",
                       std::ceil((factor->value - 1) * 1e6)));
}

void judge_turns(const LogFacts& facts, Judgement& out) {
  constexpr double kMisfit = 3;  // rms of what is left, in sigmas
  if (!facts.turns) return out.ok("time offset", "too few turns to tell");
  const TurnMatch& match = *facts.turns;
  if (const std::optional<std::string> wrong = gross_mismatch(match, facts.gnss.first_ns)) {
    return out.error("time offset", *wrong, "see there");
  }
  if (turns_against(match)) return;  // see judge_axes
  if (match.correlation < kAgree) {
    const std::string text = fmt::format(
        "courses of GNSS and turns of the gyroscopes: correlation {:.2f} in {} courses, {:.1f} "
        "sigmas apart",
        match.correlation, match.samples, match.misfit);
    const bool is_small = match.misfit < kMisfit;
    return out.ok("turns", text + (is_small ? ", too small to tell more"
                                            : ": the vehicle goes where it does not point, or the "
                                              "fixes have outliers"));
  }
  std::optional<Measured> of_forces;
  if (facts.accelerations && !facts.accelerations->mirrored &&
      facts.accelerations->correlation > kAgree) {
    of_forces = facts.accelerations->offset_s;
  }
  const std::string text = describe_turns(match, of_forces);
  judge_drift(match, out);
  judge_gyro_scale(match, out);
  if (!is_late(facts, of_forces)) return out.ok("time offset", text);
  const double offset = of_forces ? of_forces->value : match.offset_s;
  out.warn("time offset", text,
           fmt::format("imu: {{time: {{offset_s: {:.3f}}}}} in the import's mapping", -offset));
}

}  // namespace

std::vector<Finding> judge(const LogFacts& facts, const imu::ImuNoise& configured) {
  // Chosen: a turn of 6 deg may be missed in the one; the driver of a run doubts the state, and a
  // consumer IMU drifts by metres, in the other.
  constexpr double kImuHole = 0.1, kGnssHole = 30;  // [s]
  Judgement out;
  judge_stream(facts.imu, "IMU", kImuHole, out);
  judge_stream(facts.gnss, "GNSS", kGnssHole, out);
  judge_samples(facts, out);
  judge_overlap(facts, out);
  judge_date(facts, out);
  judge_reference(facts, out);
  judge_sigmas(facts, out);
  judge_velocities(facts, out);
  judge_lever_arm(facts, out);
  judge_force(facts, out);
  judge_axes(facts, out);
  judge_turns(facts, out);
  judge_noise(facts, configured, out);
  judge_rate(facts, configured, out);
  return out.findings;
}

}  // namespace foucault::diagnosis
