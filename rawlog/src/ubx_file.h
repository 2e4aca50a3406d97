#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "binary_file.h"

/// UBX of u-blox receivers as their interface descriptions have it (UBX-18010854 of the ZED-F9P,
/// UBX-13003221 of the M8): frames only, no meanings.
namespace foucault::rawlog {

/// A message, until the next one is read.
struct UbxMessage {
  uint8_t message_class = 0;
  uint8_t id = 0;
  Bytes payload;

  constexpr uint16_t key() const { return static_cast<uint16_t>(message_class << 8U | id); }
};

/// The messages of a file one after the other. What stands between them (NMEA, RTCM, a logger's
/// own) is passed over, and so is a message whose checksum is wrong; both are counted.
class UbxFile {
 public:
  /// Throws DataError if the file cannot be opened.
  explicit UbxFile(const std::string& path) : file_(path) {}

  /// None at the end.
  std::optional<UbxMessage> next();

  const InputFile& file() const { return file_; }
  /// Of the message that came last.
  const Place& place() const { return file_; }
  int64_t messages() const { return messages_; }
  int64_t foreign_bytes() const { return foreign_bytes_; }
  /// What was left out, a line each.
  std::vector<std::string> notices() const;

 private:
  bool find_sync();
  bool pass_over(size_t count);
  void note_damage(int64_t byte);

  BinaryFile file_;
  int64_t messages_ = 0;
  int64_t foreign_bytes_ = 0;
  int64_t damaged_ = 0;
  int64_t first_damaged_ = 0;       ///< byte
  std::optional<int64_t> cut_off_;  ///< byte at which the last message begins
};

}  // namespace foucault::rawlog
