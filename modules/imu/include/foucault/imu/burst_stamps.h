#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "foucault/imu/increments.h"

namespace foucault::imu {

/// How samples come in bursts.
struct BurstPattern {
  double samples = 0;     ///< a burst, mean
  double within_s = 0;    ///< longest interval that is one within a burst
  double interval_s = 0;  ///< of the samples when they were taken: median of gap over samples
};

/// Whether stamps (not decreasing) are those of bursts: this share or more of the intervals is
/// shorter than a quarter of their mean. Of even stamps none are, nor of any whose jitter leaves
/// them in order; of arrivals wholly at random 22 % are (1 - exp(-1/4)), of pairs half. Intervals
/// of half a second and more are holes and do not count. None with fewer than 20 intervals or five
/// bursts.
std::optional<BurstPattern> burst_pattern(const std::vector<int64_t>& stamps_ns,
                                          double share_of_short = 0.4);

/// Makes stamps even that a host gave on arrival: USB, serial ports and ROS hand samples over
/// several at a time, with one stamp or with stamps a few microseconds apart, and then none for a
/// while. A burst was complete when it came; its samples are spread evenly over the time since the
/// one before it came. Where samples are missing (1.5 times the usual time for each of its samples)
/// they keep the usual interval and leave the hole before them. Order and count stay. Stamps that
/// do not come in bursts stay as they are, to the last bit.
class BurstStamps {
 public:
  /// New stamps of the first of `waiting`, one or those of a burst, if the first is not after t_ns;
  /// empty if not, or if the burst may go on. The caller takes these samples out. `waiting` is in
  /// order of stamps, which may be equal; what lies ahead tells whether there are bursts.
  /// t_ns = INT64_MAX: nothing follows.
  const std::vector<int64_t>& take(const std::deque<ImuSample>& waiting, int64_t t_ns);

  /// What was found, one line; none if no burst was.
  std::optional<std::string> summary() const;
  int64_t first_ns() const { return first_ns_; }  ///< of the first burst

 private:
  void look_ahead(const std::deque<ImuSample>& waiting, bool nothing_follows);
  std::size_t burst_length(const std::deque<ImuSample>& waiting) const;
  void spread(int64_t arrival_ns, std::size_t samples);
  void count(int64_t arrival_ns, std::size_t samples);

  std::optional<BurstPattern> pattern_;
  int until_next_look_ = 0;
  std::optional<int64_t> last_arrival_ns_;
  std::vector<int64_t> even_, ahead_;
  int64_t bursts_ = 0, samples_ = 0, first_ns_ = 0;
  double interval_s_ = 0;
};

}  // namespace foucault::imu
