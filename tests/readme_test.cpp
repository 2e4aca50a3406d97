#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/program.h"
#include "support/test_folder.h"

/// The README's figures are what the program draws today, by the commands that the README gives;
/// but for the flights, which take minutes.
/// After a change that is meant: FOUCAULT_RENEW_FIGURES=1, and the test puts the new ones there.
namespace foucault::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Sums of other compilers and processors move a line by a part of a pixel, and a last digit.
constexpr double kSameShare = 0.003;  // of the pixels may differ
constexpr double kSame = 48;          // by more than that [levels of 255]

fs::path documented(const std::string& name) {
  return tests_folder().parent_path() / "gui-free-reports/docs" / name;
}

double share_that_differs(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  int count = 0;
  for (int y = 0; y < difference.rows; ++y) {
    for (int x = 0; x < difference.cols; ++x) {
      const cv::Vec3b& pixel = difference.at<cv::Vec3b>(y, x);
      if (std::max({pixel[0], pixel[1], pixel[2]}) > kSame) ++count;
    }
  }
  return count / static_cast<double>(difference.total());
}

void expect_documented(const std::string& name, const std::string& drawn) {
  ASSERT_TRUE(fs::exists(drawn)) << drawn;
  if (std::getenv("FOUCAULT_RENEW_FIGURES") != nullptr) {
    fs::copy_file(drawn, documented(name), fs::copy_options::overwrite_existing);
  }
  const cv::Mat there = cv::imread(documented(name).string());
  const cv::Mat now = cv::imread(drawn);
  ASSERT_FALSE(there.empty()) << documented(name);
  ASSERT_EQ(there.size(), now.size()) << name << " is not what the program draws any more";
  EXPECT_LE(share_that_differs(there, now), kSameShare)
      << name << " is not what the program draws any more";
}

Outcome run_or_fail(const std::vector<std::string>& arguments) {
  Outcome outcome = foucault(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome;
}

/// Pages that a page leads to, beside figures and sections; each of them is there.
std::set<std::string> linked_pages(const TestFolder& folder, const std::string& page) {
  const std::string html = folder.text(page + "/index.html");
  const std::regex link("<a href=\"([^\"]+/index.html)\"");
  std::set<std::string> pages;
  for (std::sregex_iterator it(html.begin(), html.end(), link), end; it != end; ++it) {
    const fs::path target = (fs::path(page) / (*it)[1].str()).lexically_normal();
    EXPECT_TRUE(fs::exists(folder.path() / target)) << page << ": " << target;
    pages.insert(target.parent_path());
  }
  return pages;
}

TEST(Readme, DemoLeavesRecordingsASolutionTheTablesAndTheReportsThatAreShown) {
  const TestFolder folder;
  const Outcome demo = run_or_fail({"demo", "--out", folder / "demo"});
  EXPECT_THAT(demo.out, HasSubstr(folder / "demo/report/index.html"));
  for (const char* name : {"trip/solution.csv", "trip/metrics.json", "drift.csv", "metrics.json",
                           "tables/table_iii.md", "tables/table_iv.md", "tuned/metrics.json"}) {
    EXPECT_TRUE(fs::exists(folder / "demo" + ("/" + std::string(name)))) << name;
  }
  run_or_fail({"info", folder / "demo/recordings/ADIS16465-1617s.rawlog"});
  const std::set<std::string> pages{"demo/report", "demo/tuned/report", "demo/trip/report"};
  for (const std::string& page : pages) {
    std::set<std::string> all = linked_pages(folder, page);
    all.insert(page);
    EXPECT_EQ(all, pages) << "from " << page;
  }
  expect_documented("demo-track.png", folder / "demo/trip/report/ground_track.png");
  expect_documented("drift-rms.png", folder / "demo/report/drift_rms.png");
  expect_documented("drift-curves.png", folder / "demo/report/drift_curves_adis16465.png");
}

TEST(Readme, TheLaboratorysErrorsAreAsIsShown) {
  const TestFolder folder;
  run_or_fail({"lab", "preintegration", "--out", folder / "lab"});
  expect_documented("lab-preintegration.png", folder / "lab/report/lab_models_position.png");
}

TEST(Readme, ARampLooksAsIsShown) {
  const TestFolder folder;
  run_or_fail(
      {"simulate", "--duration", "460", "--fault", "ramp", "--out", folder / "ramp.rawlog"});
  run_or_fail({"run", folder / "ramp.rawlog", "--method", "full", "--out", folder / "ramp"});
  expect_documented("ramp-innovations.png", folder / "ramp/report/gnss_innovations.png");
}

}  // namespace
}  // namespace foucault::test
