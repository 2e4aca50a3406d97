#include "gz_archive.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "foucault/core/error.h"

namespace foucault::rawlog {

namespace {

constexpr unsigned kBufferSize = 1U << 17;

}  // namespace

GzWriteArchive::GzWriteArchive(const PendingFile& file)
    : path_(file.path()), file_(gzopen(file.temporary().c_str(), "wb2")) {
  if (!file_) {
    throw DataError(fmt::format("'{}' cannot be written: {}", path_, std::strerror(errno)));
  }
  gzbuffer(file_.get(), kBufferSize);
  buffer_.reserve(kBufferSize);
}

void GzWriteArchive::flush() {
  if (buffer_.empty()) return;
  const int size = static_cast<int>(buffer_.size());
  if (gzwrite(file_.get(), buffer_.data(), static_cast<unsigned>(size)) != size) {
    throw DataError(fmt::format("'{}' cannot be written: {}", path_, std::strerror(errno)));
  }
  buffer_.clear();
}

void GzWriteArchive::close() {
  flush();
  if (gzclose(file_.release()) != Z_OK) {
    throw DataError(fmt::format("'{}' cannot be written: {}", path_, std::strerror(errno)));
  }
}

size_t GzWriteArchive::read(void*, size_t) { throw std::logic_error("an archive for writing"); }

size_t GzWriteArchive::write(const void* source, size_t length) {
  const char* bytes = static_cast<const char*>(source);
  buffer_.insert(buffer_.end(), bytes, bytes + length);
  if (buffer_.size() >= kBufferSize) flush();
  return length;
}

}  // namespace foucault::rawlog
