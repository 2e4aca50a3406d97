#include "ubx_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace foucault::rawlog {

namespace {

constexpr unsigned char kUbxSync[] = {0xb5, 0x62};
constexpr size_t kUbxHeader = 6;  ///< sync, class, id, length
constexpr size_t kUbxChecksum = 2;
/// Longer ones are no messages: the longest, of raw observations, have some 4 kB.
constexpr size_t kUbxLongest = InflatedFile::kWindow - kUbxHeader - kUbxChecksum;

/// Fletcher's, of all between sync and checksum.
bool ubx_checksum_is_right(const unsigned char* message, size_t length) {
  uint8_t a = 0;
  uint8_t b = 0;
  const unsigned char* const end = message + kUbxHeader + length;
  for (const unsigned char* at = message + sizeof kUbxSync; at < end; ++at) {
    a = static_cast<uint8_t>(a + *at);
    b = static_cast<uint8_t>(b + a);
  }
  return end[0] == a && end[1] == b;
}

}  // namespace

std::optional<UbxMessage> UbxFile::next() {
  while (find_sync()) {
    const Bytes window = file_.window();
    const unsigned char* const message = window.begin;
    const size_t length =
        window.size() < kUbxHeader ? 0 : message[4] | static_cast<size_t>(message[5]) << 8U;
    const bool fits = window.size() >= kUbxHeader + length + kUbxChecksum;
    if (length <= kUbxLongest && fits && ubx_checksum_is_right(message, length)) {
      if (cut_off_) note_damage(*cut_off_);
      cut_off_.reset();
      ++messages_;
      file_.begin_record();
      file_.skip(kUbxHeader + length + kUbxChecksum);
      return UbxMessage{
          message[2], message[3], {message + kUbxHeader, message + kUbxHeader + length}};
    }
    if (length <= kUbxLongest && !fits) {
      cut_off_ = file_.offset();
    } else {
      note_damage(file_.offset());
    }
    pass_over(sizeof kUbxSync);
  }
  return std::nullopt;
}

void UbxFile::note_damage(int64_t byte) {
  if (damaged_++ == 0) first_damaged_ = byte;
}

/// Goes to where a message may begin; false at the end of the file.
bool UbxFile::find_sync() {
  while (true) {
    const Bytes window = file_.window();
    const unsigned char* const found =
        std::search(window.begin, window.end, std::begin(kUbxSync), std::end(kUbxSync));
    if (found != window.end) {
      pass_over(static_cast<size_t>(found - window.begin));
      return true;
    }
    // The last byte may be the first of the sync.
    const bool over = window.size() < 2;
    pass_over(over ? window.size() : window.size() - 1);
    if (over) return false;
  }
}

bool UbxFile::pass_over(size_t count) {
  foreign_bytes_ += static_cast<int64_t>(count);
  return file_.skip(count);
}

std::vector<std::string> UbxFile::notices() const {
  std::vector<std::string> found;
  const std::string& path = file_.path();
  if (foreign_bytes_ > 0) {
    found.push_back(fmt::format("{}: passed over {} bytes that are no UBX (NMEA, RTCM, damage)",
                                path, foreign_bytes_));
  }
  if (damaged_ > 0) {
    found.push_back(
        fmt::format("{}: left out {} of {} UBX messages, their checksum is wrong; the first at "
                    "byte {}",
                    path, damaged_, damaged_ + messages_, first_damaged_));
  }
  if (cut_off_) {
    found.push_back(
        fmt::format("{}: the file ends within the message at byte {}, it is cut off; get the "
                    "whole one if you can",
                    path, *cut_off_));
  }
  return found;
}

}  // namespace foucault::rawlog
