#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "scratch.h"

namespace foucault::test {

/// With its length before.
inline std::string part(const std::string& bytes) {
  return packed(static_cast<uint32_t>(bytes.size())) + bytes;
}

/// Puts a message together as plain CDR does: each number at a multiple of its size.
class Cdr {
 public:
  explicit Cdr(bool big_endian = false) : big_endian_(big_endian) {}

  template <class... T>
  Cdr& put(const T&... values) {
    (put_one(values), ...);
    return *this;
  }
  Cdr& put(const char* text) { return put(std::string(text)); }
  Cdr& put(const std::string& text) {
    put_one(static_cast<uint32_t>(text.size() + 1));
    bytes_ += text + '\0';
    return *this;
  }
  template <class T, size_t N>
  Cdr& put(const std::array<T, N>& values) {
    for (const T& value : values) put_one(value);
    return *this;
  }

  std::string bytes() const {
    return std::string({'\0', big_endian_ ? '\0' : '\1', '\0', '\0'}) + bytes_;
  }

 private:
  template <class T>
  void put_one(const T& value) {
    bytes_.resize((bytes_.size() + sizeof value - 1) / sizeof value * sizeof value);
    std::string bytes = packed(value);
    if (big_endian_) std::reverse(bytes.begin(), bytes.end());
    bytes_ += bytes;
  }

  bool big_endian_;
  std::string bytes_;
};

}  // namespace foucault::test
