#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "gzip_inflater.h"

namespace foucault::rawlog {

/// The contents of a gzip or plain file, through a window that slides over them. Memory is
/// constant. What was inflated before a damage is still given out; end() tells what came then.
class InflatedFile {
 public:
  enum class End { none, clean, truncated, damaged, unreadable };
  /// The window shows at least so many bytes unless the contents end within.
  static constexpr size_t kWindow = size_t{1} << 15;

  /// Throws DataError if the file is missing, a directory, empty or cannot be read.
  explicit InflatedFile(const std::string& path);

  /// Bytes from offset() on; valid until the next call.
  Bytes window() {
    if (filled_ - position_ < kWindow && end_ == End::none) fill();
    return {buffer_.data() + position_, buffer_.data() + filled_};
  }
  /// `count` bytes of the window are done with.
  void advance(size_t count) {
    position_ += count;
    offset_ += count;
  }

  /// Goes to a byte of a plain file, from which on the window shows. False if it cannot.
  bool go_to(uint64_t offset);

  /// How the contents end; none while there are more than the window shows.
  End end() const { return end_; }
  /// Of the window, in the contents.
  uint64_t offset() const { return offset_; }
  /// Bytes of the file that have been used; at a damage, its place.
  uint64_t file_offset() const { return file_offset_; }
  uint64_t file_size() const { return file_size_; }
  bool compressed() const { return compressed_; }
  /// Part of the file that is read, 0 to 1.
  double progress() const;

 private:
  struct FileClose {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void fill();
  bool load(End at_end);
  void copy();
  void inflate();
  bool begin_member();
  bool by_zlib_from_start();

  std::string path_;
  std::unique_ptr<std::FILE, FileClose> file_;
  uint64_t file_size_ = 0;
  uint64_t file_offset_ = 0;
  bool compressed_ = false;
  bool in_member_ = false;
  std::unique_ptr<GzipInflater> inflater_;
  bool by_zlib_ = false;
  bool holds_back_ = false;  ///< the inflater may have more than there was room for
  uint64_t known_ = 0;       ///< bytes to be inflated that were given out before
  std::vector<unsigned char> input_;
  Bytes rest_;  ///< of the input
  std::vector<unsigned char> buffer_;
  size_t position_ = 0;
  size_t filled_ = 0;
  uint64_t offset_ = 0;
  End end_ = End::none;
};

}  // namespace foucault::rawlog
