#pragma once

#include <cstddef>
#include <memory>

namespace foucault::rawlog {

/// A part of a buffer that someone else owns.
struct Bytes {
  const unsigned char* begin = nullptr;
  const unsigned char* end = nullptr;

  size_t size() const { return static_cast<size_t>(end - begin); }
};

/// Inflates members of a gzip file, piece by piece.
class GzipInflater {
 public:
  enum class State { within, member_ends, damaged };

  virtual ~GzipInflater() = default;
  /// A member begins.
  virtual void reset() = 0;
  /// Inflates what is taken off the front of `input` into [out, end); moves `out` on.
  virtual State inflate(Bytes& input, unsigned char*& out, const unsigned char* end) = 0;
};

/// Gives out every byte before a damage.
std::unique_ptr<GzipInflater> zlib_inflater();

/// By ISA-L, in a quarter of the time; keeps some bytes before a damage or a break to itself. Null
/// where the program is built without it.
std::unique_ptr<GzipInflater> isal_inflater();

}  // namespace foucault::rawlog
