#include "foucault/plot/text.h"

#include <gtest/gtest.h>

#include <limits>

namespace foucault::plot {
namespace {

TEST(NumberText, UsesATrueMinusAndNoNegativeZero) {
  EXPECT_EQ(number_text(-1.25, 1), "−1.2");
  EXPECT_EQ(number_text(-0.01, 1), "0.0");
  EXPECT_EQ(number_text(1234, 0), "1234");
  EXPECT_EQ(number_text(12345.5, 1), "12\u2009345.5");
  EXPECT_EQ(number_text(std::numeric_limits<double>::quiet_NaN(), 1), "–");
}

TEST(SignificantText, KeepsThreeDigits) {
  EXPECT_EQ(significant_text(0.012345), "0.0123");
  EXPECT_EQ(significant_text(-3.14159), "−3.14");
  EXPECT_EQ(significant_text(99.96), "100.0");
  EXPECT_EQ(significant_text(0), "0");
  EXPECT_EQ(significant_text(4.2e-9), "4.20×10⁻⁹");
  EXPECT_EQ(significant_text(-6.1e12, 2), "−6.1×10¹²");
  EXPECT_EQ(significant_text(std::numeric_limits<double>::infinity()), "–");
}

TEST(PowerOfTen, StandsInSmallDigits) {
  EXPECT_EQ(power_of_ten(0), "10⁰");
  EXPECT_EQ(power_of_ten(-307), "10⁻³⁰⁷");
}

TEST(Joined, LeavesOutWhatIsEmpty) {
  EXPECT_EQ(joined({"a", "", "b"}, " · "), "a · b");
  EXPECT_EQ(joined({"", ""}, ", "), "");
  EXPECT_EQ(joined({}, ", "), "");
}

}  // namespace
}  // namespace foucault::plot
