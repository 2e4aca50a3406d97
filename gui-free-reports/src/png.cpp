#include "png.h"

#include <zlib.h>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <utility>

namespace foucault::reports {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr int kLevel = 5;  // of compression; 6 takes a third more time for a tenth less

void append_number(Bytes& bytes, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back((value >> shift) & 0xff);
}

/// Length, name, content, checksum of name and content.
void append_chunk(Bytes& png, const std::array<unsigned char, 4>& name, const Bytes& content) {
  append_number(png, static_cast<uint32_t>(content.size()));
  const size_t begin = png.size();
  png.insert(png.end(), name.begin(), name.end());
  png.insert(png.end(), content.begin(), content.end());
  const uLong sum = crc32(0, png.data() + begin, static_cast<uInt>(png.size() - begin));
  append_number(png, static_cast<uint32_t>(sum));
}

Bytes header(const cv::Mat& image) {
  Bytes content;
  append_number(content, static_cast<uint32_t>(image.cols));
  append_number(content, static_cast<uint32_t>(image.rows));
  // 8 bits a channel, red green blue; deflate, filter a row, not interlaced
  content.insert(content.end(), {8, 2, 0, 0, 0});
  return content;
}

/// A zlib stream that grows.
class Deflater {
 public:
  explicit Deflater(size_t expected) : out_(expected) {
    if (deflateInit(&stream_, kLevel) != Z_OK) throw std::runtime_error("zlib: cannot deflate");
    stream_.next_out = out_.data();
    stream_.avail_out = static_cast<uInt>(out_.size());
  }
  ~Deflater() { deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  void add(Bytes& bytes) {
    stream_.next_in = bytes.data();
    stream_.avail_in = static_cast<uInt>(bytes.size());
    while (stream_.avail_in > 0) run(Z_NO_FLUSH);
  }

  Bytes finish() {
    while (run(Z_FINISH) != Z_STREAM_END) {
    }
    out_.resize(stream_.total_out);
    return std::move(out_);
  }

 private:
  int run(int flush) {
    if (stream_.avail_out == 0) grow();
    const int status = deflate(&stream_, flush);
    if (status == Z_STREAM_ERROR) throw std::runtime_error("zlib: deflate failed");
    return status;
  }

  void grow() {
    const size_t used = out_.size();
    out_.resize(2 * used);
    stream_.next_out = out_.data() + used;
    stream_.avail_out = static_cast<uInt>(out_.size() - used);
  }

  z_stream stream_{};
  Bytes out_;
};

Bytes compressed_rows(const cv::Mat& image) {
  constexpr size_t kExpected = 256 << 10;
  Deflater deflater(kExpected);
  Bytes row(1 + 3 * static_cast<size_t>(image.cols));  // first the filter, 0: none
  for (int y = 0; y < image.rows; ++y) {
    const cv::Vec3b* pixel = image.ptr<cv::Vec3b>(y);
    for (size_t x = 0; x < static_cast<size_t>(image.cols); ++x) {
      for (size_t c = 0; c < 3; ++c) row[1 + 3 * x + c] = pixel[x][2 - static_cast<int>(c)];
    }
    deflater.add(row);
  }
  return deflater.finish();
}

}  // namespace

std::vector<unsigned char> to_png(const cv::Mat& image) {
  Bytes png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  append_chunk(png, {'I', 'H', 'D', 'R'}, header(image));
  append_chunk(png, {'I', 'D', 'A', 'T'}, compressed_rows(image));
  append_chunk(png, {'I', 'E', 'N', 'D'}, {});
  return png;
}

}  // namespace foucault::reports
