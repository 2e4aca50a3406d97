#include "foucault/evaluation/outage_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault {
namespace {

const Geodetic kHome{0.84, 0.2, 500};
const Eigen::Vector3d kLeverArm(0.1, -0.3, -0.8);

/// A vehicle at rest at kHome: fixes of its antenna at 2 Hz, references at 4 Hz, IMU at 4 Hz.
class RestSource : public Source {
 public:
  RestSource(double duration_s, bool with_reference)
      : end_(static_cast<int>(4 * duration_s)), with_reference_(with_reference) {}

  std::optional<Measurement> next() override {
    while (tick_ <= end_) {
      const int64_t t_ns = tick_ * 250'000'000LL;
      const int kind = kind_++ % 3;
      if (kind == 2) ++tick_;
      if (kind == 0 && tick_ % 2 == 0) return fix(t_ns);
      if (kind == 1 && with_reference_) return reference(t_ns);
      if (kind == 2) return increment(t_ns);
    }
    return std::nullopt;
  }
  const Mounting& mounting() const override { return mounting_; }
  double progress() const override { return static_cast<double>(tick_) / end_; }

 private:
  static GnssFix fix(int64_t t_ns) {
    GnssFix fix;
    fix.t_ns = t_ns;
    fix.antenna = LocalFrame(kHome).to_geodetic(kLeverArm);
    fix.p_b_a = kLeverArm;
    return fix;
  }
  static ReferencePose reference(int64_t t_ns) {
    ReferencePose pose;
    pose.t_ns = t_ns;
    pose.position = kHome;
    return pose;
  }
  static ImuIncrement increment(int64_t t_ns) {
    ImuIncrement increment;
    increment.t_begin_ns = t_ns - 250'000'000;
    increment.t_end_ns = t_ns;
    return increment;
  }

  int end_;
  bool with_reference_;
  int tick_ = 0;
  int kind_ = 0;
  Mounting mounting_;
};

/// Drifts north by 0.01 m/s^2 t^2 and down by 0.1 m/s t since its last fix.
class DriftingEstimator : public Estimator {
 public:
  explicit DriftingEstimator(Sink& sink) : sink_(sink) {}

  void process(const Measurement& measurement) override {
    if (const auto* fix = std::get_if<GnssFix>(&measurement)) last_fix_ns_ = fix->t_ns;
    if (std::holds_alternative<ImuIncrement>(measurement)) emit(stamp(measurement));
  }
  void finish() override {}

 private:
  void emit(int64_t t_ns) {
    const double t = seconds_between(last_fix_ns_, t_ns);
    Epoch epoch;
    epoch.t_ns = t_ns;
    epoch.position = LocalFrame(kHome).to_geodetic({0.01 * t * t, 0, 0.1 * t});
    sink_.epoch(epoch);
  }

  Sink& sink_;
  int64_t last_fix_ns_ = 0;
};

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
    double last_progress = 0;
    void epoch(const Epoch&) override { ++epochs; }
    void reference_error(const Epoch&, const ReferenceError&) override { ++errors; }
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
