#include "foucault/diagnosis/log_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "foucault/core/time.h"
#include "foucault/core/time_mismatch.h"
#include "foucault/diagnosis/fix_guard.h"
#include "foucault/diagnosis/force_match.h"
#include "foucault/diagnosis/imu_guard.h"
#include "foucault/diagnosis/plausibility.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::diagnosis {
namespace {

using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kDegree = 0.0174532925199432958;
constexpr double kStandardGravity = 9.80665;
constexpr std::size_t kRemembered = 1000;

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The first values of a stream, for their median.
class Sample {
 public:
  void add(double value) {
    if (values_.size() < kRemembered) values_.push_back(value);
  }
  double median() const { return diagnosis::median(values_); }
  bool full() const { return values_.size() == kRemembered; }
  std::size_t size() const { return values_.size(); }

 private:
  std::vector<double> values_;
};

/// Holes are counted by the median known so far; it settles within seconds.
class StreamWatch {
 public:
  void add(int64_t t_ns) {
    if (facts_.count++ == 0) {
      facts_.first_ns = facts_.last_ns = t_ns;
      return;
    }
    const double interval = seconds_between(facts_.last_ns, t_ns);
    if (interval <= 0) return;
    facts_.last_ns = t_ns;
    if (!intervals_.full()) {
      intervals_.add(interval);
      if (intervals_.size() < 50 || intervals_.size() % 50 == 0) {
        facts_.interval_s = intervals_.median();
      }
    }
    if (interval < 1.5 * facts_.interval_s) return;
    ++facts_.holes;
    facts_.longest_hole_s = std::max(facts_.longest_hole_s, interval);
  }
  const StreamFacts& facts() const { return facts_; }

 private:
  StreamFacts facts_;
  Sample intervals_;
};

/// Allan deviation of both sensors over one time, from means over whole seconds.
class AllanWatch {
 public:
  explicit AllanWatch(int seconds) : seconds_(seconds) {}

  void add(const Vector6d& mean) {
    sum_ += mean;
    if (++filled_ < seconds_) return;
    const Vector6d now = sum_ / seconds_;
    if (before_) {
      const Vector6d step = (now - *before_).cwiseAbs();
      for (std::size_t i = 0; i < 6; ++i) steps_[i].add(step[static_cast<int>(i)]);
    }
    before_ = now;
    sum_.setZero();
    filled_ = 0;
  }

  /// What comes next does not follow on what came before.
  void interrupt() {
    before_.reset();
    sum_.setZero();
    filled_ = 0;
  }

  bool knows() const { return steps_[0].size() >= 5; }

  /// Density of white noise, each axis. The difference of two means has sqrt(2) their sigma;
  /// 0.6745 sigma is the median.
  Vector6d density() const {
    Vector6d density;
    for (std::size_t i = 0; i < 6; ++i) density[static_cast<int>(i)] = steps_[i].median();
    return density * std::sqrt(seconds_ / 2.0) / 0.6745;
  }

 private:
  int seconds_;
  Vector6d sum_ = Vector6d::Zero();
  int filled_ = 0;
  std::optional<Vector6d> before_;
  std::array<Sample, 6> steps_;
};

/// Seconds at rest: means of both sensors and differences of fixes.
class RestWatch {
 public:
  void add(const ImuIncrement& increment) {
    block_.gyro += increment.dtheta_b;
    block_.accel += increment.dvel_b;
    block_.length += increment.dt();
    if (block_.length < 1) return;
    block_.gyro /= block_.length;
    block_.accel /= block_.length;
    end_block();
    block_ = Block();
  }

  void add(const GnssFix& fix) {
    const double sigma = geodesy::horizontal_sigma(fix.position_covariance);
    if (!(sigma > 0)) return;
    if (last_fix_) {
      const double way =
          geodesy::LocalFrame(last_fix_->antenna).to_local(fix.antenna).head<2>().norm();
      last_scatter_ = way / sigma / 2;  // two fixes, two axes
      pending_scatter_.push_back(last_scatter_);
    }
    last_fix_ = fix;
  }

  RestFacts facts() const {
    RestFacts facts;
    facts.seconds = seconds_;
    Vector6d density = allan_[0].density();
    for (const AllanWatch& allan : allan_) {
      if (allan.knows()) density = density.cwiseMin(allan.density());
    }
    facts.gyro_noise_density = density.head<3>().maxCoeff();
    facts.accel_noise_density = density.tail<3>().maxCoeff();
    if (seconds_ > 0) {
      facts.gyro_mean = (gyro_sum_ / static_cast<double>(seconds_)).cwiseAbs().maxCoeff();
    }
    facts.fix_scatter = scatter_.median() / 0.8326;  // of a Rayleigh distribution, over sqrt(2)
    facts.fix_pairs = static_cast<int64_t>(scatter_.size());
    return facts;
  }

 private:
  struct Block {
    Vector3d gyro = Vector3d::Zero(), accel = Vector3d::Zero();
    double length = 0;
  };

  /// At rest the means of three seconds in a row agree, and no fix moves.
  void end_block() {
    constexpr double kSteadyGyro = 0.005;  // [rad/s]
    constexpr double kSteadyAccel = 0.1;   // [m/s^2]
    blocks_.push_back(block_);
    if (blocks_.size() > 4) blocks_.pop_front();
    still_ = blocks_.size() == 4;
    for (const Block& block : blocks_) {
      still_ = still_ && (block.gyro - block_.gyro).cwiseAbs().maxCoeff() < kSteadyGyro &&
               (block.accel - block_.accel).cwiseAbs().maxCoeff() < kSteadyAccel;
    }
    constexpr double kMoving = 15;  // times the scatter that sigmas promise
    still_ = still_ && last_scatter_ < kMoving;
    if (still_) {
      take();
    } else {
      for (AllanWatch& allan : allan_) allan.interrupt();
    }
    pending_scatter_.clear();
  }

  void take() {
    ++seconds_;
    gyro_sum_ += block_.gyro;
    Vector6d mean;
    mean << block_.gyro, block_.accel;
    for (AllanWatch& allan : allan_) allan.add(mean);
    for (const double scatter : pending_scatter_) scatter_.add(scatter);
  }

  Block block_;
  std::deque<Block> blocks_;
  bool still_ = false;
  int64_t seconds_ = 0;
  Vector3d gyro_sum_ = Vector3d::Zero();
  std::array<AllanWatch, 3> allan_{AllanWatch(1), AllanWatch(2), AllanWatch(4)};
  std::optional<GnssFix> last_fix_;
  std::vector<double> pending_scatter_;  ///< of this second
  double last_scatter_ = std::numeric_limits<double>::infinity();
  Sample scatter_;
};

/// Changes of speed between fixes beside the specific force in v over the same time.
class AccelerationMatch {
 public:
  void add(const ImuIncrement& increment, const Eigen::Quaterniond& q_v_b) {
    force_ += (q_v_b * increment.dvel_b).head<2>();
    time_ += increment.dt();
  }

  void add(const GnssFix& fix) {
    if (anchor_ && seconds_between(anchor_->t_ns, fix.t_ns) < 0.95) return;
    const std::optional<GnssFix> before = std::exchange(anchor_, fix);
    const Eigen::Vector2d mean = time_ > 0 ? Eigen::Vector2d(force_ / time_) : force_;
    force_.setZero();
    time_ = 0;
    if (!before || seconds_between(before->t_ns, fix.t_ns) > 2.5) {
      last_speed_.reset();
      return;
    }
    const double dt = seconds_between(before->t_ns, fix.t_ns);
    const double speed =
        geodesy::LocalFrame(before->antenna).to_local(fix.antenna).head<2>().norm() / dt;
    // A change of mean speeds goes with the force about the fix between them.
    if (last_speed_) pair((speed - *last_speed_) / dt, 0.5 * (mean + last_mean_));
    last_speed_ = speed;
    last_mean_ = mean;
  }

  std::optional<Eigen::Vector2d> correlation() const {
    if (n_ < 60) return std::nullopt;
    const double variance = aa_ / n_ - a_ * a_ / (n_ * n_);
    if (variance < 0.04) return std::nullopt;  // (0.2 m/s^2)^2
    const Eigen::Vector2d covariance = af_ / n_ - a_ / n_ * f_ / n_;
    const Eigen::Vector2d of_force = ff_ / n_ - (f_ / n_).cwiseAbs2();
    return Eigen::Vector2d(
        covariance.cwiseQuotient((variance * of_force).cwiseMax(1e-12).cwiseSqrt()));
  }

 private:
  void pair(double acceleration, const Eigen::Vector2d& force) {
    n_ += 1;
    a_ += acceleration;
    aa_ += acceleration * acceleration;
    f_ += force;
    ff_ += force.cwiseAbs2();
    af_ += acceleration * force;
  }

  std::optional<GnssFix> anchor_;
  std::optional<double> last_speed_;
  Eigen::Vector2d force_ = Eigen::Vector2d::Zero(), last_mean_ = Eigen::Vector2d::Zero();
  double time_ = 0, n_ = 0, a_ = 0, aa_ = 0;
  Eigen::Vector2d f_ = Eigen::Vector2d::Zero(), ff_ = Eigen::Vector2d::Zero(),
                  af_ = Eigen::Vector2d::Zero();
};

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
  std::vector<Finding> findings;
};

void judge_stream(const StreamFacts& stream, const std::string& name, double longest_harmless,
                  Judgement& out) {
  if (stream.count == 0) {
    return out.error(name, "no data", "import a recording that has them");
  }
  const double length = seconds_between(stream.first_ns, stream.last_ns);
  const std::string text =
      fmt::format("{} in {:.1f} s, one every {:.4g} s, {} holes, the longest {:.3g} s",
                  stream.count, length, stream.interval_s, stream.holes, stream.longest_hole_s);
  if (stream.longest_hole_s > longest_harmless) {
    out.warn(name, text, "look for lost data; results are worse after holes");
  } else {
    out.ok(name, text);
  }
}

constexpr const char* kSamples = "IMU samples";
constexpr const char* kFixes = "GNSS fixes";

void judge_samples(const LogFacts& facts, Judgement& out) {
  for (const std::string& line : facts.bad_fixes) {
    out.warn(kFixes, line, "`foucault run` does without; find out why the receiver writes them");
  }
  for (const std::string& line : facts.bad_samples) {
    out.warn(kSamples, line, "`foucault run` bridges what is missing; find out why it is");
  }
}

void judge_overlap(const LogFacts& facts, Judgement& out) {
  if (facts.imu.count == 0 || facts.gnss.count == 0) return;
  const double later = seconds_between(facts.imu.first_ns, facts.gnss.first_ns);
  if (facts.overlap_s <= 0) {
    return out.error("overlap", "IMU and GNSS have no time in common",
                     "GNSS begins " + describe_mismatch(later));
  }
  out.ok("overlap", fmt::format("{:.1f} s in common", facts.overlap_s));
}

void judge_sigmas(const LogFacts& facts, Judgement& out) {
  if (facts.bad_sigmas > 0) {
    out.warn("sigmas",
             fmt::format("{} of {} fixes have a sigma that is zero, negative or not finite",
                         facts.bad_sigmas, facts.gnss.count),
             "give sigmas in the import, or gnss.sigma_floor_m");
  }
  if (facts.bad_sigmas == facts.gnss.count) return;
  const std::string range =
      fmt::format("horizontal {:.3g} to {:.3g} m", facts.smallest_sigma_m, facts.largest_sigma_m);
  if (facts.smallest_sigma_m < 0.001 || facts.largest_sigma_m > 1000) {
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

void judge_lever_arm(const LogFacts& facts, Judgement& out) {
  if (!facts.lever_arm_m) return;
  const std::string text = fmt::format("{:.3f} m", *facts.lever_arm_m);
  if (*facts.lever_arm_m == 0) {
    out.warn("lever arm", "zero", "give it in the import, unless the antenna is on the IMU");
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
    out.warn(name, text, fmt::format("{}={:.2g}, or the preset of this IMU", key, measured / unit));
  } else if (ratio < 0.1) {
    out.warn(name, text, "the configuration is of a much worse IMU; choose its own preset");
  } else {
    out.ok(name, text);
  }
}

void judge_noise(const LogFacts& facts, const imu::ImuNoise& configured, Judgement& out) {
  constexpr int64_t kEnough = 10;  // [s]
  if (facts.rest.seconds < kEnough) {
    return out.ok("IMU noise", fmt::format("{} s of rest, too little to tell", facts.rest.seconds));
  }
  judge_density("gyroscope noise", "imu.arw_deg_sqrt_h", facts.rest.gyro_noise_density,
                configured.gyro_noise_density, kDegree / 60, "deg/sqrt(h)", out);
  judge_density("accelerometer noise", "imu.vrw_m_s_sqrt_h", facts.rest.accel_noise_density,
                configured.accel_noise_density, 1.0 / 60, "m/s/sqrt(h)", out);
  constexpr double kEarthRate = 7.3e-5;
  const double expected = std::hypot(configured.gyro_bias_sigma, configured.gyro_turn_on_sigma);
  const std::string bias =
      fmt::format("{:.3g} deg/h at rest, {:.3g} deg/h configured",
                  facts.rest.gyro_mean / kDegree * 3600, expected / kDegree * 3600);
  if (facts.rest.gyro_mean > 5 * expected + kEarthRate) {
    out.warn("gyroscope bias", bias,
             fmt::format("imu.gyro_turn_on_deg_h={:.0f}",
                         std::ceil(facts.rest.gyro_mean / kDegree * 3600)));
  } else {
    out.ok("gyroscope bias", bias);
  }
}

void judge_force(const LogFacts& facts, Judgement& out) {
  if (facts.imu.count == 0) return;
  const Vector3d& f = facts.mean_force_v;
  if (const std::optional<std::string> wrong = wrong_force(f.norm())) {
    return out.error("specific force", *wrong, "name the unit in the import");
  }
  if (facts.force_factor) {
    if (const std::optional<std::string> wrong = wrong_force_factor(*facts.force_factor)) {
      return out.error("specific force", *wrong, "correct unit or scale in the import");
    }
  }
  std::string text =
      fmt::format("mean {:.2f}, {:.2f}, {:.2f} m/s^2 forward, right, down", f.x(), f.y(), f.z());
  if (facts.force_factor) {
    text += fmt::format("; {:.3f} (sigma {:.3f}) times what gravity and motion make it",
                        facts.force_factor->value, facts.force_factor->sigma);
  }
  if (-f.z() > 0.5 * f.norm()) {
    out.ok("gravity", text);
  } else {
    out.error("gravity", text + ": up is not up", "correct the axes of the import");
  }
}

void judge_axes(const LogFacts& facts, Judgement& out) {
  if (!facts.acceleration_match) return;
  const Eigen::Vector2d& match = *facts.acceleration_match;
  const std::string text = fmt::format(
      "speed changes with the force forward by {:.2f}, to the right by {:.2f} "
      "(correlations)",
      match.x(), match.y());
  constexpr double kClear = 0.6;
  if (match.x() < -kClear) {
    out.error("axes", text, "forward is backward; correct the axes of the import");
  } else if (std::abs(match.y()) > kClear && std::abs(match.y()) > 2 * std::abs(match.x())) {
    out.error("axes", text, "forward is sideways; correct the axes of the import");
  } else {
    out.ok("axes", text);
  }
}

void judge_turns(const LogFacts& facts, Judgement& out) {
  constexpr double kHarmless = 0.03;  // [s]
  constexpr double kAgree = 0.9;
  if (!facts.turns) return out.ok("time offset", "too few turns to tell");
  const TurnMatch& match = *facts.turns;
  if (const std::optional<std::string> wrong = gross_mismatch(match, facts.gnss.first_ns)) {
    return out.error("time offset", *wrong, "see there");
  }
  std::string text = fmt::format(
      "stamps of the IMU are {:.3f} s (sigma {:.3f}) {} those of GNSS; {} courses, correlation "
      "{:.3f}, gyroscopes turn {:.3f} times as much",
      std::abs(match.offset_s), match.offset_sigma_s, match.offset_s >= 0 ? "after" : "before",
      match.samples, match.correlation, match.slope);
  if (match.gyro_factor) {
    text += fmt::format(", in gentle turns {:.3f} (sigma {:.3f})", match.gyro_factor->value,
                        match.gyro_factor->sigma);
  }
  if (match.correlation < kAgree) {
    return out.warn("turns",
                    fmt::format("courses of GNSS and turns of the gyroscopes do not agree, "
                                "correlation {:.2f} in {} courses",
                                match.correlation, match.samples),
                    "look for outliers in the innovations of `foucault run`, or give the axes");
  }
  if (std::abs(match.offset_s) > kHarmless + 3 * match.offset_sigma_s) {
    return out.warn("time offset", text,
                    fmt::format("imu: {{time: {{offset_s: {:.3f}}}}} in the import's mapping",
                                -match.offset_s));
  }
  out.ok("time offset", text);
}

}  // namespace

class LogChecker::Impl {
 public:
  Impl(const imu::ImuNoise& noise, const state::Mounting& mounting)
      : configured(noise), q_v_b_(mounting.q_v_b.normalized()) {}

  void add(const ImuIncrement& increment) {
    guard_.look_at(increment);
    if (!ImuGuard::is_measurable(increment)) return;
    if (increment.t_end_ns <= imu_.facts().last_ns && imu_.facts().count > 0) return;
    imu_.add(increment.t_end_ns);
    force_sum_b_ += increment.dvel_b;
    force_time_ += increment.dt();
    rest_.add(increment);
    force_match_.add(increment);
    acceleration_.add(increment, q_v_b_);
    fine_.add(increment);
    coarse_.add(increment);
  }

  void add(const GnssFix& given) {
    gnss_.add(given.t_ns);
    const std::optional<GnssFix> usable = fix_guard_.look_at(given).fix;
    if (!usable) return;
    const GnssFix& fix = *usable;
    if (!lever_arm_) lever_arm_ = fix.p_b_a.norm();
    const Vector3d variance = fix.position_covariance.diagonal();
    if (!variance.allFinite() || variance.minCoeff() <= 0) {
      ++bad_sigmas_;
      return;
    }
    const double sigma = geodesy::horizontal_sigma(fix.position_covariance);
    smallest_ = smallest_ > 0 ? std::min(smallest_, sigma) : sigma;
    largest_ = std::max(largest_, sigma);
    rest_.add(fix);
    force_match_.add(fix);
    acceleration_.add(fix);
    fine_.add(fix);
    coarse_.add(fix);
  }

  LogFacts facts() const {
    LogFacts facts;
    facts.imu = imu_.facts();
    facts.gnss = gnss_.facts();
    facts.overlap_s = seconds_between(std::max(facts.imu.first_ns, facts.gnss.first_ns),
                                      std::min(facts.imu.last_ns, facts.gnss.last_ns));
    facts.bad_sigmas = bad_sigmas_;
    facts.smallest_sigma_m = smallest_;
    facts.largest_sigma_m = largest_;
    facts.lever_arm_m = lever_arm_;
    if (force_time_ > 0) facts.mean_force_v = q_v_b_ * force_sum_b_ / force_time_;
    facts.force_factor = force_match_.factor();
    facts.rest = rest_.facts();
    facts.turns = turns();
    facts.acceleration_match = acceleration_.correlation();
    facts.bad_samples = guard_.summary();
    facts.bad_fixes = fix_guard_.summary();
    return facts;
  }

  imu::ImuNoise configured;

 private:
  /// Near zero on the fine grid; elsewhere on the coarse one.
  std::optional<TurnMatch> turns() const {
    const std::optional<TurnMatch> fine = fine_.best(), coarse = coarse_.best();
    if (!fine || !coarse) return fine ? fine : coarse;
    return std::abs(coarse->correlation) > std::abs(fine->correlation) + 0.02 ? coarse : fine;
  }

  Eigen::Quaterniond q_v_b_;
  StreamWatch imu_, gnss_;
  RestWatch rest_;
  ForceMatch force_match_;
  AccelerationMatch acceleration_;
  ImuGuard guard_;
  FixGuard fix_guard_;
  TurnMatcher fine_{1.0, 0.02}, coarse_{25, 0.25};
  Vector3d force_sum_b_ = Vector3d::Zero();
  double force_time_ = 0;
  int64_t bad_sigmas_ = 0;
  double smallest_ = 0, largest_ = 0;
  std::optional<double> lever_arm_;
};

LogChecker::LogChecker(const imu::ImuNoise& configured, const state::Mounting& mounting)
    : impl_(std::make_unique<Impl>(configured, mounting)) {}
LogChecker::~LogChecker() = default;

void LogChecker::add(const Measurement& measurement) {
  if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) impl_->add(*increment);
  if (const auto* fix = std::get_if<GnssFix>(&measurement)) impl_->add(*fix);
}

LogFacts LogChecker::facts() const { return impl_->facts(); }

std::vector<Finding> LogChecker::findings() const { return judge(facts(), impl_->configured); }

std::vector<state::Notice> LogChecker::warnings() const {
  std::vector<state::Notice> warnings;
  for (const Finding& finding : findings()) {
    if (finding.severity == Severity::ok) continue;
    if (finding.subject == kSamples || finding.subject == kFixes) continue;
    warnings.push_back({facts().imu.first_ns, state::NoticeKind::skipped,
                        fmt::format("{}: {} ({})", finding.subject, finding.text, finding.remedy)});
  }
  return warnings;
}

std::vector<Finding> judge(const LogFacts& facts, const imu::ImuNoise& configured) {
  constexpr double kImuHole = 0.1, kGnssHole = 30;  // [s]
  Judgement out;
  judge_stream(facts.imu, "IMU", kImuHole, out);
  judge_stream(facts.gnss, "GNSS", kGnssHole, out);
  judge_samples(facts, out);
  judge_overlap(facts, out);
  judge_sigmas(facts, out);
  judge_lever_arm(facts, out);
  judge_force(facts, out);
  judge_axes(facts, out);
  judge_turns(facts, out);
  judge_noise(facts, configured, out);
  return out.findings;
}

}  // namespace foucault::diagnosis
