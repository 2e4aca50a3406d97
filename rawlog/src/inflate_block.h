#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "inflated_file.h"

namespace foucault::rawlog {

/// Inflated, a block that claims to be longer is not taken for true [bytes].
inline constexpr size_t kLargestBlock = size_t{1} << 28;

/// Whether inflate_block() knows the compression.
bool is_compression(const std::string& name);

/// Fills `out` with `size` bytes that were compressed by "none", "bz2", "lz4" (frames) or "zstd".
/// False if they are not to be had.
bool inflate_block(const std::string& compression, Bytes in, size_t size,
                   std::vector<unsigned char>& out);

/// Whether the bytes begin as those of zstd do.
bool is_zstd(Bytes bytes);

/// What the bytes of zstd say of the length of what they hold; none if they do not.
std::optional<size_t> zstd_size(Bytes bytes);

/// Inflates a whole file of zstd into another one. Throws DataError.
void inflate_zstd_file(const std::string& from, const std::string& to);

}  // namespace foucault::rawlog
