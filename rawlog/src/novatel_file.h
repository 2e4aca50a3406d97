#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "binary_file.h"
#include "record_cursor.h"

/// Logs of NovAtel's receivers as docs.novatel.com (OEM7 Commands and Logs, "Messages") describes
/// them: ASCII and binary, with headers long and short, among any other bytes. No meanings.
namespace foucault::rawlog {

/// Numbers of logs, in either form.
enum class NovatelId : uint16_t {
  bestpos = 42,
  psrpos = 47,
  bestvel = 99,
  psrvel = 100,
  rtkpos = 141,
  rtkvel = 216,
  rawimu = 268,
  rawimus = 325,
  inspva = 507,
  inspvas = 508,
  corrimudata = 812,
  corrimudatas = 813,
  imuratecorrimus = 1362,
  bestgnsspos = 1429,
  bestgnssvel = 1430,
  rawimux = 1461,
  rawimusx = 1462,
  inspvax = 1465,
  ppppos = 1538,
  pppvel = 1539,
  insconfig = 1945,
  corrimus = 2264
};

/// As NovAtel calls the log, without the letter of its form.
std::string_view name_of(NovatelId id);

/// A log until the next one is read.
struct NovatelMessage {
  NovatelId id{};
  int64_t week = 0;    ///< of the header
  int64_t tow_ns = 0;  ///< of the header
  bool ascii = false;
  Bytes body;  ///< without header and CRC
  const Place* place = nullptr;
};

/// Texts of an enumeration with their numbers.
using NovatelNames = std::vector<std::pair<std::string_view, int>>;

/// Walks over the fields of a log in either form. Throws RowError if it ends before, or if a field
/// is no number or not finite.
class NovatelFields {
 public:
  explicit NovatelFields(const NovatelMessage& message)
      : message_(&message),
        cursor_(message.body),
        text_(reinterpret_cast<const char*>(message.body.begin), message.body.size()) {}

  template <class T>
  T number() {
    T value{};
    if (message_->ascii) {
      value = parsed<T>(10);
    } else {
      value = binary<T>();
    }
    if (!std::isfinite(static_cast<double>(value))) fail("a value that is not finite");
    return value;
  }
  /// Of ASCII in hexadecimal digits.
  template <class T>
  T bits() {
    return message_->ascii ? parsed<T>(16) : binary<T>();
  }
  /// -1 of a text that is not among the names.
  int code(const NovatelNames& names);
  void skip_codes(int count);

 private:
  [[noreturn]] void fail(const char* what) const;
  std::string_view token();

  template <class T>
  T binary() {
    try {
      return cursor_.get<T>();
    } catch (const RecordTooShort&) {
      fail("too few bytes");
    }
  }

  template <class T>
  T parsed([[maybe_unused]] int base) {
    const std::string_view digits = token();
    const char* const end = digits.data() + digits.size();
    T value{};
    std::from_chars_result read{};
    if constexpr (std::is_floating_point_v<T>) {
      read = std::from_chars(digits.data(), end, value);
    } else {
      read = std::from_chars(digits.data(), end, value, base);
    }
    if (read.ec != std::errc{} || read.ptr != end) fail("a field that is no such number");
    return value;
  }

  const NovatelMessage* message_;
  RecordCursor cursor_;
  std::string_view text_;  ///< what is left
};

/// Reads the logs of a file one after the other; what is none, and logs of other numbers, are
/// passed over. A log that is cut off or whose CRC is wrong is left out and counted.
class NovatelFile {
 public:
  /// Throws DataError if the file cannot be opened.
  explicit NovatelFile(const std::string& path) : file_(path) {}

  std::optional<NovatelMessage> next();

  const InputFile& file() const { return file_; }
  int64_t messages() const { return messages_; }  ///< whole ones, of any number
  int64_t damaged() const { return damaged_; }
  int64_t first_damaged() const { return first_damaged_; }  ///< [byte]

 private:
  /// Where the parts of a log are, from its first byte on.
  struct Frame {
    size_t body = 0;
    size_t body_end = 0;
    size_t end = 0;
    bool whole = false;
  };

  bool find_start();
  static std::optional<Frame> binary_frame(Bytes bytes);
  static std::optional<Frame> ascii_frame(Bytes bytes);
  std::optional<NovatelMessage> binary_message() const;
  std::optional<NovatelMessage> ascii_message(const Frame& frame) const;

  BinaryFile file_;
  std::vector<unsigned char> bytes_;  ///< of the log read last
  int64_t messages_ = 0;
  int64_t damaged_ = 0;
  int64_t first_damaged_ = 0;
};

}  // namespace foucault::rawlog
