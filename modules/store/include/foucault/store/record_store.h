#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/error.h"
#include "foucault/store/key.h"

/// Results that outlive a kill, and that many processes on many machines add to at once: a file
/// each, named by the hash of all that it depends on. Whoever computes a record writes the same, so
/// that nobody has to wait for anybody.
namespace foucault::store {

struct Record {
  std::string content;  ///< the same whoever computes it
  double cpu_s = 0;     ///< what it took; no part of the content
};

/// A store cannot be read or written.
class StoreError : public DataError {
 public:
  using DataError::DataError;
};

/// All calls from any thread.
class Records {
 public:
  virtual ~Records() = default;
  /// What one that is damaged is told only by find().
  virtual bool has(const Key& key) const = 0;
  virtual std::optional<Record> find(const Key& key) = 0;
  virtual void put(const Key& key, const Record& record) = 0;
};

/// For what need not outlive the process.
class MemoryRecords : public Records {
 public:
  bool has(const Key& key) const override;
  std::optional<Record> find(const Key& key) override;
  void put(const Key& key, const Record& record) override;

 private:
  mutable std::mutex mutex_;
  std::map<Key, Record> records_;
};

/// Records in a folder: DIR/ab/cdef... of the hexadecimal key. Any file system will do that renames
/// in one step. The folder is made with the first record.
class RecordStore : public Records {
 public:
  explicit RecordStore(std::string folder) : folder_(std::move(folder)) {}

  bool has(const Key& key) const override;
  /// A damaged one is moved to DIR/damaged, with a remark, and none is there. Throws StoreError.
  std::optional<Record> find(const Key& key) override;
  /// Written beside, synced, renamed: on the disk when this returns. Throws StoreError.
  void put(const Key& key, const Record& record) override;

  /// What was damaged, a line each.
  std::vector<std::string> remarks() const;

  const std::string& folder() const { return folder_; }

 private:
  std::string path_of(const Key& key) const;
  void set_aside(const Key& key, const std::string& why);

  std::string folder_;
  mutable std::mutex mutex_;
  std::vector<std::string> remarks_;
};

}  // namespace foucault::store
