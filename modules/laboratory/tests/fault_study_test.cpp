#include "foucault/laboratory/fault_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "support/test_folder.h"

namespace foucault::laboratory {
namespace {

using testing::HasSubstr;

TEST(FaultCases, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const FaultCase& fault : fault_cases()) {
    EXPECT_TRUE(names.insert(fault.name).second) << fault.name;
    EXPECT_EQ(&find_fault_case(fault.name), &fault);
  }
  try {
    find_fault_case("nonsense");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("known: none, outliers"));
  }
}

TEST(FaultCases, DamageToAFile) {
  const test::TestFolder folder;
  const auto damaged = [&](FileDamage damage) {
    folder.write("log", std::string(1000, 'x'));
    damage_file(folder / "log", damage);
    return folder.text("log");
  };
  EXPECT_EQ(damaged(FileDamage::none), std::string(1000, 'x'));
  EXPECT_EQ(damaged(FileDamage::truncated).size(), 600u);
  EXPECT_EQ(damaged(FileDamage::overwritten).substr(499, 66), "x" + std::string(64, '\xA5') + "x");
  EXPECT_EQ(damaged(FileDamage::emptied), "");
  EXPECT_THAT(damaged(FileDamage::text), HasSubstr("not a rawlog"));
  EXPECT_THROW(damage_file(folder / "none", FileDamage::emptied), DataError);
}

/// A program whose error is 5 m in and for a while after the fault and 1 cm else.
class FaultStudyTest : public testing::Test {
 protected:
  FaultStudyTest() {
    program_.write = [](const FaultCase&, int64_t, const std::string& log) {
      std::filesystem::create_directory(log);
    };
    program_.process = [this](const std::string& log, const std::string& method,
                              FaultObserver& observer) -> std::optional<std::string> {
      if (method == "refuses") throw DataError(log + ": no");
      observer.place({});
      for (int i = 0; i < 400; ++i) drive(i, observer);
      for (int i = 0; i < notices_; ++i) {
        observer.notice({0, state::NoticeKind::fix_rejected, "at 1700000000.500 s"});
      }
      observer.judge();
      if (method == "breaks") return "'" + log + "' breaks off";
      return std::nullopt;
    };
  }

  void drive(int i, FaultObserver& observer) const {
    const int64_t t_ns = fault_scenario(1).start_ns() + nanoseconds(i);
    ReferencePose reference;
    reference.t_ns = t_ns;
    state::Epoch epoch;
    epoch.t_ns = t_ns;
    epoch.position.latitude = (i >= 200 && i < wrong_until_ ? 5 : 0.01) / 6.4e6;
    epoch.covariance.setIdentity();
    observer.reference(reference);
    observer.epoch(epoch);
    state::FixResult fix;
    fix.t_ns = t_ns;
    fix.innovation_covariance.setIdentity();
    fix.innovation_n = Eigen::Vector3d(1, -1, 1) * (i % 2 == 0 ? 1 : -1);
    observer.fix(fix);
  }
  std::vector<FaultOutcome> run(const std::vector<std::string>& methods,
                                const std::string& fault = "jump") const {
    return run_fault(find_fault_case(fault), methods, 1, folder_ / "log", program_);
  }

  test::TestFolder folder_;
  FaultProgram program_;
  int wrong_until_ = 230;
  int notices_ = 0;
};

TEST_F(FaultStudyTest, ErrorAndRecovery) {
  const std::vector<FaultOutcome> outcomes = run({"ekf"});
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_NEAR(outcomes[0].largest_m, 5, 0.1);
  EXPECT_EQ(outcomes[0].errors, 340);
  EXPECT_EQ(outcomes[0].recovery_s, 9) << "the fault of 20 s ended at 220 s";
  EXPECT_EQ(outcomes[0].used, 400);
  EXPECT_EQ(outcomes[0].message, "");
  EXPECT_TRUE(outcomes[0].trust->trustworthy);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "log"));
}

TEST_F(FaultStudyTest, AnErrorThatStays) {
  wrong_until_ = 1000;
  notices_ = 2;
  const std::vector<FaultOutcome> outcomes = run({"ekf"}, "jump_back");
  EXPECT_FALSE(outcomes[0].recovery_s.has_value());
  EXPECT_EQ(outcomes[0].message, "at 1700000000.500 s (and 1 more)");
  EXPECT_EQ(fault_summary(outcomes).rows[0][3], "never");
  EXPECT_EQ(fault_summary(outcomes).rows[0][6], "at t (and 1 more)");
}

TEST_F(FaultStudyTest, WhatBreaksOffOrIsRefused) {
  notices_ = 1;
  const std::vector<FaultOutcome> outcomes = run({"ekf", "breaks", "refuses"});
  EXPECT_EQ(outcomes[0].exit_code, 0);
  EXPECT_EQ(outcomes[1].exit_code, 1);
  EXPECT_EQ(outcomes[1].message, "'log' breaks off");
  EXPECT_EQ(outcomes[2].message, "log: no");
  EXPECT_FALSE(outcomes[2].trust.has_value());

  const evaluation::TextTable table = fault_table(outcomes);
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_EQ(table.rows[0].size(), table.header.size());
  EXPECT_EQ(table.rows[2][5], "") << "no error without epochs";
  const evaluation::TextTable summary = fault_summary(outcomes);
  ASSERT_EQ(summary.rows.size(), 1u);
  EXPECT_EQ(summary.rows[0][1], "0 / 1 / 1");
  EXPECT_THAT(summary.rows[0][2], testing::EndsWith(" / -"));
  EXPECT_EQ(summary.rows[0][5], "yes / yes / -");
}

}  // namespace
}  // namespace foucault::laboratory
