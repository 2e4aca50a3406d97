#include "foucault/evaluation/outage_run.h"

#include <algorithm>
#include <ctime>
#include <map>
#include <utility>

#include "foucault/core/time.h"
#include "foucault/state/blocks.h"

namespace foucault::evaluation {
namespace {

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

/// Takes the epochs of a run and measures them against both truths.
class DriftMeter : public state::Sink {
 public:
  DriftMeter(std::unique_ptr<state::Source> source, const OutageSchedule& schedule,
             const OutageRunOptions& options, OutageRunObserver* observer)
      : observer_(observer),
        by_reference_(options.marks_s),
        by_fixes_(options.marks_s),
        withheld_([this](const Outage& outage, const GnssFix& fix, const state::Epoch& epoch,
                         const FixError& error) { withheld_error(outage, fix, epoch, error); },
                  options.layout),
        returned_(
            [this](const Outage&, const GnssFix&, const state::Epoch& epoch,
                   const FixError& error) { return_by_fixes_.error(epoch.t_ns, error.error_n); },
            options.layout),
        source_(std::move(source), schedule,
                [this](const Outage& outage, const GnssFix& fix) { withheld(outage, fix); }),
        comparison_(
            source_.mounting().with(options.layout),
            [this](const state::Epoch& epoch, const state::ReferenceError& error) {
              reference_error(epoch, error);
            },
            options.reference) {}

  OutageSource& source() { return source_; }

  /// What goes on to the estimator.
  void see(const Measurement& measurement) {
    if (const auto* pose = std::get_if<ReferencePose>(&measurement)) comparison_.add(*pose);
    if (const auto* fix = std::get_if<GnssFix>(&measurement)) see_fix(*fix);
  }

  void epoch(const state::Epoch& epoch) override {
    if (observer_) observer_->epoch(epoch);
    withheld_.epoch(epoch);
    returned_.epoch(epoch);
    comparison_.add(epoch);
  }
  void fix(const state::FixResult& fix) override {
    if (observer_) observer_->fix(fix);
  }
  void notice(const state::Notice& notice) override {
    if (observer_) observer_->notice(notice);
  }

  void catching_up(std::size_t) override {
    if (observer_) observer_->progress(source_.progress());
  }

  OutageRunResult result() const {
    OutageRunResult result;
    result.first_fix_ns = source_.first_fix_ns().value_or(0);
    result.last_fix_ns = source_.last_fix_ns().value_or(0);
    for (const auto& [index, outage] : outages_) result.withheld.push_back(outage);
    result.scheduled =
        std::count_if(result.withheld.begin(), result.withheld.end(), [&](const Outage& outage) {
          return outage.end_ns <= result.last_fix_ns + kStampToleranceNs;
        });
    const std::vector<OutageDrift> by_reference = by_reference_.complete(result.last_fix_ns);
    const std::vector<OutageDrift> by_fixes = by_fixes_.complete(result.last_fix_ns);
    const bool use_reference = !by_reference.empty() && by_reference.size() >= by_fixes.size();
    result.truth = use_reference ? DriftTruth::reference : DriftTruth::withheld_fixes;
    result.drifts = use_reference ? by_reference : by_fixes;
    complete(result.drifts, (use_reference ? return_by_reference_ : return_by_fixes_).results());
    return result;
  }

 private:
  void complete(std::vector<OutageDrift>& drifts,
                const std::map<int64_t, ReturnError>& returns) const {
    for (OutageDrift& drift : drifts) {
      const auto distance_m = distances_m_.find(drift.outage.index);
      if (distance_m != distances_m_.end()) drift.distance_m = distance_m->second;
      const auto after_return = returns.find(drift.outage.index);
      if (after_return != returns.end()) drift.after_return = after_return->second;
    }
  }
  void see_fix(const GnssFix& fix) {
    if (outages_.empty()) return;
    const Outage& before = outages_.rbegin()->second;
    return_by_reference_.fix(before, fix);
    if (return_by_fixes_.fix(before, fix)) returned_.add(before, fix);
  }
  void withheld(const Outage& outage, GnssFix fix) {
    if (source_.first_fix_ns()) {
      fix.since_first_s = seconds_between(*source_.first_fix_ns(), fix.t_ns);
    }
    outages_.insert_or_assign(outage.index, outage);
    distances_m_.try_emplace(outage.index, source_.from_first_fix(fix));
    withheld_.add(outage, fix);
  }
  void withheld_error(const Outage& outage, const GnssFix& fix, const state::Epoch& epoch,
                      const FixError& error) {
    if (observer_) observer_->withheld_error(outage, epoch, error.error_n);
    const Eigen::Matrix3d covariance = error.covariance_n + fix.position_covariance;
    by_fixes_.add(outage, epoch.t_ns, error.error_n, normalized_squares(error.error_n, covariance));
  }
  void reference_error(const state::Epoch& epoch, const state::ReferenceError& error) {
    if (observer_) observer_->reference_error(epoch, error);
    const std::optional<Outage> outage = source_.outage_at(epoch.t_ns);
    if (!outage) {
      return_by_reference_.error(epoch.t_ns, error.position_n);
      return;
    }
    const Eigen::Matrix3d covariance = epoch.covariance_of(state::block::position);
    by_reference_.add(*outage, epoch.t_ns, error.position_n,
                      normalized_squares(error.position_n, covariance));
  }

  OutageRunObserver* observer_;
  std::map<int64_t, Outage> outages_;      ///< that withheld a fix, by index
  std::map<int64_t, double> distances_m_;  ///< of the first fix withheld in each
  DriftCollector by_reference_;
  DriftCollector by_fixes_;
  ReturnCollector return_by_reference_;
  ReturnCollector return_by_fixes_;
  FixTruth withheld_;
  FixTruth returned_;
  OutageSource source_;
  ReferenceComparison comparison_;
};

}  // namespace

OutageRunResult run_with_outages(std::unique_ptr<state::Source> source,
                                 const OutageSchedule& schedule,
                                 const EstimatorFactory& make_estimator,
                                 const OutageRunOptions& options, OutageRunObserver* observer) {
  const double cpu_before_s = thread_cpu_s();
  DriftMeter meter(std::move(source), schedule, options, observer);
  const std::unique_ptr<state::Estimator> estimator =
      make_estimator(meter.source().mounting(), meter);
  while (const std::optional<Measurement> measurement = meter.source().next()) {
    meter.see(*measurement);
    estimator->process(*measurement);
    if (observer) observer->progress(meter.source().progress());
  }
  estimator->finish();
  OutageRunResult result = meter.result();
  result.cpu_s = thread_cpu_s() - cpu_before_s;
  return result;
}

}  // namespace foucault::evaluation
