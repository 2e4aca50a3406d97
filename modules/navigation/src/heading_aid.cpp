#include "heading_aid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/measurement/heading.h"

namespace foucault::navigation {

HeadingAid::HeadingAid(const NavigationRunOptions& options, state::Sink& sink)
    : options_(options), sink_(sink), judge_(options.gnss, 1) {}

void HeadingAid::start(int64_t t_ns) {
  judge_.start(t_ns);
  last_ns_.reset();
}

void HeadingAid::use(const GnssFix& fix, measurement::Navigator& navigator) {
  constexpr double kHeadingInterval = 0.95;  // [s]: a second and the jitter of stamps
  if (!fix.heading || !(fix.heading->sigma > 0)) return;
  if (last_ns_ && seconds_between(*last_ns_, fix.t_ns) < kHeadingInterval) return;
  last_ns_ = fix.t_ns;
  const GnssFix trusted = weighted(fix);
  const auto heading = std::make_shared<measurement::Heading>(trusted, options_.mounting.q_v_b);
  const state::Innovation innovation = navigator.innovation(*heading);
  const double sigma = trusted.heading->sigma;
  watch_.add(innovation.value[0], innovation.covariance(0, 0) - sigma * sigma);
  if (options_.aids.heading == "auto" && !watch_.found()) return;
  const bool believed = holds() && judge_.believes(fix.t_ns, innovation);
  if (believed) navigator.update(heading);
  used_ |= believed;
  sink_.observation(
      {fix.t_ns, heading->name(), 1, diagnosis::mahalanobis_squared(innovation), believed});
}

GnssFix HeadingAid::weighted(const GnssFix& fix) const {
  GnssFix trusted = fix;
  const bool told = options_.aids.heading == "on" || options_.aids.heading_sigma_deg;
  if (!told && watch_.found()) {
    trusted.heading->sigma = std::max(fix.heading->sigma, watch_.found()->least_sigma);
  }
  return trusted;
}

/// Once they have agreed, the test of each is enough.
bool HeadingAid::holds() const {
  return used_ || options_.aids.heading == "on" || !watch_.found()->contradicts();
}

std::optional<std::string> HeadingAid::remark() const {
  if (used_ || !watch_.found() || !watch_.found()->contradicts()) return std::nullopt;
  const double direction = options_.aids.heading_baseline_deg + watch_.found()->offset / kDegree;
  return fmt::format(
      "the heading of two antennas was not used: it is {:.0f} deg off from what the motion shows, "
      "known to {:.1f} deg; if the second is seen from the first in that direction, give "
      "aids.heading_baseline_deg={:.0f}",
      watch_.found()->offset / kDegree, watch_.found()->state_sigma / kDegree,
      so3::wrap(direction * kDegree) / kDegree);
}

}  // namespace foucault::navigation
