#include "foucault/evaluation/outage_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>

#include "support/drifting_estimator.h"

namespace foucault::evaluation {
namespace {

using test::DriftingEstimator;
using test::RestSource;

OutageSchedule schedule() {
  OutageOptions options;
  options.first_s = 100;
  options.length_s = 30;
  options.period_s = 50;
  return OutageSchedule(options, 0);
}

EstimatorFactory drifting() {
  return [](const state::Mounting&, state::Sink& sink) {
    return std::make_unique<DriftingEstimator>(sink);
  };
}

void expect_known_drift(const OutageRunResult& result) {
  ASSERT_EQ(result.drifts.size(), 3u);  // 100, 150, 200; the one of 250 is cut off
  for (const OutageDrift& d : result.drifts) {
    EXPECT_NEAR(d.maximum.horizontal, 9, 1e-4);  // the estimate's own horizon tilts by 1e-6
    EXPECT_NEAR(d.maximum.vertical, 3, 1e-4);
    EXPECT_NEAR(d.end.horizontal, 9, 1e-4);
    EXPECT_NEAR(d.at_marks[0]->horizontal, 1, 1e-4);
    EXPECT_NEAR(d.at_marks[1]->horizontal, 4, 1e-4);
    EXPECT_FALSE(d.at_marks[3]);
  }
  EXPECT_EQ(result.scheduled, 3);
  EXPECT_EQ(result.withheld.size(), 4u);
  EXPECT_EQ(result.first_fix_ns, 0);
  EXPECT_EQ(result.last_fix_ns, 275'000'000'000);
  EXPECT_GE(result.cpu_s, 0);
}

/// After 20 s: 4 m to the north, 2 m down.
void expect_normalized(const OutageRunResult& result, double sigma) {
  for (const OutageDrift& d : result.drifts) {
    const DriftSample* sample = sample_near(d.samples, 20);
    ASSERT_TRUE(sample);
    EXPECT_NEAR(sample->normalized.horizontal, 16 / (sigma * sigma) / 2, 1e-2);
    EXPECT_NEAR(sample->normalized.vertical, 4 / (sigma * sigma), 1e-2);
  }
}

/// The estimate is on every fix, and at most a quarter of a second of drift away from it.
void expect_return(const OutageRunResult& result) {
  for (const OutageDrift& d : result.drifts) {
    ASSERT_TRUE(d.after_return);
    EXPECT_LT(d.after_return->maximum, 0.01 * 0.25 * 0.25 + 1e-6);
    EXPECT_EQ(d.after_return->settled_s, 0);
  }
}

TEST(OutageRun, AgainstTheReference) {
  const OutageRunResult result =
      run_with_outages(std::make_unique<RestSource>(275, true), schedule(), drifting());
  EXPECT_EQ(result.truth, DriftTruth::reference);
  expect_known_drift(result);
  EXPECT_EQ(result.drifts[0].samples.size(), 120u);  // at 4 Hz
  expect_normalized(result, test::kEstimateSigma);
  expect_return(result);
}

TEST(OutageRun, AgainstWithheldFixes) {
  const OutageRunResult result =
      run_with_outages(std::make_unique<RestSource>(275, false), schedule(), drifting());
  EXPECT_EQ(result.truth, DriftTruth::withheld_fixes);
  expect_known_drift(result);
  EXPECT_EQ(result.drifts[0].samples.size(), 60u);  // at 2 Hz
  expect_normalized(result, std::hypot(test::kEstimateSigma, test::kFixSigma));
  expect_return(result);
}

/// Takes fixes only from ten seconds after an outage on, or not at all.
class LockedOut : public state::Estimator {
 public:
  LockedOut(state::Sink& sink, bool for_good) : estimator_(sink), for_good_(for_good) {}
  void process(const Measurement& measurement) override {
    if (const auto* fix = std::get_if<GnssFix>(&measurement)) {
      if (last_ns_ && seconds_between(*last_ns_, fix->t_ns) > 20) return_ns_ = fix->t_ns;
      last_ns_ = fix->t_ns;
      const bool locked = return_ns_ && seconds_between(*return_ns_, fix->t_ns) < 10;
      if (locked || (return_ns_ && for_good_)) return;
    }
    estimator_.process(measurement);
  }
  void finish() override {}

 private:
  DriftingEstimator estimator_;
  bool for_good_;
  std::optional<int64_t> last_ns_;
  std::optional<int64_t> return_ns_;
};

TEST(OutageRun, AnEstimatorThatRejectsFixesShowsInTheReturn) {
  for (const bool with_reference : {true, false}) {
    for (const bool for_good : {false, true}) {
      const OutageRunResult result =
          run_with_outages(std::make_unique<RestSource>(275, with_reference), schedule(),
                           [for_good](const state::Mounting&, state::Sink& sink) {
                             return std::make_unique<LockedOut>(sink, for_good);
                           });
      ASSERT_EQ(result.drifts.size(), 3u);
      const std::optional<ReturnError>& error = result.drifts[0].after_return;
      ASSERT_TRUE(error);
      EXPECT_NEAR(error->maximum, for_good ? 0.01 * 50 * 50 : 0.01 * 40 * 40, 0.8);
      EXPECT_EQ(error->settled_s, for_good ? std::nullopt : std::optional(10.0));
    }
  }
}

TEST(OutageRun, WithoutOutagesThereIsNoDrift) {
  const OutageRunResult result =
      run_with_outages(std::make_unique<RestSource>(275, true), OutageSchedule(), drifting());
  EXPECT_TRUE(result.drifts.empty());
}

TEST(OutageRun, ObserverSeesEverything) {
  class Counter : public OutageRunObserver {
   public:
    int epochs = 0;
    int errors = 0;
    int withheld = 0;
    double last_progress = 0;
    void epoch(const state::Epoch&) override { ++epochs; }
    void reference_error(const state::Epoch&, const state::ReferenceError&) override { ++errors; }
    void withheld_error(const Outage&, const state::Epoch&, const Eigen::Vector3d&) override {
      ++withheld;
    }
    void progress(double value) override { last_progress = value; }
  };
  Counter counter;
  run_with_outages(std::make_unique<RestSource>(10, true), schedule(), drifting(), {}, &counter);
  EXPECT_EQ(counter.epochs, 41);
  EXPECT_EQ(counter.errors, 41);
  EXPECT_GE(counter.last_progress, 1);
}

}  // namespace
}  // namespace foucault::evaluation
