#include "foucault/evaluation/csv_line.h"

#include <gtest/gtest.h>

namespace foucault::evaluation {
namespace {

TEST(CsvLine, ReadsBackWhatItWrites) {
  const std::vector<std::string> cells{"plain", "a,b", "say \"no\"", "", "two\nlines"};
  EXPECT_EQ(csv_line(cells), "plain,\"a,b\",\"say \"\"no\"\"\",,\"two\nlines\"");
  EXPECT_EQ(split_csv_line(csv_line(cells)), cells);
  EXPECT_EQ(split_csv_line(""), std::vector<std::string>{""});
  EXPECT_FALSE(split_csv_line("a,\"b").has_value());
}

}  // namespace
}  // namespace foucault::evaluation
