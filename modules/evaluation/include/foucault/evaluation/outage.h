#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "foucault/core/config.h"
#include "foucault/state/interfaces.h"

/// Simulated GNSS outages: fixes are withheld from an estimator, which knows nothing of it.
namespace foucault::evaluation {

/// Section `outages` of the configuration. Times count from the first GNSS fix. The paper: 60 s
/// every 150 s after 500 s of initialization, each log twice with shifted starts.
class OutageOptions : public Configurable {
 public:
  double first_s = 510;
  double length_s = 60;
  double period_s = 150;
  std::vector<double> shifts_s{0, 75};  ///< each log is run once a shift
  std::vector<double> starts_s;         ///< if given: these starts, instead of first and period

  void fields(ConfigFields& f) override;
};

/// Withheld are fixes in (begin, end]: the last one used lies at begin, so at t the outage has
/// lasted t - begin.
struct Outage {
  int64_t index = 0;  ///< 0, 1, ... in a schedule
  int64_t begin_ns = 0;
  int64_t end_ns = 0;
};

/// Recorded stamps are not round: one within this of an outage's border counts as on it.
constexpr int64_t kStampToleranceNs = 5'000'000;

/// When fixes are withheld.
class OutageSchedule {
 public:
  /// No outages.
  OutageSchedule() = default;
  /// The schedule of one of options.shifts_s. Throws UsageError if outages would overlap.
  OutageSchedule(const OutageOptions& options, double shift_s);

  /// The outage at t_ns, if any; borders to within kStampToleranceNs.
  std::optional<Outage> at(int64_t first_fix_ns, int64_t t_ns) const;

  /// End of the first outage after the first fix [s]; none without outages.
  std::optional<double> first_end_s() const;

 private:
  std::vector<int64_t> starts_ns_;  ///< since the first fix, in order
  int64_t length_ns_ = 0;
  int64_t period_ns_ = 0;  ///< goes on from the only start; 0: starts as listed
};

/// Withholds fixes: in their place an EpochRequest of the same stamp walks on, so that there is an
/// estimate to compare with. All else passes unchanged.
class OutageSource : public state::Source {
 public:
  using Withheld = std::function<void(const Outage&, const GnssFix&)>;

  OutageSource(std::unique_ptr<state::Source> source, OutageSchedule schedule, Withheld withheld);

  std::optional<Measurement> next() override;
  const state::Mounting& mounting() const override;
  double progress() const override;

  /// The outage at a stamp that has been read; none before the first fix.
  std::optional<Outage> outage_at(int64_t t_ns) const;

  /// Stamps of the first and the last fix that have been read, withheld or not.
  std::optional<int64_t> first_fix_ns() const { return first_fix_ns_; }
  std::optional<int64_t> last_fix_ns() const { return last_fix_ns_; }

  /// Straight line from the first fix of the recording to this one [m]. NaN without a position.
  double from_first_fix(const GnssFix& fix) const;

 private:
  std::unique_ptr<state::Source> source_;
  OutageSchedule schedule_;
  Withheld withheld_;
  std::optional<int64_t> first_fix_ns_;
  std::optional<int64_t> last_fix_ns_;
  std::optional<Geodetic> first_position_;  ///< of the first fix that has one
};

}  // namespace foucault::evaluation
