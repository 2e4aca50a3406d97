#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// Names of what was computed: a hash of all that it depends on.
namespace foucault::store {

/// A SHA-256.
using Key = std::array<uint8_t, 32>;

/// SHA-256 of bytes that come in pieces (FIPS 180-4).
class Sha256 {
 public:
  void add(std::string_view bytes);
  /// Of all that was added; nothing may be added afterwards.
  Key finish();

 private:
  void block(const uint8_t* bytes);

  std::array<uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<uint8_t, 64> open_{};  ///< not a whole block yet
  std::size_t open_size_ = 0;
  uint64_t size_ = 0;  ///< [bytes]
};

Key key_of(std::string_view text);

/// 64 hexadecimal digits.
std::string hex(const Key& key);

}  // namespace foucault::store
