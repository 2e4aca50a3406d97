#include "foucault/simulation/simulated_source.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "foucault/core/error.h"
#include "foucault/core/time.h"

namespace foucault::simulation {
namespace {

constexpr int64_t kResolution_ns = 100;
constexpr double kTicksPerSecond = 1e7;
constexpr int64_t kNever = std::numeric_limits<int64_t>::max();

int64_t round_to_resolution(int64_t t_ns) {
  return (t_ns + kResolution_ns / 2) / kResolution_ns * kResolution_ns;
}

int64_t rounded_start(const ScenarioOptions& options) {
  return round_to_resolution(options.start_ns());
}

const ScenarioOptions& checked(const ScenarioOptions& options) {
  if (!(options.gnss_sigma_m.minCoeff() > 0)) {
    throw UsageError(
        "scenario: gnss_sigma_m must be positive (gnss_noise: false makes exact fixes)");
  }
  if (!(options.rest_s < options.skip_s + options.duration_s) && options.name != "static") {
    throw UsageError(
        "scenario: rest_s must be shorter than duration_s (and skip_s), or nothing moves");
  }
  return options;
}

ImuFlaws flaws_of(const ScenarioOptions& options) {
  ImuFlaws flaws;
  flaws.scale_sigma = options.scale_factor_sigma_ppm * 1e-6;
  flaws.cross_axis_sigma = options.cross_axis_sigma_ppm * 1e-6;
  flaws.rectification = options.vibration_rectification_m_s2;
  return flaws;
}

}  // namespace

StampSequence::StampSequence(int64_t start_ns, double rate_hz, double phase_s)
    : start_ns_(start_ns), rate_hz_(rate_hz), phase_s_(phase_s) {}

int64_t StampSequence::at(int64_t index) const {
  const double seconds = phase_s_ + static_cast<double>(index) / rate_hz_;
  return start_ns_ + std::llround(seconds * kTicksPerSecond) * kResolution_ns;
}

std::optional<int64_t> SimulatedSource::Stream::next_ns(int64_t end_ns) const {
  if (stamps.empty()) return std::nullopt;
  const int64_t t_ns = stamps.at(index);
  return t_ns <= end_ns ? std::optional<int64_t>(t_ns) : std::nullopt;
}

SimulatedSource::SimulatedSource(const ScenarioOptions& options, const imu::ImuNoise& noise)
    : options_(checked(options)),
      start_ns_(rounded_start(options)),
      end_ns_(start_ns_ + nanoseconds(options.duration_s)),
      mounting_{options.q_v_b()},
      true_q_v_b_(options.true_q_v_b()),
      trajectory_(make_trajectory(options)),
      gnss_(options),
      wheels_(options),
      errors_(noise, flaws_of(options), options.seed),
      fixes_{StampSequence(start_ns_, options.gnss_rate_hz, options.gnss_phase_s)},
      wheel_speeds_{StampSequence(start_ns_, options.wheel_rate_hz, 0)},
      references_{StampSequence(start_ns_, options.reference_rate_hz, 0)},
      increments_{StampSequence(start_ns_, options.imu_rate_hz, 0), 1},
      now_ns_(start_ns_) {}

std::optional<Measurement> SimulatedSource::next() {
  while (true) {
    const int64_t fix_ns = fixes_.next_ns(end_ns_).value_or(kNever);
    const int64_t wheel_ns = wheel_speeds_.next_ns(end_ns_).value_or(kNever);
    const int64_t reference_ns = references_.next_ns(end_ns_).value_or(kNever);
    const int64_t increment_ns = increments_.next_ns(end_ns_).value_or(kNever);
    const int64_t first_ns = std::min({fix_ns, wheel_ns, reference_ns, increment_ns});
    if (first_ns == kNever) {
      now_ns_ = end_ns_;
      return std::nullopt;
    }
    now_ns_ = first_ns;
    if (fix_ns == first_ns) {
      if (std::optional<GnssFix> fix = next_fix()) return *fix;
      continue;
    }
    if (wheel_ns == first_ns) return next_wheel_speed();
    if (reference_ns == first_ns) return next_reference();
    if (std::optional<ImuIncrement> increment = next_increment()) return *increment;
  }
}

double SimulatedSource::progress() const {
  return seconds_between(start_ns_, now_ns_) / seconds_between(start_ns_, end_ns_);
}

Motion SimulatedSource::motion_at(int64_t t_ns) const {
  return trajectory_.at(seconds_between(start_ns_, t_ns));
}

std::optional<GnssFix> SimulatedSource::next_fix() {
  const int64_t t_ns = fixes_.stamps.at(fixes_.index++);
  const double t = seconds_between(start_ns_, t_ns);
  const double measured = t - options_.gnss_time_offset_s - 1e-6 * options_.gnss_time_drift_ppm * t;
  const GnssFix fix = gnss_.measure(trajectory_.at(measured), t_ns, t);
  if (measured < 0 || measured > options_.duration_s) return std::nullopt;
  return fix;
}

WheelSpeed SimulatedSource::next_wheel_speed() {
  const int64_t t_ns = wheel_speeds_.stamps.at(wheel_speeds_.index++);
  return wheels_.measure(trajectory_.steady_at(seconds_between(start_ns_, t_ns)), t_ns);
}

ReferencePose SimulatedSource::next_reference() {
  ReferencePose reference;
  reference.t_ns = references_.stamps.at(references_.index++);
  const Motion motion = motion_at(reference.t_ns);
  reference.position = motion.position;
  reference.velocity_n = motion.velocity_n;
  reference.q_n_v = motion.q_n_v;
  return reference;
}

std::optional<ImuIncrement> SimulatedSource::next_increment() {
  const int64_t begin_ns = increments_.stamps.at(increments_.index - 1);
  const int64_t end_ns = increments_.stamps.at(increments_.index++);
  const ImuIncrement exact = exact_increment(trajectory_, true_q_v_b_, start_ns_, begin_ns, end_ns);
  const ImuIncrement increment = errors_.apply(exact, rectifying_speed(end_ns));
  if (in_gap(increment)) return std::nullopt;
  return increment;
}

double SimulatedSource::rectifying_speed(int64_t t_ns) const {
  if (options_.vibration_rectification_m_s2 == 0) return 0;
  return trajectory_.steady_at(seconds_between(start_ns_, t_ns)).velocity_n.norm();
}

bool SimulatedSource::in_gap(const ImuIncrement& increment) const {
  const double begin = seconds_between(start_ns_, increment.t_begin_ns);
  return std::any_of(
      options_.imu_gap_start_s.begin(), options_.imu_gap_start_s.end(),
      [&](double gap) { return begin >= gap && begin < gap + options_.imu_gap_length_s; });
}

state::Epoch SimulatedSource::truth(int64_t t_ns) const {
  const Motion motion = motion_at(t_ns);
  state::Epoch epoch;
  epoch.t_ns = t_ns;
  epoch.position = motion.position;
  epoch.velocity_n = motion.velocity_n;
  epoch.q_n_b = motion.q_n_v * true_q_v_b_;
  epoch.bias = true_bias();
  return epoch;
}

}  // namespace foucault::simulation
