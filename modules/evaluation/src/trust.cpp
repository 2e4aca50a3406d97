#include "foucault/evaluation/trust.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/evaluation/statistics.h"

namespace foucault::evaluation {
namespace {

constexpr int64_t kFewestFixes = 10;
constexpr Band kUsual{0.5, 1.5};
constexpr Band kBelievable{0.3, 3};
constexpr double kChance = 0.999;

struct Finding {
  bool condemns = false;
  std::string text;
};

/// Of a square of three components, or of a mean of such.
double size_of(double square) { return std::sqrt(square / 3); }

std::string too_large(double size) {
  return fmt::format(
      "innovations are {:.1f} times as large as their sigmas: those of the fixes "
      "(gnss.sigma_scale), the noise of the IMU (imu.*) or the clocks are wrong; see `foucault "
      "check`",
      size);
}

std::string too_large_but_for_one(const Consistency& c, double others, int64_t start_ns) {
  return fmt::format(
      "one innovation, {:.0f} s after the start, is {:.0f} times as large as its sigma, the others "
      "{:.2f} times: that fix is wrong, or what came before it; look there in the report",
      seconds_between(start_ns, c.largest_nis.t_ns), size_of(c.largest_nis.value), others);
}

std::string too_small(double size) {
  return fmt::format(
      "innovations are {:.2g} of their sigmas: those of the fixes (gnss.sigma_scale) or the noise "
      "of the IMU (imu.*) are too large, or errors of the fixes last and the solution is worse "
      "than its sigmas",
      size);
}

std::optional<Finding> on_states(const StateCount& states) {
  if (states.not_finite == 0) return std::nullopt;
  return Finding{true,
                 fmt::format("{} of {} states are not finite, the first {:.1f} s after the start; "
                             "see `foucault check` for what is wrong there, or try another method",
                             states.not_finite, states.given_out,
                             seconds_between(states.begin_ns, states.first_not_finite_ns))};
}

std::optional<Finding> on_count(const SquareConsistency& nis) {
  if (nis.samples >= kFewestFixes) return std::nullopt;
  return Finding{
      true,
      fmt::format("only {} fixes support it, and it takes {} to judge a run; record "
                  "for longer, or see `foucault check` (output.statistics_from_s counts, too)",
                  nis.samples, kFewestFixes)};
}

/// Of the first two components. Clocks, heading and scale that are wrong show in these alone; a
/// vertical that fits must not dilute them.
double horizontal_size(const Consistency& c) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const ResidualStatistics& s = c.innovations[axis];
    sum += s.mean * s.mean + s.sigma * s.sigma;
  }
  return std::sqrt(sum / 2);
}

std::string wrong_size(const Consistency& c, double size, int64_t start_ns) {
  if (size < 1) return too_small(size);
  const double samples = static_cast<double>(c.nis.samples);
  const double others = size_of((samples * c.nis.mean - c.largest_nis.value) / (samples - 1));
  if (kUsual.holds(others)) return too_large_but_for_one(c, others, start_ns);
  return too_large(size);
}

std::optional<Finding> on_size(const Consistency& c, int64_t start_ns) {
  if (c.nis.samples < kFewestFixes) return std::nullopt;
  double size = size_of(c.nis.mean);
  const double horizontal = horizontal_size(c);
  if (horizontal > kBelievable.high) size = std::max(size, horizontal);
  if (kUsual.holds(size)) return std::nullopt;
  if (mean_nees_band(3, c.nis.effective_samples, kChance).holds(c.nis.mean)) return std::nullopt;
  return Finding{!kBelievable.holds(size), wrong_size(c, size, start_ns)};
}

/// Where to look. They do not condemn: a third of a run that is wrong by five sigmas, or a
/// hundredth by thirty, does so by the mean.
std::optional<Finding> on_stretches(const StretchConsistency& s, int64_t start_ns) {
  if (s.too_large == 0) return std::nullopt;
  const double share = static_cast<double>(s.too_large) / static_cast<double>(s.stretches);
  return Finding{false,
                 fmt::format("innovations are more than {:.0f} times as large as their sigmas in "
                             "{:.1f} % of the run, {:.1f} times from {:.0f} to {:.0f} s after the "
                             "start; look there in the report, and see `foucault check`",
                             StretchConsistency::kTooLarge, 100 * share, s.worst,
                             seconds_between(start_ns, s.worst_begin_ns),
                             seconds_between(start_ns, s.worst_end_ns))};
}

/// What to change where the innovations of an aid are larger than their sigmas.
std::string aid_remedy(const std::string& name) {
  if (name == "zero_rate") {
    return "; the gyroscopes' noise may be larger (imu.arw_deg_sqrt_h), or the vehicle shakes (do "
           "without: aids.zero_velocity=off)";
  }
  if (name == "heading")
    return "; give a larger one (aids.heading_sigma_deg), or do without (aids.heading=off)";
  for (const char* with_key : {"gnss_velocity", "zero_velocity", "nonholonomic", "wheel_speed"}) {
    if (name != with_key) continue;
    return fmt::format("; give larger ones (aids.{0}_sigma_m_s), or do without (aids.{0}=off)",
                       name);
  }
  return "; give larger ones, or do without";
}

std::optional<Finding> on_aid(const std::string& name, const AidMetrics& aid) {
  if (aid.used < kFewestFixes) return std::nullopt;
  const double size = std::sqrt(aid.mean_nis() / aid.dimension);
  if (size <= kUsual.high) return std::nullopt;
  return Finding{size > kBelievable.high,
                 fmt::format("innovations of {} are {:.1f} times as large as their sigmas{}", name,
                             size, aid_remedy(name))};
}

/// Faults are told by what most of the fixes agree on.
std::optional<Finding> on_rejected(const FixCount& fixes) {
  constexpr double kLargestShare = 0.25;  // chosen; good recordings of others have 0.004 at most
  const int64_t all = fixes.used + fixes.rejected;
  if (all < kFewestFixes || fixes.rejected <= kLargestShare * static_cast<double>(all))
    return std::nullopt;
  return Finding{true, fmt::format("{} of {} fixes do not agree with the others and the IMU: "
                                   "the lever arm, the axes or the clocks may be wrong; see "
                                   "`foucault check`",
                                   fixes.rejected, all)};
}

std::optional<Finding> on_course(const CourseOffset& course) {
  constexpr double kLargest = 30 * kDegree;  // chosen: boats and wings drift by 20
  const std::optional<double> mean = course.mean();
  if (!mean || std::abs(*mean) < kLargest + 3 * course.sigma()) return std::nullopt;
  return Finding{false, fmt::format("the vehicle moves {:.0f} deg to the {} of where it points "
                                    "(heading sigma {:.0f}): unless it does, axes, sign of the "
                                    "accelerometer or clocks are wrong",
                                    std::abs(*mean) / kDegree, *mean > 0 ? "right" : "left",
                                    course.sigma() / kDegree)};
}

std::vector<std::string> too_far_apart(const std::vector<std::pair<const char*, double>>& sizes) {
  std::vector<std::string> parts;
  for (const auto& [name, size] : sizes) {
    if (size > kBelievable.high) parts.push_back(fmt::format("{} by {:.1f} times", name, size));
  }
  return parts;
}

std::optional<Finding> on_separated_motion(const SeparationMetrics& s) {
  const std::vector<std::string> parts =
      too_far_apart({{"velocity", s.velocity_size}, {"attitude", s.attitude_size}});
  if (parts.empty()) return std::nullopt;
  return Finding{true,
                 fmt::format("forward and smoothed run tell different motions, {} what their "
                             "sigmas allow: axes, clocks, velocities or the noise of the IMU are "
                             "wrong; see `foucault check`, and the separation in the report",
                             fmt::join(parts, ", "))};
}

std::optional<Finding> on_separated_position(const SeparationMetrics& s) {
  if (too_far_apart({{"position", s.position_size}}).empty()) return std::nullopt;
  return Finding{false,
                 fmt::format("the run forward was too sure of the position: smoothing moved it by "
                             "{:.1f} times what their sigmas allow (a lever arm or a clock that "
                             "came out otherwise); see the separation in the report",
                             s.position_size)};
}

}  // namespace

void CourseOffset::add(const Eigen::Vector3d& velocity_n, double heading, double heading_sigma) {
  constexpr double kSlowest = 3;  // [m/s]
  if (!(velocity_n.head<2>().norm() > kSlowest)) return;
  ++samples_;
  sum_ += std::polar(1.0, std::atan2(velocity_n.y(), velocity_n.x()) - heading);
  sigma_sum_ += heading_sigma;
}

std::optional<double> CourseOffset::mean() const {
  constexpr int64_t kFewest = 30;
  constexpr double kOneDirection = 0.8;  // mean length; of a scatter of 38 deg
  if (samples_ < kFewest || std::abs(sum_) < kOneDirection * static_cast<double>(samples_))
    return std::nullopt;
  return std::arg(sum_);
}

double CourseOffset::sigma() const {
  return samples_ > 0 ? sigma_sum_ / static_cast<double>(samples_) : 0;
}

bool is_finite(const state::Epoch& epoch) {
  return std::isfinite(epoch.position.latitude) && std::isfinite(epoch.position.longitude) &&
         std::isfinite(epoch.position.height) && epoch.velocity_n.allFinite() &&
         epoch.q_n_b.coeffs().allFinite() && epoch.bias.gyro.allFinite() &&
         epoch.bias.accel.allFinite() && epoch.covariance.allFinite();
}

Trust trust_in(const Consistency& consistency, const StateCount& states, const Aids& aids,
               const FixCount& fixes, const CourseOffset& course) {
  Trust trust;
  std::vector<std::string> remarks;
  std::vector<std::optional<Finding>> findings{on_states(states),
                                               on_count(consistency.nis),
                                               on_size(consistency, states.begin_ns),
                                               on_stretches(consistency.stretches, states.begin_ns),
                                               on_rejected(fixes),
                                               on_course(course)};
  for (const auto& [name, aid] : aids) findings.push_back(on_aid(name, aid));
  for (const std::optional<Finding>& finding : findings) {
    if (!finding) continue;
    if (finding->condemns) trust.trustworthy = false;
    (finding->condemns ? trust.reasons : remarks).push_back(finding->text);
  }
  trust.reasons.insert(trust.reasons.end(), remarks.begin(), remarks.end());
  return trust;
}

void judge_separation(Trust& trust, const SeparationMetrics& separation) {
  if (separation.samples < kFewestFixes) return;
  if (const std::optional<Finding> finding = on_separated_motion(separation)) {
    trust.trustworthy = false;
    trust.reasons.insert(trust.reasons.begin(), finding->text);
  }
  if (const std::optional<Finding> finding = on_separated_position(separation)) {
    trust.reasons.push_back(finding->text);
  }
}

}  // namespace foucault::evaluation
