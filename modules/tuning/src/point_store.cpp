#include "foucault/tuning/point_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>

#include "foucault/core/error.h"
#include "foucault/evaluation/csv_line.h"

namespace foucault::tuning {
namespace {

/// Fowler, Noll and Vo's hash 1a, 64 bit.
class Fnv {
 public:
  void add(const char* bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      hash_ = (hash_ ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3u;
    }
  }
  std::string text() const { return fmt::format("{:016x}", hash_); }

 private:
  uint64_t hash_ = 0xcbf29ce484222325u;
};

std::string fingerprint_line(const Fingerprint& f) {
  return fmt::format("# {}: {}\n", f.name, f.value);
}

std::string read_all(int file) {
  std::string text;
  std::array<char, 65536> block;
  ssize_t count = 0;
  while ((count = read(file, block.data(), block.size())) > 0) {
    text.append(block.data(), static_cast<std::size_t>(count));
  }
  return text;
}

/// Takes lines off the front of a text.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  std::optional<std::string_view> next() {
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    ++number_;
    return line;
  }
  int number() const { return number_; }

 private:
  std::string_view rest_;
  int number_ = 0;
};

}  // namespace

std::string hash_text(const std::string& text) {
  Fnv hash;
  hash.add(text.data(), text.size());
  return hash.text();
}

std::string hash_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw DataError(fmt::format("cannot read '{}': {}", path, std::strerror(errno)));
  Fnv hash;
  std::vector<char> block(1 << 20);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0) {
    hash.add(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  return hash.text();
}

PointStore::PointStore(const std::string& path, const std::vector<Fingerprint>& fingerprints,
                       const Cells& header, std::size_t keys)
    : path_(path), keys_(keys) {
  std::string head;
  for (const Fingerprint& f : fingerprints) head += fingerprint_line(f);
  head += evaluation::csv_line(header) + "\n";
  open();
  try {
    const std::string text = read_all(file_);
    // A kill while the head is written leaves a part of it.
    if (text.size() < head.size() && head.compare(0, text.size(), text) == 0) {
      create(head);
    } else {
      load(text, fingerprints, header);
    }
  } catch (...) {
    close(file_);
    throw;
  }
}

PointStore::~PointStore() { close(file_); }

void PointStore::open() {
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) fail(std::strerror(errno));
  if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
    close(file_);
    fail("another process is at work on it; wait for its end or give another --out");
  }
}

void PointStore::create(const std::string& head) {
  if (ftruncate(file_, 0) != 0 || lseek(file_, 0, SEEK_SET) < 0) fail(std::strerror(errno));
  write(head);
}

void PointStore::load(const std::string& text, const std::vector<Fingerprint>& fingerprints,
                      const Cells& header) {
  Lines lines(text);
  for (const Fingerprint& f : fingerprints) {
    const std::optional<std::string_view> line = lines.next();
    if (line && std::string(*line) + "\n" == fingerprint_line(f)) continue;
    fail(fmt::format("belongs to another search, with other {}; give another --out", f.name));
  }
  const std::optional<std::string_view> titles = lines.next();
  if (!titles || *titles != evaluation::csv_line(header)) {
    fail(fmt::format("line {}: not the expected header; give another --out", lines.number()));
  }
  while (const std::optional<std::string_view> line = lines.next()) {
    const std::optional<Cells> cells = evaluation::split_csv_line(*line);
    if (!cells || cells->size() != header.size()) {
      fail(fmt::format("line {}: damaged; remove the line", lines.number()));
    }
    const auto results = cells->begin() + static_cast<std::ptrdiff_t>(keys_);
    rows_[Cells(cells->begin(), results)] = Cells(results, cells->end());
  }
  const std::size_t whole = text.rfind('\n') + 1;
  if (ftruncate(file_, static_cast<off_t>(whole)) != 0) fail(std::strerror(errno));
  if (lseek(file_, 0, SEEK_END) < 0) fail(std::strerror(errno));
}

std::optional<PointStore::Cells> PointStore::find(const Cells& key) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = rows_.find(key);
  if (found == rows_.end()) return std::nullopt;
  return found->second;
}

void PointStore::add(const Cells& key, const Cells& results) {
  Cells cells = key;
  cells.insert(cells.end(), results.begin(), results.end());
  const std::lock_guard<std::mutex> lock(mutex_);
  write(evaluation::csv_line(cells) + "\n");
  rows_[key] = results;
}

std::size_t PointStore::size() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return rows_.size();
}

/// Of a line that does not get through nothing stays, for others to be added.
void PointStore::write(const std::string& text) {
  const off_t begin = lseek(file_, 0, SEEK_CUR);
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = ::write(file_, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int why = errno;
      if (ftruncate(file_, begin) == 0) lseek(file_, begin, SEEK_SET);
      fail(std::strerror(why));
    }
    done += static_cast<std::size_t>(count);
  }
  if (fdatasync(file_) != 0) fail(std::strerror(errno));
}

void PointStore::fail(const std::string& what) const {
  throw DataError(fmt::format("{}: {}", path_, what));
}

}  // namespace foucault::tuning
