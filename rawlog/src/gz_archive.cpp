#include "gz_archive.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "foucault/core/error.h"

namespace foucault::rawlog {

namespace {

/// zlib closes the descriptor that it is given.
gzFile open_copy(int descriptor) {
  const int copy = fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
  if (copy < 0) return nullptr;
  const gzFile file = gzdopen(copy, "wb2");
  if (file == nullptr) ::close(copy);
  return file;
}

}  // namespace

GzWriteArchive::GzWriteArchive(const PendingFile& file)
    : path_(file.path()), file_(open_copy(file.descriptor())) {
  if (!file_) fail();
  gzbuffer(file_.get(), kGzipBuffer);
  buffer_.reserve(kGzipBuffer);
}

void GzWriteArchive::put(const mrpt::serialization::CSerializable& object) {
  WriteObject(object);
  if (buffer_.size() >= kGzipBuffer) flush();
}

void GzWriteArchive::flush() {
  if (buffer_.empty()) return;
  const int size = static_cast<int>(buffer_.size());
  if (gzwrite(file_.get(), buffer_.data(), static_cast<unsigned>(size)) != size) fail();
  buffer_.clear();
}

void GzWriteArchive::close() {
  flush();
  if (gzclose(file_.release()) != Z_OK) fail();
}

void GzWriteArchive::fail() const {
  throw DataError(fmt::format("'{}' cannot be written: {}", path_, std::strerror(errno)));
}

size_t GzWriteArchive::read(void*, size_t) { throw std::logic_error("an archive for writing"); }

size_t GzWriteArchive::write(const void* source, size_t length) {
  const char* bytes = static_cast<const char*>(source);
  buffer_.insert(buffer_.end(), bytes, bytes + length);
  return length;
}

}  // namespace foucault::rawlog
