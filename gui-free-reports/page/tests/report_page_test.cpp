#include "foucault/page/report_page.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "foucault/core/error.h"

namespace foucault::page {

using namespace plot;

namespace {

namespace fs = std::filesystem;

std::map<std::string, std::string> files_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    files[entry.path().filename()] = text.str();
  }
  return files;
}

Figure small_figure(const std::string& name) {
  Figure figure;
  figure.name = name;
  figure.title = "Title of " + name;
  figure.caption = "a < b & c";
  figure.width_mm = 60;
  figure.height_mm = 50;
  figure.panels.resize(1);
  Series series;
  series.label = "y";
  series.x = {0, 1};
  series.y = {1.0 / 3, 2};
  figure.panels[0].series = {series};
  return figure;
}

ReportPage small_page() {
  ReportPage page;
  page.title = "Report";
  page.subtitle = "trip.rawlog";
  page.key_numbers = {{"RMS", "1.2", "cm", "note"}};
  Section section;
  section.title = "Section";
  section.paragraphs = {"Text."};
  section.tables = {{"Table", "note", false, {"a", "b"}, {{"x", "1"}, {"y", "2"}}}};
  section.figures = {small_figure("one"), small_figure("two")};
  section.details = {{"Details", "", true, {"when", "what"}, {{"1 s", "it"}}}};
  page.sections = {section};
  page.listings = {{"Configuration", "imu: {preset: X}"}};
  page.footer = "foucault 0";
  return page;
}

class ReportFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    base_ = fs::path(::testing::TempDir()) /
            ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(base_);
    fs::create_directories(base_);
  }
  void TearDown() override { fs::remove_all(base_); }

  fs::path base_;
};

TEST_F(ReportFolder, HoldsThePageAndEveryFigure) {
  write_report(small_page(), base_ / "report");
  const std::map<std::string, std::string> files = files_in(base_ / "report");
  for (const char* name : {"index.html", "report.json", "one.png", "one.csv", "one.json", "two.png",
                           "two.csv", "two.json", "one.svg", "two.svg"}) {
    EXPECT_EQ(files.count(name), 1U) << name;
  }
  EXPECT_EQ(files.size(), 10U);
  EXPECT_EQ(std::distance(fs::directory_iterator(base_), {}), 1) << "nothing is left beside it";
}

TEST_F(ReportFolder, PageNeedsNoNetwork) {
  write_report(small_page(), base_ / "report");
  const std::string html = files_in(base_ / "report").at("index.html");
  EXPECT_EQ(html.find("http://"), std::string::npos);
  EXPECT_EQ(html.find("https://"), std::string::npos);
  EXPECT_EQ(html.find("<script src"), std::string::npos) << "the script is in the page";
  EXPECT_NE(html.find("src=\"one.png\""), std::string::npos);
  EXPECT_NE(html.find("href=\"one.csv\""), std::string::npos);
  EXPECT_NE(html.find("a &lt; b &amp; c"), std::string::npos);
  EXPECT_NE(html.find("Figure 2."), std::string::npos);
}

TEST_F(ReportFolder, BannerStandsAboveEverythingElse) {
  ReportPage page = small_page();
  write_report(page, base_ / "report");
  EXPECT_EQ(files_in(base_ / "report").at("index.html").find("class=\"banner"), std::string::npos);
  page.banner = Banner{true, "Beware", {"fixes < truth", "clocks"}};
  write_report(page, base_ / "report");
  const std::map<std::string, std::string> before = files_in(base_ / "report");
  const std::string& html = before.at("index.html");
  const std::size_t banner =
      html.find("<div class=\"banner alarming\" role=\"alert\"><b>Beware</b>");
  ASSERT_NE(banner, std::string::npos);
  EXPECT_LT(banner, html.find("class=\"tiles\""));
  EXPECT_NE(html.find("<p>fixes &lt; truth</p>\n<p>clocks</p>"), std::string::npos);
  redraw_report(base_ / "report");
  EXPECT_EQ(files_in(base_ / "report"), before);
}

TEST_F(ReportFolder, LeadsToOtherPages) {
  ReportPage page = small_page();
  page.links = {{"Noise < tuned", "../../tuned/report/index.html"}};
  write_report(page, base_ / "report");
  const std::map<std::string, std::string> before = files_in(base_ / "report");
  EXPECT_NE(before.at("index.html")
                .find("<a href=\"../../tuned/report/index.html\">Noise &lt; tuned</a>"),
            std::string::npos);
  redraw_report(base_ / "report");
  EXPECT_EQ(files_in(base_ / "report"), before);
}

TEST_F(ReportFolder, RedrawnIsIdentical) {
  write_report(small_page(), base_ / "report");
  const std::map<std::string, std::string> before = files_in(base_ / "report");
  redraw_report(base_ / "report");
  EXPECT_EQ(files_in(base_ / "report"), before);
}

TEST_F(ReportFolder, RedrawsFromTheNumbersAlone) {
  write_report(small_page(), base_ / "report");
  const std::map<std::string, std::string> before = files_in(base_ / "report");
  for (const char* name : {"index.html", "one.png", "two.png"}) {
    fs::remove(base_ / "report" / name);
  }
  redraw_report(base_ / "report");
  EXPECT_EQ(files_in(base_ / "report"), before);
}

TEST_F(ReportFolder, ReplacesAnOlderReportOnly) {
  write_report(small_page(), base_ / "report");
  ReportPage page = small_page();
  page.sections[0].figures.pop_back();
  write_report(page, base_ / "report");
  EXPECT_EQ(files_in(base_ / "report").count("two.png"), 0U);

  fs::create_directories(base_ / "mine");
  std::ofstream(base_ / "mine" / "thesis.txt") << "precious";
  EXPECT_THROW(write_report(small_page(), base_ / "mine"), DataError);
  EXPECT_TRUE(fs::exists(base_ / "mine" / "thesis.txt"));
}

TEST_F(ReportFolder, FailureLeavesTheOldOneAndNothingElse) {
  write_report(small_page(), base_ / "report");
  const std::map<std::string, std::string> before = files_in(base_ / "report");
  ReportPage broken = small_page();
  broken.sections[0].figures[1].panels[0].series[0].y.clear();
  EXPECT_THROW(write_report(broken, base_ / "report"), DataError);
  EXPECT_EQ(files_in(base_ / "report"), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(base_), {}), 1);
}

TEST_F(ReportFolder, RefusesTwoFiguresOfOneName) {
  ReportPage page = small_page();
  page.sections[0].figures = {small_figure("one"), small_figure("one")};
  EXPECT_THROW(write_report(page, base_ / "report"), DataError);
  EXPECT_FALSE(fs::exists(base_ / "report"));
}

TEST_F(ReportFolder, RedrawingWhatIsNoReportIsAnError) {
  EXPECT_THROW(redraw_report(base_), DataError);
  std::ofstream(base_ / "report.json") << "[";
  EXPECT_THROW(redraw_report(base_), DataError);
}

}  // namespace
}  // namespace foucault::page
