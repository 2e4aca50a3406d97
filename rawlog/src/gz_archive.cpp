#include "gz_archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "foucault/core/error.h"

namespace foucault::rawlog {

namespace {

constexpr unsigned kBufferSize = 1U << 17;

}  // namespace

GzReadArchive::GzReadArchive(const std::string& path)
    : path_(path), file_(open_for_reading(path)), buffer_(kBufferSize) {
  gzbuffer(file_.get(), kBufferSize);
  compressed_ = gzdirect(file_.get()) == 0;
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path, error);
  file_size_ = error ? 0 : size;
}

void GzReadArchive::begin_object() {
  object_offset_ = offset_;
  head_size_ = 0;
}

std::string GzReadArchive::object_class() const {
  if (head_size_ < 2) return {};
  const size_t length =
      std::min<size_t>(static_cast<unsigned char>(head_[0]) & 0x7FU, head_size_ - 1);
  const std::string name(head_.data() + 1, length);
  const bool plausible = std::all_of(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':' || c == '<' ||
           c == '>' || c == ',';
  });
  const bool flagged = (static_cast<unsigned char>(head_[0]) & 0x80U) != 0;
  return flagged && plausible ? name : std::string{};
}

double GzReadArchive::progress() const {
  if (end_ != End::none || file_size_ == 0) return 1;
  return std::min(1.0,
                  static_cast<double>(gzoffset(file_.get())) / static_cast<double>(file_size_));
}

bool GzReadArchive::fill() {
  const int got = gzread(file_.get(), buffer_.data(), kBufferSize);
  position_ = 0;
  available_ = got > 0 ? static_cast<size_t>(got) : 0;
  if (available_ > 0) return true;
  int error = Z_OK;
  gzerror(file_.get(), &error);
  if (error == Z_BUF_ERROR) {
    end_ = End::truncated;
  } else if (error != Z_OK && error != Z_STREAM_END) {
    end_ = End::damaged;
  } else {
    end_ = offset_ == object_offset_ ? End::clean : End::truncated;
  }
  return false;
}

size_t GzReadArchive::read(void* target, size_t length) {
  char* out = static_cast<char*>(target);
  size_t missing = length;
  while (missing > 0) {
    if (position_ == available_ && !fill()) {
      if (end_ == End::clean) return 0;
      throw std::runtime_error("the file ends within an object");
    }
    const size_t count = std::min(missing, available_ - position_);
    std::memcpy(out, buffer_.data() + position_, count);
    position_ += count;
    offset_ += count;
    out += count;
    missing -= count;
  }
  const size_t noted = std::min(length, head_.size() - head_size_);
  std::memcpy(head_.data() + head_size_, target, noted);
  head_size_ += noted;
  return length;
}

size_t GzReadArchive::write(const void*, size_t) {
  throw std::logic_error("an archive for reading");
}

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
