#pragma once

#include <deque>
#include <optional>

namespace foucault::diagnosis {

/// Headings of two antennas against those of a state that fixes hold, over the last two minutes.
struct HeadingFindings {
  double offset = 0;       ///< measured less predicted, the median [rad]
  double state_sigma = 0;  ///< of that, by the state and the baseline [rad]
  /// Of white noise of as much power as is beyond doubt in the differences [rad].
  double least_sigma = 0;

  /// More than the state, or what is known of the baseline, allows for.
  bool contradicts() const;
};

/// Collects differences, one a second.
class HeadingWatch {
 public:
  /// variance: of the difference, by the state and the baseline alone [rad^2].
  void add(double difference, double variance);

  /// None of fewer than thirty.
  const std::optional<HeadingFindings>& found() const { return found_; }

 private:
  struct Sample {
    double difference, variance;
  };
  std::deque<Sample> samples_;
  std::optional<HeadingFindings> found_;
};

}  // namespace foucault::diagnosis
