#include "foucault/store/record_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <random>

#include "foucault/store/bytes.h"

namespace fs = std::filesystem;

namespace foucault::store {
namespace {

constexpr std::string_view kMark = "foucault record 1\n";

/// Closes a file, and removes one that did not come to its end.
class File {
 public:
  File(std::string path, int flags)
      : path_(std::move(path)), file_(open(path_.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~File() {
    if (file_ >= 0) close(file_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool is_open() const { return file_ >= 0; }

  /// Returns errno.
  int write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t count = ::write(file_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return errno;
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return fsync(file_) == 0 ? 0 : errno;
  }

  std::optional<std::string> read() const {
    std::string bytes;
    std::array<char, 65536> block;
    ssize_t count = 0;
    while ((count = ::read(file_, block.data(), block.size())) != 0) {
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return std::nullopt;
      bytes.append(block.data(), static_cast<std::size_t>(count));
    }
    return bytes;
  }

  /// Returns errno; some file systems report what was not written only now.
  int finish() {
    const int file = file_;
    file_ = -1;
    return close(file) == 0 ? 0 : errno;
  }

 private:
  std::string path_;
  int file_;
};

/// Of the key, too: a file under another name is no record.
std::string checksum(const Key& key, std::string_view content) {
  Sha256 hash;
  hash.add({reinterpret_cast<const char*>(key.data()), key.size()});
  hash.add(content);
  const Key sum = hash.finish();
  return {sum.begin(), sum.end()};
}

std::string encoded(const Key& key, const Record& record) {
  ByteWriter writer;
  writer.put(std::string_view(checksum(key, record.content)));
  writer.put(std::string_view(record.content));
  writer.put(record.cpu_s);
  return std::string(kMark) + writer.bytes();
}

/// Throws BytesError saying what is wrong.
Record decoded(const Key& key, std::string_view bytes) {
  if (bytes.substr(0, kMark.size()) != kMark) throw BytesError("not a record");
  ByteReader reader(bytes.substr(kMark.size()));
  const std::string sum = reader.text();
  Record record;
  record.content = reader.text();
  record.cpu_s = reader.number();
  reader.finish();
  if (sum != checksum(key, record.content)) throw BytesError("its checksum is another");
  return record;
}

/// A name that nobody else uses, on whatever machine.
std::string name_beside(const std::string& path) {
  std::random_device random;
  const uint64_t number = uint64_t{random()} << 32 | random();
  return fmt::format("{}.{:016x}.tmp", path, number);
}

[[noreturn]] void fail(const std::string& folder, const char* what, int error) {
  throw StoreError(fmt::format("cannot {} the store '{}': {}; free it or give another --store",
                               what, folder, std::strerror(error)));
}

/// So that the name is on the disk, too; where folders cannot be synced the file system does it.
void sync_folder(const fs::path& folder) {
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  fsync(file);
  close(file);
}

/// Writes a new file. Returns errno, and leaves nothing if that is not 0.
int write_new(const std::string& path, const std::string& bytes) {
  File file(path, O_WRONLY | O_CREAT | O_EXCL);
  if (!file.is_open()) return errno;
  int error = file.write(bytes);
  if (const int closing = file.finish(); error == 0) error = closing;
  if (error != 0) unlink(path.c_str());
  return error;
}

}  // namespace

bool MemoryRecords::has(const Key& key) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return records_.count(key) > 0;
}

std::optional<Record> MemoryRecords::find(const Key& key) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = records_.find(key);
  if (found == records_.end()) return std::nullopt;
  return found->second;
}

void MemoryRecords::put(const Key& key, const Record& record) {
  const std::lock_guard<std::mutex> lock(mutex_);
  records_.insert_or_assign(key, record);
}

std::string RecordStore::path_of(const Key& key) const {
  const std::string name = hex(key);
  return (fs::path(folder_) / name.substr(0, 2) / name.substr(2)).string();
}

bool RecordStore::has(const Key& key) const {
  struct stat there {};
  return stat(path_of(key).c_str(), &there) == 0;
}

std::optional<Record> RecordStore::find(const Key& key) {
  const File file(path_of(key), O_RDONLY);
  if (!file.is_open()) {
    if (errno == ENOENT || errno == ENOTDIR) return std::nullopt;
    fail(folder_, "read", errno);
  }
  const std::optional<std::string> bytes = file.read();
  if (!bytes) fail(folder_, "read", errno);
  try {
    return decoded(key, *bytes);
  } catch (const BytesError& error) {
    set_aside(key, error.what());
    return std::nullopt;
  }
}

void RecordStore::put(const Key& key, const Record& record) {
  const fs::path path = path_of(key);
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) fail(folder_, "write to", error.value());
  const std::string beside = name_beside(path);
  if (const int why = write_new(beside, encoded(key, record))) fail(folder_, "write to", why);
  if (rename(beside.c_str(), path.c_str()) != 0) {
    const int why = errno;
    unlink(beside.c_str());
    fail(folder_, "write to", why);
  }
  sync_folder(path.parent_path());
}

void RecordStore::set_aside(const Key& key, const std::string& why) {
  const fs::path aside = fs::path(folder_) / "damaged" / hex(key);
  std::error_code error;
  fs::create_directories(aside.parent_path(), error);
  if (!error) fs::rename(path_of(key), aside, error);
  const std::string where =
      error ? "could not be moved away" : fmt::format("was moved to '{}'", aside.string());
  const std::lock_guard<std::mutex> lock(mutex_);
  remarks_.push_back(fmt::format("record {} is damaged ({}); it {} and is computed again",
                                 path_of(key), why, where));
}

std::vector<std::string> RecordStore::remarks() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return remarks_;
}

}  // namespace foucault::store
