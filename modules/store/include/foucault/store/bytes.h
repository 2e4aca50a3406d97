#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "foucault/core/error.h"

/// Values as bytes and back without loss.
namespace foucault::store {

/// Bytes end before a value, or hold more than the values.
class BytesError : public DataError {
 public:
  using DataError::DataError;
};

/// Little-endian, whatever the machine.
class ByteWriter {
 public:
  void put(uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) bytes_ += static_cast<char>(value >> shift);
  }
  void put(int64_t value) { put(static_cast<uint64_t>(value)); }
  void put(double value) {
    uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    put(bits);
  }
  void put(std::string_view text) {
    put(static_cast<uint64_t>(text.size()));
    bytes_ += text;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  uint64_t count() {
    const std::string_view bytes = take(8);
    uint64_t value = 0;
    for (int i = 7; i >= 0; --i) {
      value = value << 8 | static_cast<unsigned char>(bytes[static_cast<std::size_t>(i)]);
    }
    return value;
  }
  int64_t integer() { return static_cast<int64_t>(count()); }
  double number() {
    const uint64_t bits = count();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  std::string text() { return std::string(take(count())); }

  /// Throws BytesError if something is left.
  void finish() const {
    if (!rest_.empty()) throw BytesError("bytes are left behind the last value");
  }

 private:
  std::string_view take(uint64_t size) {
    if (size > rest_.size()) throw BytesError("bytes end before a value");
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }

  std::string_view rest_;
};

}  // namespace foucault::store
