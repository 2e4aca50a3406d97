#include "output_directory.h"

#include <gtest/gtest.h>

#include "foucault/core/error.h"
#include "support/test_folder.h"
#include "text_file.h"

namespace foucault::app {
namespace {

namespace fs = std::filesystem;
using test::TestFolder;

TEST(OutputDirectory, LeavesNothingWithoutCommit) {
  const TestFolder folder;
  {
    const OutputDirectory out(folder / "new");
    write_text_file(out.staging() / "a.txt", "half");
  }
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(OutputDirectory, AppearsWithCommit) {
  const TestFolder folder;
  OutputDirectory out(folder / "deep/new/");
  write_text_file(out.staging() / "a.txt", "whole");
  EXPECT_FALSE(fs::exists(folder / "deep/new"));
  out.commit();
  EXPECT_EQ(folder.text("deep/new/a.txt"), "whole");
}

class OverEarlierResults : public testing::Test {
 protected:
  OverEarlierResults() {
    fs::create_directories(folder_.path() / "run/report");
    folder_.write("run/a.txt", "old");
    folder_.write("run/report/old.png", "old");
    folder_.write("run/notes.txt", "mine");
  }
  TestFolder folder_;
};

TEST_F(OverEarlierResults, TheyStayWithoutCommit) {
  {
    const OutputDirectory out(folder_ / "run");
    write_text_file(out.staging() / "a.txt", "half");
  }
  EXPECT_EQ(folder_.text("run/a.txt"), "old");
  EXPECT_TRUE(fs::exists(folder_ / "run/report/old.png"));
  EXPECT_EQ(folder_.entries(), 1u);
}

TEST_F(OverEarlierResults, CommitReplacesWhatItWritesAndNothingElse) {
  {
    OutputDirectory out(folder_ / "run");
    write_text_file(out.staging() / "a.txt", "new");
    fs::create_directory(out.staging() / "report");
    write_text_file(out.staging() / "report" / "new.png", "new");
    out.commit();
  }
  EXPECT_EQ(folder_.text("run/a.txt"), "new");
  EXPECT_EQ(folder_.text("run/report/new.png"), "new");
  EXPECT_FALSE(fs::exists(folder_ / "run/report/old.png"));
  EXPECT_EQ(folder_.text("run/notes.txt"), "mine");
  const fs::directory_iterator begin(folder_.path() / "run");
  EXPECT_EQ(std::distance(begin, fs::directory_iterator{}), 3);  // the staging folder is gone
}

TEST(OutputDirectory, RefusesAFileAndWhatLiesUnderOne) {
  const TestFolder folder;
  folder.write("file", "");
  EXPECT_THROW(OutputDirectory(folder / "file"), DataError);
  EXPECT_THROW(OutputDirectory(folder / "file/run"), DataError);
  EXPECT_THROW(OutputDirectory(""), UsageError);
}

}  // namespace
}  // namespace foucault::app
