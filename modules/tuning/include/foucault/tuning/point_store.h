#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

/// Results that outlive a kill: a CSV file to which each finished one is added for good.
namespace foucault::tuning {

/// Something that the results depend on, e.g. {"logs", hash}.
struct Fingerprint {
  std::string name;
  std::string value;
};

/// 16 hexadecimal digits of FNV-1a (64 bit).
std::string hash_text(const std::string& text);
/// Of size and content. Throws DataError if the file cannot be read.
std::string hash_file(const std::string& path);

/// Rows of a CSV file. The first `keys` columns of a row name it, the others are its results.
/// Before the header stands a comment line for each fingerprint. A last line without its end, left
/// by a kill, is cut off. One process at a time may hold the file.
class PointStore {
 public:
  using Cells = std::vector<std::string>;

  /// Opens `path`, makes it if need be. Throws DataError if it cannot be read or written, belongs
  /// to something with other fingerprints (naming which) or another header, is held by another
  /// process, or is damaged (naming the line).
  PointStore(const std::string& path, const std::vector<Fingerprint>& fingerprints,
             const Cells& header, std::size_t keys);
  ~PointStore();
  PointStore(const PointStore&) = delete;
  PointStore& operator=(const PointStore&) = delete;

  /// The results of a row.
  std::optional<Cells> find(const Cells& key) const;

  /// Adds a row; it is on the disk when this returns. From any thread. Throws DataError.
  void add(const Cells& key, const Cells& results);

  std::size_t size() const;

 private:
  void open();
  void create(const std::string& head);
  void load(const std::string& text, const std::vector<Fingerprint>& fingerprints,
            const Cells& header);
  void write(const std::string& text);
  [[noreturn]] void fail(const std::string& what) const;

  std::string path_;
  std::size_t keys_;
  int file_ = -1;
  mutable std::mutex mutex_;
  std::map<Cells, Cells> rows_;
};

}  // namespace foucault::tuning
