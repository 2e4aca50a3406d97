#include "prediction_probe.h"

#include <array>

#include "foucault/core/time.h"
#include "foucault/measurement/gnss_position.h"

namespace foucault::navigation {
namespace {

constexpr std::array<double, 3> kHorizonsS{5, 15, 30};
constexpr double kLatest = 1.2;    // of a horizon
constexpr double kSettlingS = 60;  // as innovations, the alignment's errors are not the IMU's
/// A sixth of the time is mechanized twice: 2.6 % of the CPU time of a run of the filter.
constexpr double kPeriodS = 180;

}  // namespace

void PredictionProbe::propagate(const ImuIncrement& increment) {
  if (ahead_) ahead_->propagate(increment);
}

std::optional<state::PredictionResult> PredictionProbe::meet(
    const GnssFix& fix, const measurement::Navigator& navigator) {
  std::optional<state::PredictionResult> result;
  if (ahead_) result = compare(fix);
  if (!due_ns_) due_ns_ = fix.t_ns + nanoseconds(kSettlingS);
  if (!ahead_ && fix.t_ns >= *due_ns_) {
    ahead_ = navigator.ahead(1);
    begin_ns_ = fix.t_ns;
    horizon_ = 0;
    due_ns_ = fix.t_ns + nanoseconds(kPeriodS);
  }
  return result;
}

/// Horizons in which no fix came are left out.
std::optional<state::PredictionResult> PredictionProbe::compare(const GnssFix& fix) {
  constexpr double kJitter = 5e-3;  // [s], of recorded stamps
  const double after_s = seconds_between(begin_ns_, fix.t_ns);
  while (horizon_ < kHorizonsS.size() && after_s > kLatest * kHorizonsS[horizon_]) ++horizon_;
  std::optional<state::PredictionResult> result;
  if (horizon_ < kHorizonsS.size() && after_s >= kHorizonsS[horizon_] - kJitter) {
    const state::Innovation innovation = ahead_->innovation(measurement::GnssPosition(fix));
    result = state::PredictionResult{fix.t_ns, kHorizonsS[horizon_], innovation.value,
                                     innovation.covariance};
    ++horizon_;
  }
  if (horizon_ == kHorizonsS.size()) ahead_.reset();
  return result;
}

}  // namespace foucault::navigation
