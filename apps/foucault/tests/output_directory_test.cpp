#include "output_directory.h"

#include <gtest/gtest.h>

#include "foucault/core/error.h"
#include "foucault/export/text_file.h"
#include "support/test_folder.h"

namespace foucault::app {
namespace {

namespace fs = std::filesystem;
using test::TestFolder;

TEST(OutputDirectory, LeavesNothingWithoutCommit) {
  const TestFolder folder;
  {
    const OutputDirectory out(folder / "new");
    exports::write_text_file(out.staging() / "a.txt", "half");
  }
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(OutputDirectory, AppearsWithCommit) {
  const TestFolder folder;
  OutputDirectory out(folder / "deep/new/");
  exports::write_text_file(out.staging() / "a.txt", "whole");
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
    folder_.write("run/report/report.json", "old");
    folder_.write("run/notes.txt", "mine");
  }
  TestFolder folder_;
};

TEST_F(OverEarlierResults, TheyStayWithoutCommit) {
  {
    const OutputDirectory out(folder_ / "run");
    exports::write_text_file(out.staging() / "a.txt", "half");
  }
  EXPECT_EQ(folder_.text("run/a.txt"), "old");
  EXPECT_TRUE(fs::exists(folder_ / "run/report/old.png"));
  EXPECT_EQ(folder_.entries(), 1u);
}

TEST_F(OverEarlierResults, WhatIsWithdrawnGoesUnlessItIsWrittenAnew) {
  OutputDirectory out(folder_ / "run");
  exports::write_text_file(out.staging() / "a.txt", "new");
  for (const char* name : {"report", "a.txt", "none"}) out.withdraw(name);
  out.commit();
  EXPECT_FALSE(fs::exists(folder_ / "run/report"));
  EXPECT_EQ(folder_.text("run/a.txt"), "new");
  EXPECT_EQ(folder_.text("run/notes.txt"), "mine");
}

TEST_F(OverEarlierResults, WithoutCommitNothingIsWithdrawn) {
  {
    OutputDirectory out(folder_ / "run");
    out.withdraw("report");
  }
  EXPECT_TRUE(fs::exists(folder_ / "run/report/old.png"));
}

TEST_F(OverEarlierResults, CommitReplacesWhatItWritesAndNothingElse) {
  {
    OutputDirectory out(folder_ / "run");
    exports::write_text_file(out.staging() / "a.txt", "new");
    fs::create_directory(out.staging() / "report");
    exports::write_text_file(out.staging() / "report" / "new.png", "new");
    out.commit();
  }
  EXPECT_EQ(folder_.text("run/a.txt"), "new");
  EXPECT_EQ(folder_.text("run/report/new.png"), "new");
  EXPECT_FALSE(fs::exists(folder_ / "run/report/old.png"));
  EXPECT_EQ(folder_.text("run/notes.txt"), "mine");
  const fs::directory_iterator begin(folder_.path() / "run");
  EXPECT_EQ(std::distance(begin, fs::directory_iterator{}), 3);  // the staging folder is gone
}

TEST_F(OverEarlierResults, AllAreKeptIfOneCannotBeReplaced) {
  fs::create_directory(folder_.path() / "run/z.txt");  // where a file is to come
  {
    OutputDirectory out(folder_ / "run");
    exports::write_text_file(out.staging() / "a.txt", "new");
    fs::create_directory(out.staging() / "report");
    exports::write_text_file(out.staging() / "z.txt", "new");
    EXPECT_THROW(out.commit(), DataError);
  }
  EXPECT_EQ(folder_.text("run/a.txt"), "old");
  EXPECT_EQ(folder_.text("run/report/old.png"), "old");
  EXPECT_TRUE(fs::is_directory(folder_ / "run/z.txt"));
  const fs::directory_iterator begin(folder_.path() / "run");
  EXPECT_EQ(std::distance(begin, fs::directory_iterator{}), 4);
}

TEST_F(OverEarlierResults, AReportOfAnotherOriginIsNotReplaced) {
  fs::remove(folder_ / "run/report/report.json");
  EXPECT_THROW(OutputDirectory(folder_ / "run"), DataError);
  EXPECT_TRUE(fs::exists(folder_ / "run/report/old.png"));
  fs::remove(folder_ / "run/report/old.png");
  EXPECT_NO_THROW(OutputDirectory(folder_ / "run"));
}

TEST_F(OverEarlierResults, AFolderThatAppearedMeanwhileIsNotLost) {
  OutputDirectory first(folder_ / "new");
  OutputDirectory second(folder_ / "new");
  exports::write_text_file(first.staging() / "a.txt", "first");
  exports::write_text_file(first.staging() / "b.txt", "first");
  exports::write_text_file(second.staging() / "a.txt", "second");
  first.commit();
  second.commit();
  EXPECT_EQ(folder_.text("new/a.txt"), "second");
  EXPECT_EQ(folder_.text("new/b.txt"), "first");
}

TEST_F(OverEarlierResults, WhatWasLeftBehindIsClearedAwayButNotWhatIsInUse) {
  // As of a process that was killed: nobody holds them.
  for (const char* left :
       {"run/.foucault-abcdef", ".run.foucault-abcdef", ".new.foucault-abcdef"}) {
    fs::create_directory(folder_.path() / left);
    folder_.write(std::string(left) + "/a.txt", "half");
  }
  fs::create_directory(folder_.path() / ".run.foucault-my-notes");  // not a name that we make
  const OutputDirectory in_use(folder_ / "run");
  const OutputDirectory another(folder_ / "run");
  EXPECT_FALSE(fs::exists(folder_ / "run/.foucault-abcdef"));
  EXPECT_FALSE(fs::exists(folder_ / ".run.foucault-abcdef"));
  EXPECT_TRUE(fs::exists(folder_ / ".run.foucault-my-notes"));
  EXPECT_TRUE(fs::exists(folder_ / ".new.foucault-abcdef"));  // another target's
  EXPECT_TRUE(fs::exists(in_use.staging()));
  EXPECT_TRUE(fs::exists(another.staging()));
}

/// Somebody who makes the path again does not make the results whole again.
TEST(OutputDirectory, NoticesThatItsFolderWasRemoved) {
  const TestFolder folder;
  OutputDirectory out(folder / "new");
  exports::write_text_file(out.staging() / "a.txt", "whole");
  fs::remove_all(out.staging());
  fs::create_directory(out.staging());
  EXPECT_THROW(out.commit(), DataError);
  EXPECT_FALSE(fs::exists(folder / "new"));
}

TEST(OutputDirectory, RefusesAFileAndWhatLiesUnderOne) {
  const TestFolder folder;
  folder.write("file", "");
  EXPECT_THROW(OutputDirectory(folder / "file"), DataError);
  EXPECT_THROW(OutputDirectory(folder / "file/run"), DataError);
  fs::create_symlink("nowhere", folder / "link");
  EXPECT_THROW(OutputDirectory(folder / "link"), DataError);
  EXPECT_THROW(OutputDirectory(""), UsageError);
}

}  // namespace
}  // namespace foucault::app
