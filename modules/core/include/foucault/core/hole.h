#pragma once

/// What a hole in a stream is, for all who look for them.
namespace foucault {

/// Midway between neighbours, 1, and one lost in between, 2: half an interval of jitter is none.
inline constexpr double kHoleIntervals = 1.5;

/// Whether something is lost between neighbours, by the interval between their stamps and the usual
/// one, in one unit; no usual interval is known if it is 0. Of increments the end of the one and
/// the end of the next count, as of samples.
template <class Time>
constexpr bool is_hole(Time interval, Time usual) {
  return usual > 0 && static_cast<double>(interval) > kHoleIntervals * static_cast<double>(usual);
}

}  // namespace foucault
