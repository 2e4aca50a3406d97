#include "../src/fix_gate.h"

#include <gtest/gtest.h>

#include "fake_run.h"

namespace foucault::navigation {
namespace {

using diagnosis::FixDecision;
using testing::at;
using testing::fix_at;

state::Innovation innovation(double metres) {
  return {Eigen::Vector3d(metres, 0, 0), 0.01 * Eigen::Matrix3d::Identity()};
}

/// Started at 0 ms, with fixes once a second that agree, up to 12 s.
FixGate settled() {
  FixGate gate{diagnosis::GnssOptions{}};
  gate.start(at(0));
  for (int s = 1; s <= 12; ++s) {
    EXPECT_TRUE(gate.decide(fix_at(1000 * s), innovation(0.1), 1));
    gate.used(at(1000 * s));
  }
  return gate;
}

TEST(FixGate, WhatAgreesIsUsed) {
  FixGate gate = settled();
  const std::optional<FixDecision> decision = gate.decide(fix_at(13000), innovation(0.1), 1);
  ASSERT_TRUE(decision);
  EXPECT_EQ(decision->action, FixDecision::Action::use);
  EXPECT_EQ(decision->fix.t_ns, at(13000));
}

TEST(FixGate, WhatDoesNotAgreeIsInDoubt) {
  FixGate gate = settled();
  EXPECT_FALSE(gate.decide(fix_at(13000), innovation(5), 1));
  gate.doubt_state(at(13000));  // now the state is
  EXPECT_TRUE(gate.decide(fix_at(14000), innovation(5), 1));
}

/// Longer than 2.5 s and than 3.5 usual intervals.
TEST(FixGate, TheFirstAfterAnOutageIsInDoubt) {
  for (const auto& [after_s, usual, doubted] :
       {std::tuple{3, 1.0, false}, {4, 1.0, true}, {2, 0.1, false}, {3, 0.1, true}}) {
    FixGate gate = settled();
    const GnssFix fix = fix_at(12000 + 1000 * after_s);
    EXPECT_EQ(gate.decide(fix, innovation(0.1), usual).has_value(), !doubted) << after_s;
    EXPECT_EQ(gate.is_unheld(fix), after_s > 2) << after_s;
  }
}

TEST(FixGate, WhatWasDecidedBeforeIsDoneOnce) {
  FixGate gate = settled();
  diagnosis::DoubtOutcome outcome;
  outcome.fixes = {{FixDecision::Action::leave_out, fix_at(13000), {}}};
  gate.learn(outcome);
  EXPECT_EQ(gate.decide(fix_at(13000), innovation(0), 1)->action, FixDecision::Action::leave_out);
  EXPECT_EQ(gate.decide(fix_at(13000), innovation(0), 1)->action, FixDecision::Action::use);
}

}  // namespace
}  // namespace foucault::navigation
