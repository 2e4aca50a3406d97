#include "foucault/alignment/alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "carried_attitude.h"
#include "course_finder.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/state/vehicle_attitude.h"
#include "initial_state.h"
#include "moving_alignment.h"
#include "rest_detector.h"

namespace foucault::alignment {

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kLargestHole = 0.1;      // [s]: over a longer one the attitude is lost
constexpr double kRestSpeedSigma = 0.01;  // [m/s]
/// With the heading given, a rest is complete at this length [s].
constexpr double kEnoughRest = 10;
/// Measurements used in the alignment are used again in the run: their variances are doubled.
constexpr double kReuse = 2;
constexpr double kStaleAttitude = 60;  // [s] after rest: a new rest is preferred

std::optional<GivenAngle> given(const std::optional<double>& degrees, double sigma_degrees) {
  if (!degrees) return std::nullopt;
  return GivenAngle{*degrees * kDegree, sigma_degrees * kDegree};
}

GivenAngles given_angles(const AlignmentOptions& options) {
  return {given(options.roll_deg, options.roll_sigma_deg),
          given(options.pitch_deg, options.pitch_sigma_deg),
          given(options.heading_deg, options.heading_sigma_deg)};
}

void require_all(const GivenAngles& angles) {
  std::vector<std::string> missing;
  if (!angles.roll) missing.emplace_back("roll_deg");
  if (!angles.pitch) missing.emplace_back("pitch_deg");
  if (!angles.heading) missing.emplace_back("heading_deg");
  if (missing.empty()) return;
  std::string list;
  for (const std::string& key : missing) list += (list.empty() ? "" : ", ") + key;
  throw UsageError("alignment.mode=given needs alignment." + list);
}

CourseLimits course_limits(const AlignmentOptions& options) {
  return {options.min_speed_m_s, options.max_course_sigma_deg * kDegree,
          options.max_turn_rate_deg_s * kDegree, options.mounting_sigma_deg * kDegree};
}

std::string wrong_axes(const std::string& up) {
  return fmt::format(
      "gravity points the wrong way: the IMU's axes say that up is the vehicle's {} axis; correct "
      "the axes of the import, or give alignment.roll_deg and pitch_deg if the vehicle does stand "
      "so",
      up);
}

std::string describe(const state::Epoch& epoch, const Quaterniond& q_v_b) {
  const state::VehicleAttitude attitude = state::vehicle_attitude(epoch, state::Mounting{q_v_b});
  const Vector3d sigma = attitude.sigma / kDegree;
  return fmt::format(
      "roll {:.2f} deg (sigma {:.2f}), pitch {:.2f} ({:.2f}), heading {:.2f} ({:.2f})",
      attitude.euler.roll / kDegree, sigma.x(), attitude.euler.pitch / kDegree, sigma.y(),
      attitude.euler.heading / kDegree, sigma.z());
}

}  // namespace

void AlignmentOptions::fields(ConfigFields& f) {
  f.text("mode", mode, {"auto", "given"},
         "auto: from rest and the GNSS course; given: roll_deg, pitch_deg and heading_deg");
  const Range half_turn{-180, 180};
  f.optional_number("roll_deg", roll_deg, half_turn, "of the vehicle at the start");
  f.optional_number("pitch_deg", pitch_deg, {-90, 90}, "of the vehicle at the start");
  f.optional_number("heading_deg", heading_deg, {-360, 360}, "of the vehicle at the start");
  f.number("roll_sigma_deg", roll_sigma_deg, kPositive, "sigma of a given roll");
  f.number("pitch_sigma_deg", pitch_sigma_deg, kPositive, "sigma of a given pitch");
  f.number("heading_sigma_deg", heading_sigma_deg, kPositive, "sigma of a given heading");
  f.number("min_speed_m_s", min_speed_m_s, kPositive, "slower, the course is no heading");
  f.number("max_course_sigma_deg", max_course_sigma_deg, kPositive, "of one course");
  f.number("max_turn_rate_deg_s", max_turn_rate_deg_s, kPositive,
           "faster, the vehicle does not drive straight");
  f.number("mounting_sigma_deg", mounting_sigma_deg, kPositive,
           "course against the forward axis: mounting and crab angle");
  f.number("min_rest_s", min_rest_s, kPositive, "shorter rests are not used");
  f.number("max_rest_s", max_rest_s, {10, 3600}, "how far back the start may lie");
}

class Aligner::Impl {
 public:
  Impl(const AlignmentOptions& options, const imu::ImuNoise& noise, const state::Mounting& mounting,
       const state::Layout& layout)
      : options_(options),
        noise_(noise),
        layout_(layout),
        q_v_b_(mounting.q_v_b.normalized()),
        given_(given_angles(options)),
        rest_(options.min_rest_s, options.max_rest_s),
        later_rest_(rest_),
        carried_(q_v_b_.conjugate() * Vector3d::UnitX()),
        courses_(course_limits(options)),
        moving_(course_limits(options), given_.heading, q_v_b_, noise) {
    if (options_.mode == "given") require_all(given_);
  }

  void add(const GnssFix& fix);
  void add(const ImuIncrement& increment);
  void restart() { *this = Impl(options_, noise_, state::Mounting{q_v_b_}, layout_); }
  int64_t earliest_start_ns() const;
  std::string why_not() const;

  std::optional<state::Epoch> initial_;
  std::string summary_;

 private:
  bool all_given() const { return options_.mode == "given"; }
  void begin_given(const GnssFix& fix);
  void add_to_rest(const ImuIncrement& increment);
  void note_hole(const ImuIncrement& increment);
  void finish_rest_with_given_heading();
  void start_at_rest(const HeadingOffset& heading, double drift_variance);
  void accept_moving(const state::Epoch& epoch);
  void accept(const state::Epoch& epoch, const std::string& how);
  std::optional<std::string> wrong_up(const state::Epoch& epoch) const;

  AlignmentOptions options_;
  imu::ImuNoise noise_;
  state::Layout layout_;
  Quaterniond q_v_b_;
  GivenAngles given_;

  RestDetector rest_;
  RestDetector later_rest_;  ///< one that may take the place of rest_ once that has ended
  CarriedAttitude carried_;
  CourseFinder courses_;
  MovingAlignment moving_;
  /// Attitudes in a row, found while moving, of which this axis is up.
  struct Tilted {
    std::string up;
    int64_t since_ns = 0;
  };
  std::optional<Tilted> tilted_;
  std::optional<GnssFix> first_given_;  ///< mode given: the fix to start from
  Vector3d rate_sum_ = Vector3d::Zero();
  double rate_time_ = 0;

  double latitude_ = 0;
  std::optional<int64_t> first_increment_ns_, last_increment_ns_, first_fix_ns_, last_fix_ns_;
};

void Aligner::Impl::add(const GnssFix& fix) {
  if (!first_fix_ns_) first_fix_ns_ = fix.t_ns;
  last_fix_ns_ = fix.t_ns;
  latitude_ = fix.antenna.latitude;
  if (initial_) return;
  if (all_given()) {
    begin_given(fix);
    return;
  }
  rest_.add(fix);
  if (rest_.ended()) later_rest_.add(fix);
  finish_rest_with_given_heading();
  if (initial_) return;
  if (rest_.established()) {
    if (carried_.reverses()) courses_.interrupt();
    const std::optional<HeadingOffset> heading = courses_.add(fix, carried_.attitude());
    if (heading) start_at_rest(*heading, carried_.drift_variance());
  } else if (const std::optional<AlignmentFindings> findings = moving_.add(fix)) {
    accept_moving(with_given_angles(initial_state(*findings, noise_, layout_), q_v_b_, given_));
  }
}

void Aligner::Impl::add(const ImuIncrement& increment) {
  note_hole(increment);
  if (!first_increment_ns_) first_increment_ns_ = increment.t_begin_ns;
  last_increment_ns_ = increment.t_end_ns;
  if (initial_) return;
  if (all_given()) {
    rate_sum_ += increment.dtheta_b;
    rate_time_ += increment.dt();
    if (first_given_ && first_given_->t_ns < *first_increment_ns_) first_given_.reset();
    return;
  }
  moving_.add(increment);
  carried_.add(increment);
  add_to_rest(increment);
  finish_rest_with_given_heading();
}

void Aligner::Impl::add_to_rest(const ImuIncrement& increment) {
  bool still = rest_.add(increment);
  if (rest_.ended()) {
    later_rest_.add(increment);
    // A rest that goes on after all (GNSS had wandered), or the next one after a long way.
    if (carried_.since_rest() > kStaleAttitude && later_rest_.established()) {
      rest_ = std::exchange(later_rest_, RestDetector(options_.min_rest_s, options_.max_rest_s));
      still = true;
    }
  }
  if (!still) return;
  carried_.rest(rest_.recent_means(), latitude_, noise_);
  courses_.interrupt();
}

void Aligner::Impl::note_hole(const ImuIncrement& increment) {
  if (!last_increment_ns_) return;
  if (seconds_between(*last_increment_ns_, increment.t_begin_ns) <= kLargestHole) return;
  rest_ = later_rest_ = RestDetector(options_.min_rest_s, options_.max_rest_s);
  courses_.interrupt();
  moving_.restart();
  first_given_.reset();
}

/// Mode given: the first fix, with its velocity or the one that the next fix gives.
void Aligner::Impl::begin_given(const GnssFix& fix) {
  const bool covered = last_increment_ns_ && first_given_;
  const GnssFix start = covered ? *first_given_ : fix;
  const Vector3d omega_b =
      rate_time_ > 0 ? Vector3d(rate_sum_ / rate_time_) : Vector3d(Vector3d::Zero());
  if (start.velocity_n && last_increment_ns_) {
    accept(given_state(start, *start.velocity_n, start.velocity_covariance, omega_b, q_v_b_, given_,
                       noise_),
           "as given");
    return;
  }
  if (!covered) {
    first_given_ = fix;
    rate_sum_.setZero();
    rate_time_ = 0;
    return;
  }
  constexpr double kAcceleration = 1.5;  // [m/s^2] within the interval
  const double dt = seconds_between(start.t_ns, fix.t_ns);
  if (dt <= 0) return;
  const Vector3d velocity_n = geodesy::LocalFrame(start.antenna).to_local(fix.antenna) / dt;
  const double unknown = kAcceleration * dt / 2;
  const Matrix3d covariance = (start.position_covariance + fix.position_covariance) / (dt * dt) +
                              unknown * unknown * Matrix3d::Identity();
  accept(given_state(start, velocity_n, covariance, omega_b, q_v_b_, given_, noise_), "as given");
}

/// A rest with the heading given needs no course.
void Aligner::Impl::finish_rest_with_given_heading() {
  if (initial_ || !given_.heading || !rest_.established()) return;
  const RestMeans means = rest_.means();
  if (!rest_.ended() && means.duration() < kEnoughRest) return;
  HeadingOffset heading;
  heading.offset = given_.heading->value;
  heading.variance = given_.heading->sigma * given_.heading->sigma / kReuse;
  start_at_rest(heading, 0);
}

void Aligner::Impl::start_at_rest(const HeadingOffset& heading, double drift_variance) {
  const std::optional<GnssFix> fix = rest_.first_fix();
  if (!fix) return;
  const RestMeans means = rest_.means();
  AlignmentFindings findings;
  findings.fix = *fix;
  findings.q_v_b = q_v_b_;
  findings.motion_covariance.topLeftCorner<3, 3>() =
      kRestSpeedSigma * kRestSpeedSigma * Matrix3d::Identity();
  const double T = means.duration();
  const double accel_white = noise_.accel_noise_density * noise_.accel_noise_density / T;
  const double gyro_white = noise_.gyro_noise_density * noise_.gyro_noise_density / T;
  findings.specific_force_b = means.accel_b;
  findings.specific_force_covariance =
      (kReuse * means.accel_variance.cwiseMax(accel_white)).asDiagonal();
  findings.gyro_b = means.gyro_b;
  findings.gyro_covariance = (kReuse * means.gyro_variance.cwiseMax(gyro_white)).asDiagonal();
  findings.heading = heading.offset;
  findings.heading_variance = kReuse * heading.variance + drift_variance;
  const state::Epoch epoch =
      with_given_angles(initial_state(findings, noise_, layout_), q_v_b_, given_);
  const std::string source =
      given_.heading ? std::string("heading given")
                     : fmt::format("heading from {} courses up to {:.1f} s later", heading.courses,
                                   seconds_between(epoch.t_ns, heading.end_ns));
  accept(epoch, fmt::format("from {:.0f} s of rest, {}", T, source));
}

/// On its side in a roll or a loop a vehicle is no place to start from, and no proof of wrong axes:
/// those are as wrong in every stretch.
void Aligner::Impl::accept_moving(const state::Epoch& epoch) {
  constexpr double kLongestManoeuvre = 30;  // [s]
  const std::optional<std::string> up = wrong_up(epoch);
  if (!up) return accept(epoch, "while moving");
  if (!tilted_ || tilted_->up != *up) tilted_ = Tilted{*up, epoch.t_ns};
  if (seconds_between(tilted_->since_ns, epoch.t_ns) > kLongestManoeuvre) {
    throw DataError(wrong_axes(*up));
  }
}

void Aligner::Impl::accept(const state::Epoch& epoch, const std::string& how) {
  if (const std::optional<std::string> up = wrong_up(epoch)) throw DataError(wrong_axes(*up));
  initial_ = epoch;
  summary_ = fmt::format("aligned {}: {}", how, describe(epoch, q_v_b_));
}

/// A course is a heading only while the forward axis is about level; axes named wrongly are seen in
/// that: which axis of the vehicle is up instead.
std::optional<std::string> Aligner::Impl::wrong_up(const state::Epoch& epoch) const {
  constexpr double kSteepest = 60 * kDegree;
  if (all_given() || given_.roll || given_.pitch) return std::nullopt;
  const Vector3d up_v = (epoch.q_n_b * q_v_b_.conjugate()).conjugate() * -Vector3d::UnitZ();
  if (-up_v.z() > std::cos(kSteepest)) return std::nullopt;
  Eigen::Index axis = 0;
  up_v.cwiseAbs().maxCoeff(&axis);
  const bool plus = up_v[axis] > 0;
  const char* const names[] = {plus ? "forward" : "backward", plus ? "right" : "left",
                               plus ? "down" : "up"};
  return std::string(names[axis]);
}

int64_t Aligner::Impl::earliest_start_ns() const {
  if (first_given_) return first_given_->t_ns;
  if (!last_increment_ns_) {
    return last_fix_ns_ ? *last_fix_ns_ - kNanosecondsPerSecond : INT64_MIN;
  }
  return all_given() ? *last_increment_ns_ : std::min(rest_.begin_ns(), *last_increment_ns_);
}

std::string Aligner::Impl::why_not() const {
  const std::string head = "no initial attitude was found: ";
  const std::string remedy =
      "; give alignment.heading_deg, or alignment.mode=given with roll_deg, pitch_deg and "
      "heading_deg";
  if (!first_increment_ns_) return head + "there is no IMU data";
  if (!first_fix_ns_) return head + "there is no usable GNSS fix";
  if (*last_fix_ns_ < *first_increment_ns_ || *last_increment_ns_ < *first_fix_ns_) {
    return head + fmt::format(
                      "GNSS ({} to {}) and IMU ({} to {}) do not overlap in "
                      "time; check the time systems and offsets of the import",
                      utc_text(*first_fix_ns_), utc_text(*last_fix_ns_),
                      utc_text(*first_increment_ns_), utc_text(*last_increment_ns_));
  }
  if (all_given()) return head + "there are fewer than two fixes within the IMU data";
  if (tilted_) return head + wrong_axes(tilted_->up);
  const double fastest = std::max(courses_.fastest(), moving_.fastest());
  std::string why =
      rest_.established()
          ? fmt::format("the vehicle rested, but ")
          : fmt::format("the vehicle never rested for {:.1f} s (longest {:.1f} s), and ",
                        options_.min_rest_s, rest_.longest_s());
  if (fastest < options_.min_speed_m_s) {
    why += fmt::format("never drove faster than alignment.min_speed_m_s={:g} (fastest {:.1f} m/s)",
                       options_.min_speed_m_s, fastest);
  } else {
    why += fmt::format(
        "never drove straight for long enough on fixes good enough for its heading "
        "(alignment.max_turn_rate_deg_s={:g}, max_course_sigma_deg={:g}; fastest {:.1f} m/s)",
        options_.max_turn_rate_deg_s, options_.max_course_sigma_deg, fastest);
  }
  return head + why + remedy;
}

Aligner::Aligner(const AlignmentOptions& options, const imu::ImuNoise& noise,
                 const state::Mounting& mounting, const state::Layout& layout)
    : impl_(std::make_unique<Impl>(options, noise, mounting, layout)) {}
Aligner::~Aligner() = default;
Aligner::Aligner(Aligner&&) noexcept = default;
Aligner& Aligner::operator=(Aligner&&) noexcept = default;

void Aligner::add(const GnssFix& fix) { impl_->add(fix); }
void Aligner::add(const ImuIncrement& increment) { impl_->add(increment); }
const std::optional<state::Epoch>& Aligner::initial() const { return impl_->initial_; }
std::string Aligner::summary() const { return impl_->summary_; }
int64_t Aligner::earliest_start_ns() const { return impl_->earliest_start_ns(); }
std::string Aligner::why_not() const { return impl_->why_not(); }
void Aligner::restart() { impl_->restart(); }

}  // namespace foucault::alignment
