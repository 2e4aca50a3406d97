#pragma once

#include <deque>
#include <optional>
#include <string>

#include "foucault/alignment/alignment.h"
#include "foucault/core/measurement.h"
#include "foucault/diagnosis/fix_screen.h"
#include "foucault/diagnosis/gnss_options.h"
#include "foucault/state/epoch.h"

namespace foucault::navigation {

/// Where a run starts, and what came after that in the meantime.
struct Start {
  state::Epoch initial;
  std::deque<Measurement> since;  ///< in order, all later than initial
};

/// The phase before there is a state: measurements go to the Aligner, past the screen that leaves
/// out fixes which no vehicle reaches from their neighbours, and are kept as long as the run may
/// still start before them.
class Aligning {
 public:
  Aligning(alignment::Aligner aligner, const diagnosis::GnssOptions& options);

  /// The start, once it is known. Measurements in their order.
  std::optional<Start> take(const Measurement& measurement);
  /// The same when nothing follows any more.
  std::optional<Start> finish();

  std::string summary() const { return aligner_.summary(); }  ///< how the start was found
  std::string why_not() const { return aligner_.why_not(); }

  /// Forgets everything.
  void restart();

 private:
  std::optional<Start> look_through_screen(bool all);
  std::optional<Start> add(const diagnosis::FixScreen::Screened& screened);
  void show_aligner(const diagnosis::FixScreen::Screened& screened);
  Start start();
  void drop_what_no_start_needs();

  alignment::Aligner aligner_;
  diagnosis::GnssOptions options_;
  diagnosis::FixScreen screen_;
  std::deque<Measurement> held_;
};

}  // namespace foucault::navigation
