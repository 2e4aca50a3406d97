#include "inflate_block.h"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <memory>

#include "foucault/core/error.h"

namespace foucault::rawlog {

namespace {

constexpr size_t kPiece = 1U << 20;

/// Room for another piece of at most `size` bytes in all.
void grow(std::vector<unsigned char>& bytes, size_t filled, size_t size) {
  if (filled == bytes.size()) bytes.resize(std::min(size, bytes.size() + kPiece));
}

bool inflate_none(Bytes in, size_t size, std::vector<unsigned char>& out) {
  out.assign(in.begin, in.end);
  return in.size() == size;
}

bool inflate_bz2(Bytes in, size_t size, std::vector<unsigned char>& out) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return false;
  std::vector<unsigned char> input(in.begin, in.end);
  stream.next_in = reinterpret_cast<char*>(input.data());
  stream.avail_in = static_cast<unsigned>(input.size());
  size_t filled = 0;
  int result = BZ_OK;
  while (result == BZ_OK && filled < size) {
    grow(out, filled, size);
    const auto room = static_cast<unsigned>(out.size() - filled);
    stream.next_out = reinterpret_cast<char*>(out.data() + filled);
    stream.avail_out = room;
    result = BZ2_bzDecompress(&stream);
    if (stream.avail_out == room && stream.avail_in == 0) break;
    filled += room - stream.avail_out;
  }
  BZ2_bzDecompressEnd(&stream);
  return filled == size;
}

bool inflate_lz4(Bytes in, size_t size, std::vector<unsigned char>& out) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) return false;
  size_t filled = 0;
  size_t used = 0;
  while (filled < size && used < in.size()) {
    grow(out, filled, size);
    size_t room = out.size() - filled;
    size_t left = in.size() - used;
    const size_t result =
        LZ4F_decompress(context, out.data() + filled, &room, in.begin + used, &left, nullptr);
    if (LZ4F_isError(result) != 0 || (room == 0 && left == 0)) break;
    filled += room;
    used += left;
  }
  LZ4F_freeDecompressionContext(context);
  return filled == size;
}

struct ZstdFree {
  void operator()(ZSTD_DStream* stream) const { ZSTD_freeDStream(stream); }
};
using ZstdStream = std::unique_ptr<ZSTD_DStream, ZstdFree>;

bool inflate_zstd(Bytes in, size_t size, std::vector<unsigned char>& out) {
  const ZstdStream stream(ZSTD_createDStream());
  if (!stream) return false;
  ZSTD_inBuffer input{in.begin, in.size(), 0};
  size_t filled = 0;
  while (filled < size) {
    grow(out, filled, size);
    ZSTD_outBuffer output{out.data() + filled, out.size() - filled, 0};
    const size_t used = input.pos;
    const size_t result = ZSTD_decompressStream(stream.get(), &output, &input);
    filled += output.pos;
    if (ZSTD_isError(result) != 0 || (output.pos == 0 && input.pos == used)) break;
  }
  return filled == size;
}

using Inflate = bool (*)(Bytes, size_t, std::vector<unsigned char>&);

Inflate inflater(const std::string& compression) {
  static const std::map<std::string, Inflate> kInflaters{
      {"none", inflate_none}, {"bz2", inflate_bz2}, {"lz4", inflate_lz4}, {"zstd", inflate_zstd}};
  const auto found = kInflaters.find(compression);
  return found == kInflaters.end() ? nullptr : found->second;
}

}  // namespace

bool is_compression(const std::string& name) { return inflater(name) != nullptr; }

bool inflate_block(const std::string& compression, Bytes in, size_t size,
                   std::vector<unsigned char>& out) {
  const Inflate inflate = inflater(compression);
  out.clear();
  return inflate != nullptr && size <= kLargestBlock && inflate(in, size, out);
}

bool is_zstd(Bytes bytes) {
  constexpr unsigned char kMagic[] = {0x28, 0xB5, 0x2F, 0xFD};
  return bytes.size() >= sizeof kMagic &&
         std::equal(std::begin(kMagic), std::end(kMagic), bytes.begin);
}

std::optional<size_t> zstd_size(Bytes bytes) {
  const unsigned long long size = ZSTD_getFrameContentSize(bytes.begin, bytes.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) return std::nullopt;
  return static_cast<size_t>(size);
}

void inflate_zstd_file(const std::string& from, const std::string& to) {
  std::ifstream source(from, std::ios::binary);
  std::ofstream sink(to, std::ios::binary | std::ios::trunc);
  const ZstdStream stream(ZSTD_createDStream());
  std::vector<char> in(ZSTD_DStreamInSize());
  std::vector<char> out(ZSTD_DStreamOutSize());
  size_t frame = 0;  // between frames
  while (source && sink) {
    source.read(in.data(), static_cast<std::streamsize>(in.size()));
    ZSTD_inBuffer input{in.data(), static_cast<size_t>(source.gcount()), 0};
    bool full = false;  // more may come without more input
    while (input.pos < input.size || (full && frame != 0)) {
      ZSTD_outBuffer output{out.data(), out.size(), 0};
      frame = ZSTD_decompressStream(stream.get(), &output, &input);
      if (ZSTD_isError(frame) != 0) {
        throw DataError(fmt::format("{}: it cannot be inflated by zstd ({}); get a whole copy",
                                    from, ZSTD_getErrorName(frame)));
      }
      sink.write(out.data(), static_cast<std::streamsize>(output.pos));
      full = output.pos == output.size;
    }
  }
  if (!sink.flush()) {
    throw DataError(
        fmt::format("{}: no room for it inflated, in {}; inflate it by zstd -d", from, to));
  }
  if (frame != 0) {
    throw DataError(fmt::format(
        "{}: it ends within what zstd compressed, it is cut off; get the whole one", from));
  }
}

}  // namespace foucault::rawlog
