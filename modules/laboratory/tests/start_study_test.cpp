#include "foucault/laboratory/start_study.h"

#include <gtest/gtest.h>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/ekf/ekf.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault::laboratory {
namespace {

StartOutcome outcome(double bound_60_deg, double bound_120_deg, double error_deg,
                     double sigma_deg) {
  StartOutcome o;
  o.what = "boat, RTK";
  o.bound_60_s = bound_60_deg * kDegree;
  o.bound_120_s = bound_120_deg * kDegree;
  o.headings = {{60, error_deg * kDegree, sigma_deg * kDegree}, {90, 0, kDegree}};
  return o;
}

StartOutcome refused(double bound_120_deg) {
  StartOutcome o = outcome(20, bound_120_deg, 0, 1);
  o.headings.clear();
  o.refusal = "no initial attitude was found";
  return o;
}

TEST(StartOutcome, IsRightIfTheDataSaySo) {
  EXPECT_TRUE(outcome(0.5, 0.3, 1, 0.6).is_right());
  EXPECT_FALSE(outcome(0.5, 0.3, 4, 2).is_right()) << "the data know better";
  EXPECT_TRUE(outcome(5, 3, 9, 4).is_right());
  EXPECT_FALSE(outcome(5, 3, 9, 2).is_right()) << "more than 4 sigmas";
  EXPECT_TRUE(refused(12).is_right());
  EXPECT_FALSE(refused(8).is_right());
}

TEST(StartOutcome, IsCountedByVehicle) {
  const evaluation::TextTable summary =
      start_summary({outcome(0.5, 0.3, 1, 0.5), refused(8), refused(12)});
  ASSERT_EQ(summary.rows.size(), 2u);
  EXPECT_EQ(summary.rows[0][0], "boat");
  EXPECT_EQ(summary.rows[0][2], "2");  // determined
  EXPECT_EQ(summary.rows[0][3], "1");
  EXPECT_EQ(summary.rows[0][4], "2");
  EXPECT_EQ(start_table({refused(8)}).rows[0].size(), start_table({}).header.size());
}

/// A run that never starts, beside the bound of a real filter.
TEST(StartStudy, TheBoundComesFromTheDataAlone) {
  class Refusing : public state::Estimator {
    void process(const Measurement&) override { throw DataError("refused"); }
    void finish() override {}
  };
  StartProgram program;
  program.filter = [](const imu::ImuNoise& noise) {
    return std::make_unique<ekf::EkfNavigator>(noise, state::Layout(), ekf::EkfOptions());
  };
  program.run = [](const std::string&, const state::Mounting&, state::Sink&) {
    return std::make_unique<Refusing>();
  };
  const StartOutcome o = study_start(1, program);
  EXPECT_EQ(o.refusal, "refused");
  EXPECT_GT(o.bound_60_s, o.bound_120_s);
  EXPECT_GT(o.bound_120_s, 0.001 * kDegree);
  EXPECT_LT(o.bound_120_s, 10 * kDegree);
  EXPECT_FALSE(o.is_right());
}

}  // namespace
}  // namespace foucault::laboratory
