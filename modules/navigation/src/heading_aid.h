#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "foucault/diagnosis/fix_judge.h"
#include "foucault/diagnosis/heading_watch.h"
#include "foucault/measurement/navigator.h"
#include "foucault/navigation/run_options.h"
#include "foucault/state/interfaces.h"

namespace foucault::navigation {

/// Headings of two antennas, which come with fixes: one a second at most, for their errors last.
/// `auto`: once half a minute of them has been compared with the state and does not contradict it;
/// with the noise that the differences show where it is more than was told. `on`: from the begin
/// on, as told. Each is gated by its chi-square.
class HeadingAid {
 public:
  HeadingAid(const NavigationRunOptions& options, state::Sink& sink);

  void start(int64_t t_ns);
  void doubt_state(int64_t t_ns) { judge_.doubt_state(t_ns); }

  /// At a fix that holds the state.
  void use(const GnssFix& fix, measurement::Navigator& navigator);

  /// Why they were not used, one line; none if they were, or if there are none.
  std::optional<std::string> remark() const;

 private:
  /// The fix with the sigma to be used.
  GnssFix weighted(const GnssFix& fix) const;
  bool holds() const;

  NavigationRunOptions options_;
  state::Sink& sink_;
  diagnosis::HeadingWatch watch_;
  diagnosis::FixJudge judge_;
  std::optional<int64_t> last_ns_;
  bool used_ = false;
};

}  // namespace foucault::navigation
