#include "foucault/simulation/faults.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/simulation/random.h"

namespace foucault::simulation {
namespace {

constexpr int64_t kEvery = 10;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A measurement and when it is given out.
struct Item {
  Measurement measurement;
  int64_t due_ns;
};
using Items = std::vector<Item>;

/// One fault on its way through a recording.
class Injection {
 public:
  Injection(const Fault& fault, int64_t start_ns, Draws draws)
      : fault_(fault), start_ns_(start_ns), draws_(std::move(draws)) {}

  Items apply(const Items& items) {
    for (const Item& item : items) {
      if (const auto* fix = std::get_if<GnssFix>(&item.measurement)) {
        if (active(fix->t_ns)) {
          add_fix(*fix, item.due_ns);
          continue;
        }
      } else if (const auto* increment = std::get_if<ImuIncrement>(&item.measurement)) {
        if (active(increment->t_end_ns)) {
          add_increment(*increment, item.due_ns);
          continue;
        }
        hand_over_burst();
        last_ = *increment;
      }
      out_.push_back(item);
    }
    hand_over_burst();
    return std::move(out_);
  }

 private:
  double since_start(int64_t t_ns) const {
    return seconds_between(start_ns_, t_ns) - fault_.start_s;
  }
  bool active(int64_t t_ns) const {
    const double t = since_start(t_ns);
    return t > 0 && t <= fault_.length_s;
  }
  void give(const Measurement& measurement, int64_t due_ns) {
    out_.push_back({measurement, due_ns});
  }
  void give(const Measurement& measurement) { give(measurement, stamp(measurement)); }

  static GnssFix moved(const GnssFix& fix, const Eigen::Vector3d& error_n) {
    GnssFix out = fix;
    out.antenna = geodesy::LocalFrame(fix.antenna).to_geodetic(error_n);
    return out;
  }

  Eigen::Vector3d outlier() {
    const double direction = draws_.uniform(0, 2 * kPi);
    return draws_.uniform(5, 50) * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0);
  }

  void add_fix(const GnssFix& fix, int64_t due_ns) {
    ++fixes_;
    const double t = since_start(fix.t_ns);
    GnssFix out = fix;
    switch (fault_.kind) {
      case FaultKind::fix_outliers:
        if (draws_.happens(fault_.size)) out = moved(fix, outlier());
        break;
      case FaultKind::fix_ramp:
        out = moved(fix, t / fault_.length_s * fault_.size * Eigen::Vector3d(0.6, 0.8, 0));
        break;
      case FaultKind::fix_jump:
        out = moved(fix, fault_.size * Eigen::Vector3d::UnitY());
        break;
      case FaultKind::fix_gap:
        return;
      case FaultKind::fix_float:
        if (std::fmod(t, 2 * fault_.size) < fault_.size) out.quality = FixQuality::float_rtk;
        break;
      case FaultKind::fix_sigma_scale:
        out.position_covariance *= fault_.size * fault_.size;
        break;
      case FaultKind::fix_sigma_zero:
        out.position_covariance.setZero();
        break;
      case FaultKind::fix_sigma_negative:
        out.position_covariance *= -1;
        break;
      case FaultKind::fix_sigma_nan:
        out.position_covariance.setConstant(kNaN);
        break;
      case FaultKind::fix_duplicate:
        give(fix, due_ns);
        break;
      case FaultKind::fix_late:
        return give(fix, due_ns + nanoseconds(fault_.size));
      case FaultKind::fix_swapped:
        // The first of a pair waits for the second.
        if (fixes_ % 2 == 1) return waiting_.push_back(fix);
        give(fix, due_ns);
        for (const GnssFix& first : waiting_) give(first, due_ns);
        return waiting_.clear();
      case FaultKind::fix_another_week:
        if (fixes_ % kEvery == 0) out.t_ns += std::llround(fault_.size) * kNanosecondsPerWeek;
        break;
      case FaultKind::fix_stamps_offset:
        out.t_ns += nanoseconds(fault_.size);
        return give(out);
      default:
        break;
    }
    give(out, due_ns);
  }

  void add_increment(const ImuIncrement& increment, int64_t due_ns) {
    const bool tenth = ++increments_ % kEvery == 0;
    ImuIncrement out = increment;
    switch (fault_.kind) {
      case FaultKind::imu_gap:
        return;
      case FaultKind::imu_duplicate:
        if (tenth) give(increment, due_ns);
        break;
      case FaultKind::imu_backward:
        if (tenth) due_ns += 3 * (increment.t_end_ns - increment.t_begin_ns) / 2;
        break;
      case FaultKind::imu_jitter:
        out = jittered(increment);
        break;
      case FaultKind::imu_bursts:
        burst_.push_back(increment);
        if (static_cast<double>(burst_.size()) >= fault_.size) hand_over_burst();
        return;
      case FaultKind::imu_nan:
        if (tenth) out.dvel_b.x() = kNaN;
        break;
      case FaultKind::imu_clipped: {
        const double most = fault_.size * increment.dt();
        out.dtheta_b = increment.dtheta_b.cwiseMax(-most).cwiseMin(most);
        break;
      }
      case FaultKind::imu_stuck:
        if (last_) out.dtheta_b.z() = last_->dtheta_b.z();
        break;
      case FaultKind::imu_half_rate:
        return join_pairs(increment, due_ns);
      case FaultKind::imu_splice:
        if (since_start(increment.t_begin_ns) + 0.5 * increment.dt() < fault_.size) return;
        return give_later(increment, -fault_.size);
      case FaultKind::imu_stamps_offset:
        return give_later(increment, fault_.size);
      case FaultKind::imu_gyro_in_degrees:
        out.dtheta_b *= 180 / kPi;
        break;
      case FaultKind::imu_accel_in_g:
        out.dvel_b /= kStandardGravity;
        break;
      case FaultKind::imu_axes_turned:
        out.dtheta_b.tail<2>() *= -1;
        out.dvel_b.tail<2>() *= -1;
        break;
      default:
        break;
    }
    give(out, due_ns);
  }

  void join_pairs(const ImuIncrement& increment, int64_t due_ns) {
    if (increments_ % 2 == 1) {
      last_ = increment;
      return;
    }
    ImuIncrement out = increment;
    out.t_begin_ns = last_->t_begin_ns;
    out.dtheta_b += last_->dtheta_b;
    out.dvel_b += last_->dvel_b;
    give(out, due_ns);
  }

  void give_later(ImuIncrement increment, double seconds) {
    increment.t_begin_ns += nanoseconds(seconds);
    increment.t_end_ns += nanoseconds(seconds);
    give(increment);
  }

  /// A burst comes when its last sample has been taken.
  void hand_over_burst() {
    constexpr int64_t kApartNs = 200'000;
    if (burst_.empty()) return;
    int64_t end_ns = burst_.back().t_end_ns;
    for (const ImuIncrement& increment : burst_) {
      give(restamped(increment, end_ns));
      end_ns += kApartNs;
    }
    burst_.clear();
  }

  /// Never so far that stamps meet.
  ImuIncrement jittered(const ImuIncrement& increment) {
    const double most = 0.4 * increment.dt();
    const double off = std::clamp(fault_.size * draws_.normal(), -most, most);
    return restamped(increment, increment.t_end_ns + nanoseconds(off));
  }

  /// Rates as they were, from the last stamp that is off to the next.
  ImuIncrement restamped(const ImuIncrement& increment, int64_t end_ns) {
    ImuIncrement out = increment;
    out.t_begin_ns = restamped_end_ns_.value_or(increment.t_begin_ns);
    out.t_end_ns = end_ns;
    restamped_end_ns_ = out.t_end_ns;
    const double stretched = out.dt() / increment.dt();
    out.dtheta_b *= stretched;
    out.dvel_b *= stretched;
    return out;
  }

  Fault fault_;
  int64_t start_ns_;
  Draws draws_;
  Items out_;
  int64_t fixes_ = 0, increments_ = 0;
  std::vector<GnssFix> waiting_;
  std::optional<ImuIncrement> last_;
  std::optional<int64_t> restamped_end_ns_;
  std::vector<ImuIncrement> burst_;
};

/// Rates on straight lines over the fault, from the last increment before it to the first after.
void interpolate(const Fault& fault, int64_t start_ns, Items& items) {
  ImuIncrement before, after;
  std::vector<ImuIncrement*> lost;
  for (Item& item : items) {
    auto* increment = std::get_if<ImuIncrement>(&item.measurement);
    if (increment == nullptr) continue;
    const double t = seconds_between(start_ns, increment->t_end_ns) - fault.start_s;
    if (t <= 0) before = *increment;
    after = *increment;
    if (t > fault.length_s) break;
    if (t > 0) lost.push_back(increment);
  }
  for (std::size_t i = 0; i < lost.size(); ++i) {
    const double share = static_cast<double>(i + 1) / static_cast<double>(lost.size() + 1);
    const double dt = lost[i]->dt();
    lost[i]->dtheta_b =
        dt * ((1 - share) * before.dtheta_b / before.dt() + share * after.dtheta_b / after.dt());
    lost[i]->dvel_b =
        dt * ((1 - share) * before.dvel_b / before.dt() + share * after.dvel_b / after.dt());
  }
}

Items all_of(state::Source& source) {
  Items items;
  while (const std::optional<Measurement> measurement = source.next()) {
    items.push_back({*measurement, stamp(*measurement)});
  }
  return items;
}

/// By the time they are given out; at the same time increments last, as core/measurement.h asks.
void sort(Items& items) {
  const auto is_increment = [](const Item& item) {
    return std::holds_alternative<ImuIncrement>(item.measurement);
  };
  std::stable_sort(items.begin(), items.end(), [&](const Item& a, const Item& b) {
    if (a.due_ns != b.due_ns) return a.due_ns < b.due_ns;
    return !is_increment(a) && is_increment(b);
  });
}

}  // namespace

FaultySource::FaultySource(std::unique_ptr<state::Source> source, const std::vector<Fault>& faults,
                           int64_t seed)
    : source_(std::move(source)) {
  Items items = all_of(*source_);
  const int64_t start_ns = items.empty() ? 0 : items.front().due_ns;
  for (const Fault& fault : faults) {
    if (fault.kind == FaultKind::imu_interpolated) interpolate(fault, start_ns, items);
    items = Injection(fault, start_ns, Draws(seed, RandomStream::faults)).apply(items);
  }
  sort(items);
  measurements_.reserve(items.size());
  for (const Item& item : items) measurements_.push_back(item.measurement);
}

std::optional<Measurement> FaultySource::next() {
  if (next_ == measurements_.size()) return std::nullopt;
  return measurements_[next_++];
}

double FaultySource::progress() const {
  return measurements_.empty()
             ? 1.0
             : static_cast<double>(next_) / static_cast<double>(measurements_.size());
}

}  // namespace foucault::simulation
