#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

#include "inflated_file.h"

namespace foucault::rawlog {

/// The bytes of a record end before the record does.
class RecordTooShort : public std::runtime_error {
 public:
  RecordTooShort() : std::runtime_error("the record is longer than what is there") {}
};

/// A record that says what cannot be: a length, a count, a missing end. The message tells which.
class BadRecord : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A record in a version that this program does not know.
class UnknownVersion : public std::runtime_error {
 public:
  enum class Age { older, newer };
  explicit UnknownVersion(Age age) : std::runtime_error("an unknown version"), age_(age) {}
  Age age() const { return age_; }

 private:
  Age age_;
};

/// Walks over the fields of a record as MRPT serializes them (little endian, unaligned); never past
/// the end of the bytes. Throws RecordTooShort and BadRecord.
class RecordCursor {
 public:
  explicit RecordCursor(Bytes bytes) : begin_(bytes.begin), at_(bytes.begin), end_(bytes.end) {}

  template <class T>
  T get() {
    T value;
    std::memcpy(&value, take(sizeof(T)), sizeof(T));
    return value;
  }

  template <class... T>
  void get(T&... fields) {
    ((fields = get<T>()), ...);
  }

  bool flag() { return get<uint8_t>() != 0; }

  const unsigned char* take(size_t count) {
    if (count > static_cast<size_t>(end_ - at_)) throw RecordTooShort();
    const unsigned char* const start = at_;
    at_ += count;
    return start;
  }

  void skip(size_t count) { take(count); }

  /// A length before that many elements.
  size_t count(size_t most) {
    const uint32_t n = get<uint32_t>();
    if (n > most) throw BadRecord("a length of " + std::to_string(n));
    return n;
  }

  std::string_view text(size_t longest) {
    const size_t length = count(longest);
    return {reinterpret_cast<const char*>(take(length)), length};
  }

  size_t position() const { return static_cast<size_t>(at_ - begin_); }
  /// What was walked over since `position`.
  Bytes since(size_t position) const { return {begin_ + position, at_}; }

 private:
  const unsigned char* begin_;
  const unsigned char* at_;
  const unsigned char* end_;
};

}  // namespace foucault::rawlog
