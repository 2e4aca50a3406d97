#include "foucault/reports/run_report.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "demo_run.h"

namespace foucault::reports {
namespace {

TEST(RunReport, WritesTheDemo) {
  RunReport report({"trip.rawlog", "refined", "foucault 0.1.0", "foucault run trip.rawlog --out x",
                    "imu:\n  preset: ADIS16465\n"},
                   Mounting{});
  fill_demo({}, report);
  const std::string folder = std::filesystem::temp_directory_path() / "foucault_demo_report";
  report.write(folder);
  EXPECT_TRUE(std::filesystem::exists(folder + "/index.html"));
}

}  // namespace
}  // namespace foucault::reports
