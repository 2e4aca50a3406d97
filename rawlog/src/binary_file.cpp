#include "binary_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace foucault::rawlog {

std::string BinaryFile::place(int64_t byte) const {
  return fmt::format("{}: byte {}", path_, byte);
}

bool BinaryFile::at_end() { return file_.window().size() == 0; }

bool BinaryFile::read(uint64_t count, std::vector<unsigned char>& bytes) {
  bytes.clear();
  while (bytes.size() < count) {
    const Bytes window = file_.window();
    if (window.size() == 0) return false;
    const uint64_t piece = std::min<uint64_t>(window.size(), count - bytes.size());
    bytes.insert(bytes.end(), window.begin, window.begin + piece);
    file_.advance(piece);
  }
  return true;
}

bool BinaryFile::skip(uint64_t count) {
  while (count > 0) {
    const uint64_t piece = std::min<uint64_t>(file_.window().size(), count);
    if (piece == 0) return false;
    file_.advance(piece);
    count -= piece;
  }
  return true;
}

}  // namespace foucault::rawlog
