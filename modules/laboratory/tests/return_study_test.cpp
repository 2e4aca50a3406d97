#include "foucault/laboratory/return_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <variant>

#include "foucault/core/error.h"
#include "support/drifting_estimator.h"

namespace foucault::laboratory {
namespace {

/// Drifts as DriftingEstimator and, with the gate, leaves out the first two fixes after a drift.
class GatedEstimator : public state::Estimator {
 public:
  GatedEstimator(state::Sink& sink, bool gate, double scale)
      : sink_(sink), gate_(gate), inner_(sink, scale) {}

  void process(const Measurement& measurement) override {
    if (const auto* fix = std::get_if<GnssFix>(&measurement)) {
      if (seconds_between(last_ns_, fix->t_ns) > 5) left_out_ = 2;
      state::FixResult result;
      result.t_ns = last_ns_ = fix->t_ns;
      const bool believed = !gate_ || left_out_-- <= 0;
      result.verdict = believed ? state::FixVerdict::used : state::FixVerdict::gated;
      sink_.fix(result);
    }
    inner_.process(measurement);
  }
  void finish() override { inner_.finish(); }

 private:
  state::Sink& sink_;
  bool gate_;
  test::DriftingEstimator inner_;
  int64_t last_ns_ = 0;
  int left_out_ = 0;
};

ReturnProgram program() {
  ReturnProgram program;
  program.outages.first_s = 100;
  program.outages.period_s = 50;
  program.outages.shifts_s = {0};
  program.noise = imu::imu_preset("ADIS16465");
  program.open = [](const std::string&) { return std::make_unique<test::RestSource>(275, true); };
  program.method = [](const ReturnCase& what, bool gate) {
    if (what.method == "refuses") throw DataError("no");
    const double scale = gate ? 2 * what.noise : what.noise;
    return ReturnMethod{[gate, scale](const state::Mounting&, state::Sink& sink) {
      return std::make_unique<GatedEstimator>(sink, gate, scale);
    }};
  };
  return program;
}

TEST(ReturnStudy, ComparesWithTheSameWithoutAGate) {
  const ReturnOutcome outcome = study_return({"a.rawlog", 1, 30, "ekf"}, program());
  EXPECT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.outages, 3);
  EXPECT_NEAR(outcome.ratio(), 2, 0.1);
  EXPECT_EQ(outcome.left_out, 6);
  EXPECT_EQ(outcome.longest_s, 1) << "two fixes at 2 Hz";
}

TEST(ReturnStudy, OutagesAsLongAsTheirPeriodAreMovedApart) {
  EXPECT_EQ(study_return({"a.rawlog", 1, 60, "ekf"}, program()).outages, 1);
}

TEST(ReturnStudy, ASimulatedTripWithoutALog) {
  ReturnProgram simulated = program();
  simulated.method = [](const ReturnCase&, bool) {
    return ReturnMethod{[](const state::Mounting&, state::Sink& sink) {
      return std::make_unique<GatedEstimator>(sink, true, 1);
    }};
  };
  const ReturnOutcome outcome = study_return({"", 1, 60, "ekf"}, simulated);
  EXPECT_EQ(outcome.outages, 6) << "from 200 s on, a minute each and between them, of 900 s";
  EXPECT_EQ(outcome.ratio(), 1);
}

TEST(ReturnStudy, TablesNameTheWorst) {
  const std::vector<ReturnOutcome> outcomes{
      study_return({"x/a.rawlog", 1, 30, "ekf"}, program()),
      study_return({"x/a.rawlog", 1, 30, "refuses"}, program())};
  EXPECT_EQ(outcomes[1].error, "no");
  const evaluation::TextTable table = return_table(outcomes);
  EXPECT_EQ(table.rows[0][0], "a");
  EXPECT_EQ(table.rows[1].back(), "no");
  EXPECT_EQ(table.rows[0].size(), table.header.size());
  const evaluation::TextTable summary = return_summary(outcomes);
  ASSERT_EQ(summary.rows.size(), 1u);
  EXPECT_EQ(summary.rows[0][4], "1");
  EXPECT_EQ(return_summary({ReturnOutcome()}).rows[0][0], "simulated");
}

}  // namespace
}  // namespace foucault::laboratory
