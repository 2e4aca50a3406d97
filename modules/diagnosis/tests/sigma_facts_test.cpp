#include "foucault/diagnosis/sigma_facts.h"

#include <gtest/gtest.h>

#include <limits>

namespace foucault::diagnosis {
namespace {

TEST(SigmaFacts, CountsBadOnesAndKeepsTheRangeOfTheOthers) {
  SigmaFacts facts;
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  EXPECT_TRUE(facts.add(0.04 * I));
  EXPECT_TRUE(facts.add(9.0 * I));
  EXPECT_TRUE(facts.add(0.25 * I));
  EXPECT_FALSE(facts.add(0.0 * I));
  EXPECT_FALSE(facts.add(-1.0 * I));
  EXPECT_FALSE(facts.add(std::numeric_limits<double>::quiet_NaN() * I));
  EXPECT_EQ(facts.bad, 3);
  EXPECT_DOUBLE_EQ(facts.smallest_m, 0.2);
  EXPECT_DOUBLE_EQ(facts.largest_m, 3);
}

}  // namespace
}  // namespace foucault::diagnosis
