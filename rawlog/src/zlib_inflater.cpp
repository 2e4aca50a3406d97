#include <zlib.h>

#include <new>

#include "gzip_inflater.h"

namespace foucault::rawlog {
namespace {

class ZlibInflater final : public GzipInflater {
 public:
  ZlibInflater() {
    constexpr int kGzipOnly = 16 + MAX_WBITS;
    if (inflateInit2(&stream_, kGzipOnly) != Z_OK) throw std::bad_alloc();
  }
  ~ZlibInflater() override { inflateEnd(&stream_); }
  ZlibInflater(const ZlibInflater&) = delete;
  ZlibInflater& operator=(const ZlibInflater&) = delete;

  void reset() override { inflateReset(&stream_); }

  State inflate(Bytes& input, unsigned char*& out, const unsigned char* end) override {
    stream_.next_in = const_cast<unsigned char*>(input.begin);  // zlib does not write there
    stream_.avail_in = static_cast<uInt>(input.size());
    stream_.next_out = out;
    stream_.avail_out = static_cast<uInt>(end - out);
    const int result = ::inflate(&stream_, Z_NO_FLUSH);
    input.begin = stream_.next_in;
    out = stream_.next_out;
    if (result == Z_MEM_ERROR) throw std::bad_alloc();
    if (result == Z_STREAM_END) return State::member_ends;
    return result == Z_OK || result == Z_BUF_ERROR ? State::within : State::damaged;
  }

 private:
  z_stream stream_{};
};

}  // namespace

std::unique_ptr<GzipInflater> zlib_inflater() { return std::make_unique<ZlibInflater>(); }

}  // namespace foucault::rawlog
