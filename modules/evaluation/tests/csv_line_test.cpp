#include "foucault/evaluation/csv_line.h"

#include <gtest/gtest.h>

namespace foucault::evaluation {
namespace {

TEST(CsvLine, QuotesWhatWouldBreakIt) {
  const std::vector<std::string> cells{"plain", "a,b", "say \"no\"", "", "two\nlines"};
  EXPECT_EQ(csv_line(cells), "plain,\"a,b\",\"say \"\"no\"\"\",,\"two\nlines\"");
}

}  // namespace
}  // namespace foucault::evaluation
