#include "inflated_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "files.h"
#include "foucault/core/error.h"

namespace foucault::rawlog {

namespace {

constexpr size_t kInputSize = size_t{1} << 16;
constexpr size_t kInflatedSize = 8 * InflatedFile::kWindow;
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
  compressed_ = rest_.size() >= sizeof kGzipMagic &&
                std::equal(std::begin(kGzipMagic), std::end(kGzipMagic), rest_.begin);
  if (!compressed_) return;
  in_member_ = true;
  inflater_ = isal_inflater();
  if (inflater_) return;
  inflater_ = zlib_inflater();
  by_zlib_ = true;
}

double InflatedFile::progress() const {
  if (end_ != End::none || file_size_ == 0) return 1;
  return std::min(1.0, static_cast<double>(file_offset_) / static_cast<double>(file_size_));
}

bool InflatedFile::go_to(uint64_t offset) {
  if (compressed_ || offset > file_size_) return false;
  if (fseeko(file_.get(), static_cast<off_t>(offset), SEEK_SET) != 0) return false;
  rest_ = {};
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
  rest_ = {input_.data(), input_.data() + count};
  if (count == 0) end_ = std::ferror(file_.get()) != 0 ? End::unreadable : at_end;
  return count > 0;
}

void InflatedFile::copy() {
  if (rest_.size() == 0 && !load(End::clean)) return;
  const size_t count = std::min(rest_.size(), buffer_.size() - filled_);
  std::memcpy(buffer_.data() + filled_, rest_.begin, count);
  rest_.begin += count;
  filled_ += count;
  file_offset_ += count;
}

void InflatedFile::inflate() {
  if (rest_.size() == 0 && !holds_back_ && !load(in_member_ ? End::truncated : End::clean)) {
    if (end_ == End::truncated && by_zlib_from_start()) end_ = End::none;
    return;
  }
  if (!in_member_ && !begin_member()) {
    end_ = End::clean;
    return;
  }
  const unsigned char* const before = rest_.begin;
  unsigned char* const begin = buffer_.data() + filled_;
  unsigned char* out = begin;
  const auto room =
      std::min<uint64_t>(known_ > 0 ? known_ : buffer_.size(), buffer_.size() - filled_);
  const GzipInflater::State state = inflater_->inflate(rest_, out, begin + room);
  file_offset_ += static_cast<uint64_t>(rest_.begin - before);
  const auto count = static_cast<size_t>(out - begin);
  if (known_ > 0) {
    known_ -= count;
  } else {
    filled_ += count;
  }
  in_member_ = state != GzipInflater::State::member_ends;
  holds_back_ = in_member_ && out == begin + room;
  if (state == GzipInflater::State::damaged && !by_zlib_from_start()) {
    filled_ -= std::min<uint64_t>(known_, filled_ - position_);  // no such bytes, as zlib sees it
    end_ = End::damaged;
  }
}

/// Another gzip member may follow; anything else behind the last one is padding, as gzip sees it.
bool InflatedFile::begin_member() {
  if (*rest_.begin != kGzipMagic[0]) return false;
  inflater_->reset();
  in_member_ = true;
  return true;
}

/// Where compression breaks, zlib says what can still be had and where the break is. False if it
/// is zlib that found it.
bool InflatedFile::by_zlib_from_start() {
  if (std::exchange(by_zlib_, true) || fseeko(file_.get(), 0, SEEK_SET) != 0) return false;
  inflater_ = zlib_inflater();
  known_ = offset_ + (filled_ - position_);
  rest_ = {};
  file_offset_ = 0;
  holds_back_ = false;
  in_member_ = true;
  return true;
}

}  // namespace foucault::rawlog
