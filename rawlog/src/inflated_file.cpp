#include "inflated_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <new>

#include "files.h"
#include "foucault/core/error.h"

namespace foucault::rawlog {

namespace {

constexpr size_t kInputSize = size_t{1} << 16;
constexpr size_t kInflatedSize = 3 * InflatedFile::kWindow;
constexpr int kGzipOnly = 16 + MAX_WBITS;
constexpr unsigned char kGzipMagic[] = {0x1F, 0x8B};

}  // namespace

InflatedFile::InflatedFile(const std::string& path)
    : path_(path), input_(kInputSize), buffer_(kInflatedSize) {
  check_readable(path);
  file_.reset(std::fopen(path.c_str(), "rb"));
  if (!file_) {
    throw DataError(fmt::format("'{}' cannot be read: {}", path, std::strerror(errno)));
  }
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path, error);
  file_size_ = error ? 0 : size;
  load(End::clean);
  compressed_ = stream_.avail_in >= sizeof kGzipMagic &&
                std::equal(std::begin(kGzipMagic), std::end(kGzipMagic), stream_.next_in);
  if (compressed_ && inflateInit2(&stream_, kGzipOnly) != Z_OK) throw std::bad_alloc();
  in_member_ = compressed_;
}

InflatedFile::~InflatedFile() {
  if (compressed_) inflateEnd(&stream_);
}

double InflatedFile::progress() const {
  if (end_ != End::none || file_size_ == 0) return 1;
  return std::min(1.0, static_cast<double>(file_offset_) / static_cast<double>(file_size_));
}

bool InflatedFile::go_to(uint64_t offset) {
  if (compressed_ || offset > file_size_) return false;
  if (fseeko(file_.get(), static_cast<off_t>(offset), SEEK_SET) != 0) return false;
  stream_.avail_in = 0;
  position_ = 0;
  filled_ = 0;
  offset_ = offset;
  file_offset_ = offset;
  end_ = End::none;
  return true;
}

void InflatedFile::fill() {
  std::memmove(buffer_.data(), buffer_.data() + position_, filled_ - position_);
  filled_ -= position_;
  position_ = 0;
  while (filled_ < buffer_.size() && end_ == End::none) {
    if (compressed_) {
      inflate();
    } else {
      copy();
    }
  }
}

/// The next piece of the file; without one the contents end, with `at_end` if the file does.
bool InflatedFile::load(End at_end) {
  const size_t count = std::fread(input_.data(), 1, input_.size(), file_.get());
  stream_.next_in = input_.data();
  stream_.avail_in = static_cast<uInt>(count);
  if (count == 0) end_ = std::ferror(file_.get()) != 0 ? End::unreadable : at_end;
  return count > 0;
}

void InflatedFile::copy() {
  if (stream_.avail_in == 0 && !load(End::clean)) return;
  const size_t count = std::min<size_t>(stream_.avail_in, buffer_.size() - filled_);
  std::memcpy(buffer_.data() + filled_, stream_.next_in, count);
  stream_.next_in += count;
  stream_.avail_in -= static_cast<uInt>(count);
  filled_ += count;
  file_offset_ += count;
}

void InflatedFile::inflate() {
  if (stream_.avail_in == 0 && !load(in_member_ ? End::truncated : End::clean)) return;
  if (!in_member_ && !begin_member()) {
    end_ = End::clean;
    return;
  }
  const uInt before = stream_.avail_in;
  stream_.next_out = buffer_.data() + filled_;
  stream_.avail_out = static_cast<uInt>(buffer_.size() - filled_);
  const int result = ::inflate(&stream_, Z_NO_FLUSH);
  filled_ = buffer_.size() - stream_.avail_out;
  file_offset_ += before - stream_.avail_in;
  if (result == Z_MEM_ERROR) throw std::bad_alloc();
  if (result == Z_STREAM_END) {
    in_member_ = false;
  } else if (result != Z_OK && result != Z_BUF_ERROR) {
    end_ = End::damaged;
  }
}

/// Another gzip member may follow; anything else behind the last one is padding, as gzip sees it.
bool InflatedFile::begin_member() {
  if (*stream_.next_in != kGzipMagic[0]) return false;
  inflateReset(&stream_);
  in_member_ = true;
  return true;
}

}  // namespace foucault::rawlog
