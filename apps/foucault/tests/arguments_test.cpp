#include "arguments.h"

#include <gtest/gtest.h>

#include "foucault/core/error.h"

namespace foucault::app {
namespace {

TEST(Arguments, VectorsOfThree) {
  EXPECT_EQ(parse_vector3("--lever-arm", "0.1,-0.3,-0.8"), Eigen::Vector3d(0.1, -0.3, -0.8));
  for (const char* wrong : {"", "1,2", "1,2,3,4", "1 2 3", "1,2,x", "1,2,nan"}) {
    EXPECT_THROW(parse_vector3("--lever-arm", wrong), UsageError) << wrong;
  }
}

}  // namespace
}  // namespace foucault::app
