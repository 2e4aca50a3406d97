#include "nmea_accuracy.h"

#include <algorithm>

namespace foucault::rawlog {

NmeaSigma nmea_sigma(FixQuality quality, std::optional<double> hdop) {
  double horizontal = 1.7;
  switch (quality) {
    case FixQuality::fixed_rtk:
      horizontal = 0.015;
      break;
    case FixQuality::float_rtk:
      horizontal = 0.25;
      break;
    case FixQuality::ppp:
      horizontal = 0.1;
      break;
    case FixQuality::differential:
      horizontal = 0.7;
      break;
    case FixQuality::single:
    case FixQuality::unknown:
      break;
  }
  const double dilution = hdop ? std::max(*hdop, 0.5) : 1.0;
  return {horizontal * dilution, 2 * horizontal * dilution};
}

}  // namespace foucault::rawlog
