#include "foucault/tuning/point_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "foucault/core/error.h"
#include "foucault/evaluation/csv_line.h"

namespace foucault::tuning {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<Fingerprint> kFingerprints{{"logs", "0123"}, {"grid", "4567"}};
const std::vector<std::string> kHeader{"method", "a", "value"};

class PointStoreTest : public testing::Test {
 protected:
  PointStoreTest() {
    std::string name = (std::filesystem::temp_directory_path() / "points-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    path_ = folder_ / "points.csv";
  }
  ~PointStoreTest() override { std::filesystem::remove_all(folder_); }

  std::string text() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  void put(const std::string& text) const { std::ofstream(path_, std::ios::binary) << text; }
  std::string refusal(const std::vector<Fingerprint>& fingerprints = kFingerprints) const {
    try {
      PointStore store(path_, fingerprints, kHeader, 2);
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
  std::filesystem::path path_;
};

TEST_F(PointStoreTest, KeepsWhatWasAdded) {
  {
    PointStore store(path_, kFingerprints, kHeader, 2);
    store.add({"ekf", "[0, 75]"}, {"5.25"});
    store.add({"ekf", "1"}, {"inf"});
  }
  const PointStore again(path_, kFingerprints, kHeader, 2);
  EXPECT_EQ(again.size(), 2u);
  EXPECT_THAT(*again.find({"ekf", "[0, 75]"}), ElementsAre("5.25"));
  EXPECT_FALSE(again.find({"ekf", "2"}));
  EXPECT_EQ(text(),
            "# logs: 0123\n# grid: 4567\nmethod,a,value\nekf,\"[0, 75]\",5.25\nekf,1,inf\n");
}

TEST_F(PointStoreTest, AKillAtAnyByteLosesAtMostTheLineBeingWritten) {
  {
    PointStore store(path_, kFingerprints, kHeader, 2);
    for (const char* a : {"1", "2", "3"}) store.add({"ekf", a}, {"5"});
  }
  const std::string whole = text();
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    put(whole.substr(0, length));
    {
      PointStore store(path_, kFingerprints, kHeader, 2);
      for (const char* a : {"1", "2", "3"}) {
        if (!store.find({"ekf", a})) store.add({"ekf", a}, {"5"});
      }
    }
    ASSERT_EQ(text(), whole) << "cut after " << length << " bytes";
  }
}

TEST_F(PointStoreTest, RefusesAnotherSearch) {
  { PointStore store(path_, kFingerprints, kHeader, 2); }
  EXPECT_EQ(refusal(), "");
  EXPECT_THAT(refusal({{"logs", "0123"}, {"grid", "9999"}}), HasSubstr("with other grid"));
  EXPECT_THAT(refusal({{"logs", "9999"}, {"grid", "4567"}}), HasSubstr("with other logs"));
}

TEST_F(PointStoreTest, RefusesDamage) {
  { PointStore store(path_, kFingerprints, kHeader, 2); }
  const std::string head = text();
  put(head + "ekf,1\nekf,2,5\n");
  EXPECT_THAT(refusal(), HasSubstr("line 4: damaged"));
  put("something else\n");
  EXPECT_THAT(refusal(), HasSubstr("another search"));
}

TEST_F(PointStoreTest, OneAtATime) {
  const PointStore store(path_, kFingerprints, kHeader, 2);
  EXPECT_THAT(refusal(), HasSubstr("another process"));
}

/// A file that must not grow by more than half a line.
TEST_F(PointStoreTest, ALineIsThereWholeOrNotAtAll) {
  PointStore store(path_, kFingerprints, kHeader, 2);
  const std::string before = text();
  rlimit old;
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit tight{before.size() + 4, old.rlim_max};
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &tight);
  EXPECT_THROW(store.add({"ekf", "1"}, {"5"}), DataError);
  setrlimit(RLIMIT_FSIZE, &old);
  signal(SIGXFSZ, handler);
  EXPECT_EQ(text(), before);
  store.add({"ekf", "2"}, {"6"});
  EXPECT_EQ(text(), before + "ekf,2,6\n");
}

TEST_F(PointStoreTest, SaysWhatCannotBeWritten) {
  path_ = folder_ / "missing" / "points.csv";
  EXPECT_THAT(refusal(), HasSubstr("missing/points.csv"));
}

TEST(Hash, KnownValues) {
  EXPECT_EQ(hash_text(""), "cbf29ce484222325");
  EXPECT_EQ(hash_text("a"), "af63dc4c8601ec8c");  // of the authors' test vectors
}

TEST(CsvLine, ReadsBack) {
  const std::vector<std::string> cells{"", "a,b", "say \"x\"", "plain"};
  EXPECT_EQ(*evaluation::split_csv_line(evaluation::csv_line(cells)), cells);
  EXPECT_FALSE(evaluation::split_csv_line("a,\"b"));
}

}  // namespace
}  // namespace foucault::tuning
