#include "foucault/imu/burst_stamps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "foucault/core/hole.h"
#include "foucault/core/median.h"
#include "foucault/core/time.h"

namespace foucault::imu {
namespace {

constexpr double kShort = 0.25;       // of the mean interval
constexpr double kStillShort = 0.02;  // share of short intervals that keeps a pattern
constexpr double kHole = 0.5;         // [s]
constexpr std::size_t kFewest = 20;   // intervals
constexpr int kFewestBursts = 5;
constexpr std::size_t kAhead = 400;  // samples: six bursts of 64, as FIFOs give
constexpr int kBetweenLooks = 20;    // samples

double mean_interval(const std::vector<int64_t>& stamps_ns) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    const double interval = seconds_between(stamps_ns[i - 1], stamps_ns[i]);
    if (interval >= kHole) continue;
    sum += interval;
    ++count;
  }
  return count == 0 ? 0 : sum / count;
}

}  // namespace

std::optional<BurstPattern> burst_pattern(const std::vector<int64_t>& stamps_ns,
                                          double share_of_short) {
  if (stamps_ns.size() <= kFewest) return std::nullopt;
  BurstPattern pattern;
  pattern.within_s = kShort * mean_interval(stamps_ns);
  std::vector<double> intervals;  // of the samples, by whole bursts
  std::size_t in_bursts = 0, in_this = 1;
  std::optional<int64_t> arrival_ns;
  int64_t next_arrival_ns = stamps_ns.front();
  for (std::size_t i = 1; i < stamps_ns.size(); ++i) {
    if (seconds_between(stamps_ns[i - 1], stamps_ns[i]) < pattern.within_s) {
      ++in_bursts;
      ++in_this;
      continue;
    }
    if (arrival_ns) {
      intervals.push_back(seconds_between(*arrival_ns, next_arrival_ns) /
                          static_cast<double>(in_this));
    }
    arrival_ns = next_arrival_ns;
    next_arrival_ns = stamps_ns[i];
    in_this = 1;
  }
  const double all = static_cast<double>(stamps_ns.size() - 1);
  if (static_cast<double>(in_bursts) < share_of_short * all) return std::nullopt;
  if (intervals.size() < kFewestBursts) return std::nullopt;
  pattern.samples = all / (all - static_cast<double>(in_bursts));
  pattern.interval_s = median(std::move(intervals));
  return pattern;
}

const std::vector<int64_t>& BurstStamps::take(const std::deque<ImuSample>& waiting, int64_t t_ns) {
  even_.clear();
  if (waiting.empty()) return even_;
  const int64_t arrival_ns = waiting.front().t_ns;
  if (!pattern_ && arrival_ns > t_ns) return even_;
  const bool nothing_follows = t_ns == std::numeric_limits<int64_t>::max();
  look_ahead(waiting, nothing_follows);
  const std::size_t samples = pattern_ ? burst_length(waiting) : 1;
  if (pattern_ && samples == waiting.size() && !nothing_follows) return even_;  // it may go on
  spread(arrival_ns, samples);
  if (even_.front() > t_ns) {
    even_.clear();
    return even_;
  }
  if (samples > 1) count(arrival_ns, samples);
  last_arrival_ns_ = arrival_ns;
  until_next_look_ -= static_cast<int>(samples);
  return even_;
}

void BurstStamps::look_ahead(const std::deque<ImuSample>& waiting, bool nothing_follows) {
  if (until_next_look_ > 0) return;
  ahead_.clear();
  const auto end = waiting.begin() + static_cast<std::ptrdiff_t>(std::min(waiting.size(), kAhead));
  std::transform(waiting.begin(), end, std::back_inserter(ahead_),
                 [](const ImuSample& sample) { return sample.t_ns; });
  const bool near_the_end = nothing_follows && ahead_.size() < kAhead;
  if (ahead_.size() <= kFewest || (pattern_ && near_the_end)) return;  // as before
  // Bursts that end ahead are still bursts here; even stamps stay even in a pattern.
  pattern_ = pattern_ ? burst_pattern(ahead_, kStillShort) : burst_pattern(ahead_);
  until_next_look_ = kBetweenLooks;
}

std::size_t BurstStamps::burst_length(const std::deque<ImuSample>& waiting) const {
  std::size_t length = 1;
  while (length < waiting.size() &&
         seconds_between(waiting[length - 1].t_ns, waiting[length].t_ns) < pattern_->within_s) {
    ++length;
  }
  return length;
}

void BurstStamps::spread(int64_t arrival_ns, std::size_t samples) {
  const int64_t n = static_cast<int64_t>(samples);
  if (n == 1) {
    even_.push_back(arrival_ns);
    return;
  }
  const int64_t usual_ns = n * nanoseconds(pattern_->interval_s);
  const int64_t gap_ns = last_arrival_ns_ ? arrival_ns - *last_arrival_ns_ : usual_ns;
  const bool missing = is_hole(gap_ns, usual_ns);
  const int64_t over_ns = missing ? usual_ns : gap_ns;
  for (int64_t k = 1; k <= n; ++k) even_.push_back(arrival_ns - over_ns + over_ns * k / n);
}

void BurstStamps::count(int64_t arrival_ns, std::size_t samples) {
  if (bursts_++ == 0) first_ns_ = arrival_ns;
  samples_ += static_cast<int64_t>(samples);
  interval_s_ = pattern_->interval_s;
}

std::optional<std::string> BurstStamps::summary() const {
  if (bursts_ == 0) return std::nullopt;
  return fmt::format(
      "{} IMU samples are stamped on arrival, in {} bursts of {:.1f}; their stamps were made even, "
      "{:.3g} ms apart",
      samples_, bursts_, static_cast<double>(samples_) / static_cast<double>(bursts_),
      1e3 * interval_s_);
}

}  // namespace foucault::imu
