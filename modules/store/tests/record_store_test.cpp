#include "foucault/store/record_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <thread>
#include <vector>

#include "support/test_folder.h"

namespace foucault::store {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string path_in(const std::string& folder, const Key& key) {
  return folder + "/" + hex(key).substr(0, 2) + "/" + hex(key).substr(2);
}

class RecordStoreTest : public testing::Test {
 protected:
  test::TestFolder folder_;
  std::string path_ = folder_ / "store";
  Key key_ = key_of("a run");
  Record record_{std::string("con\0tent", 8), 1.25};
};

TEST_F(RecordStoreTest, GivesBackWhatWasPut) {
  RecordStore store(path_);
  EXPECT_FALSE(store.has(key_));
  EXPECT_FALSE(store.find(key_));
  EXPECT_FALSE(fs::exists(path_)) << "nothing was put yet";
  store.put(key_, record_);
  RecordStore another(path_);
  EXPECT_TRUE(another.has(key_));
  ASSERT_TRUE(another.find(key_));
  EXPECT_EQ(another.find(key_)->content, record_.content);
  EXPECT_EQ(another.find(key_)->cpu_s, 1.25);
  EXPECT_FALSE(another.has(key_of("another")));
}

/// But for the last eight bytes, the time of the processor.
TEST_F(RecordStoreTest, SameContentSameBytes) {
  RecordStore(path_).put(key_, record_);
  const std::string name = path_in("store", key_);
  const std::string first = folder_.text(name);
  RecordStore(path_).put(key_, {record_.content, 2.5});
  const std::string second = folder_.text(name);
  EXPECT_NE(first, second);
  EXPECT_EQ(first.substr(0, first.size() - 8), second.substr(0, second.size() - 8));
}

TEST_F(RecordStoreTest, ADamagedRecordIsNamedAndSetAside) {
  RecordStore(path_).put(key_, record_);
  const std::string name = path_in("store", key_);
  const std::string whole = folder_.text(name);
  std::vector<std::string> damaged{"", "x", whole.substr(0, whole.size() - 1), whole + "x"};
  for (std::size_t at = 0; at < whole.size() - 8; ++at) {
    damaged.push_back(whole);
    damaged.back()[at] = static_cast<char>(damaged.back()[at] ^ 1);
  }
  for (const std::string& bytes : damaged) {
    folder_.write(name, bytes);
    RecordStore store(path_);
    EXPECT_FALSE(store.find(key_));
    EXPECT_FALSE(store.has(key_));
    EXPECT_THAT(store.remarks(), ElementsAre(AllOf(HasSubstr(hex(key_).substr(2)),
                                                   HasSubstr("damaged"), HasSubstr("again"))));
    EXPECT_EQ(folder_.text("store/damaged/" + hex(key_)), bytes);
    store.put(key_, record_);
    EXPECT_EQ(store.find(key_)->content, record_.content);
  }
}

TEST_F(RecordStoreTest, ARecordUnderAnotherNameIsNone) {
  RecordStore store(path_);
  const Key other = key_of("another");
  store.put(key_, record_);
  store.put(other, record_);
  fs::copy_file(path_in(path_, key_), path_in(path_, other), fs::copy_options::overwrite_existing);
  EXPECT_FALSE(store.find(other));
  EXPECT_EQ(store.remarks().size(), 1u);
}

TEST_F(RecordStoreTest, WritersOfOneRecordDoNoHarm) {
  const std::string content(100'000, 'x');
  std::vector<std::thread> writers;
  for (int i = 0; i < 4; ++i) {
    writers.emplace_back([&] {
      RecordStore store(path_);
      for (int k = 0; k < 25; ++k) {
        store.put(key_, {content, 1});
        const auto found = store.find(key_);
        EXPECT_TRUE(found && found->content == content);
      }
      EXPECT_THAT(store.remarks(), IsEmpty());
    });
  }
  for (std::thread& writer : writers) writer.join();
  const fs::path folder = fs::path(path_in(path_, key_)).parent_path();
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1) << "nothing is left beside it";
}

TEST_F(RecordStoreTest, WhatCannotBeWrittenIsOneLine) {
  folder_.write("store", "a file");
  try {
    RecordStore(path_).put(key_, record_);
    FAIL();
  } catch (const StoreError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr(path_), HasSubstr("--store")));
  }
}

TEST(MemoryRecordsTest, GivesBackWhatWasPut) {
  MemoryRecords records;
  EXPECT_FALSE(records.find(key_of("a")));
  records.put(key_of("a"), {"b", 1});
  EXPECT_TRUE(records.has(key_of("a")));
  EXPECT_EQ(records.find(key_of("a"))->content, "b");
}

}  // namespace
}  // namespace foucault::store
