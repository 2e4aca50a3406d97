#include "foucault/evaluation/outage_run.h"

#include <gtest/gtest.h>

#include <memory>

#include "drifting_estimator.h"

namespace foucault {
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
  return [](const Mounting&, Sink& sink) { return std::make_unique<DriftingEstimator>(sink); };
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

TEST(OutageRun, AgainstTheReference) {
  const OutageRunResult result =
      run_with_outages(std::make_unique<RestSource>(275, true), schedule(), drifting());
  EXPECT_EQ(result.truth, DriftTruth::reference);
  expect_known_drift(result);
  EXPECT_EQ(result.drifts[0].samples.size(), 120u);  // at 4 Hz
}

TEST(OutageRun, AgainstWithheldFixes) {
  const OutageRunResult result =
      run_with_outages(std::make_unique<RestSource>(275, false), schedule(), drifting());
  EXPECT_EQ(result.truth, DriftTruth::withheld_fixes);
  expect_known_drift(result);
  EXPECT_EQ(result.drifts[0].samples.size(), 60u);  // at 2 Hz
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
    void epoch(const Epoch&) override { ++epochs; }
    void reference_error(const Epoch&, const ReferenceError&) override { ++errors; }
    void withheld_error(const Outage&, const Epoch&, const Eigen::Vector3d&) override {
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
}  // namespace foucault
