#include "png.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <unordered_map>

namespace foucault::plot {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr int kLevel = 2;              // of zlib: higher ones take longer than they are worth
constexpr size_t kPalette = 256;       // colours
constexpr int kUnseen = 20;            // [levels of 255]: so far may a colour of few pixels be off
constexpr size_t kFrequent = 192;      // entries of the palette for what there is most of
constexpr size_t kMostColours = 3000;  // of an image, to look for a palette
constexpr uint32_t kNoColour = ~0u;

uint32_t colour_at(const uchar* pixel) {
  return uint32_t(pixel[0]) | uint32_t(pixel[1]) << 8 | uint32_t(pixel[2]) << 16;
}

int off_by(uint32_t a, uint32_t b) {
  int most = 0;
  for (const int shift : {0, 8, 16}) {
    most = std::max(most, std::abs(int(a >> shift & 255) - int(b >> shift & 255)));
  }
  return most;
}

struct Count {
  uint32_t colour = 0;
  size_t pixels = 0;
};

/// The most frequent first.
std::vector<Count> colours_of(const cv::Mat& image) {
  std::unordered_map<uint32_t, size_t> counts;
  uint32_t last = kNoColour;
  size_t* of_last = nullptr;
  for (int y = 0; y < image.rows; ++y) {
    const uchar* pixel = image.ptr(y);
    for (int x = 0; x < image.cols; ++x, pixel += 3) {
      const uint32_t colour = colour_at(pixel);
      if (colour != last) of_last = &counts[last = colour];
      ++*of_last;
    }
  }
  std::vector<Count> colours;
  for (const auto& [colour, pixels] : counts) colours.push_back({colour, pixels});
  std::sort(colours.begin(), colours.end(), [](const Count& a, const Count& b) {
    return a.pixels != b.pixels ? a.pixels > b.pixels : a.colour < b.colour;
  });
  return colours;
}

/// A colour and the entry of a palette that stands for it.
struct Served {
  uint32_t colour = 0;
  uchar place = 0;
  int off = 255;

  void consider(size_t entry, uint32_t entry_colour) {
    const int distance = off_by(colour, entry_colour);
    if (distance >= off) return;
    off = distance;
    place = uchar(entry);
  }
};

/// At most 256 colours, and which of them stands for each colour of an image.
struct Palette {
  std::vector<uint32_t> entries;
  std::unordered_map<uint32_t, uchar> places;
  int off = 0;  ///< of the worst served colour
};

/// The most frequent colours, then, one by one, the one that is served worst.
Palette palette_of(const std::vector<Count>& colours) {
  Palette palette;
  std::vector<Served> served(colours.size());
  const auto add = [&](uint32_t colour) {
    for (Served& each : served) each.consider(palette.entries.size(), colour);
    palette.entries.push_back(colour);
  };
  for (size_t i = 0; i < colours.size(); ++i) served[i].colour = colours[i].colour;
  for (size_t i = 0; i < std::min(kFrequent, colours.size()); ++i) add(colours[i].colour);
  const auto worst = [&] {
    return *std::max_element(served.begin(), served.end(),
                             [](const Served& a, const Served& b) { return a.off < b.off; });
  };
  while (palette.entries.size() < kPalette && worst().off > 0) add(worst().colour);
  palette.off = worst().off;
  for (const Served& each : served) palette.places[each.colour] = each.place;
  return palette;
}

/// Rows as PNG has them, each behind the number of its filter: none.
Bytes indexed_rows(const cv::Mat& image, const Palette& palette) {
  Bytes rows;
  rows.reserve(size_t(image.rows) * size_t(image.cols + 1));
  uint32_t last = kNoColour;
  uchar place = 0;
  for (int y = 0; y < image.rows; ++y) {
    rows.push_back(0);
    const uchar* pixel = image.ptr(y);
    for (int x = 0; x < image.cols; ++x, pixel += 3) {
      const uint32_t colour = colour_at(pixel);
      if (colour != last) place = palette.places.at(last = colour);
      rows.push_back(place);
    }
  }
  return rows;
}

Bytes coloured_rows(const cv::Mat& image) {
  Bytes rows;
  rows.reserve(size_t(image.rows) * size_t(3 * image.cols + 1));
  for (int y = 0; y < image.rows; ++y) {
    rows.push_back(0);
    const uchar* pixel = image.ptr(y);
    for (int x = 0; x < image.cols; ++x, pixel += 3) {
      rows.insert(rows.end(), {pixel[2], pixel[1], pixel[0]});
    }
  }
  return rows;
}

Bytes deflated(const Bytes& plain) {
  uLongf size = compressBound(uLong(plain.size()));
  Bytes result(size);
  if (compress2(result.data(), &size, plain.data(), uLong(plain.size()), kLevel) != Z_OK) {
    throw std::runtime_error("an image cannot be compressed");
  }
  result.resize(size);
  return result;
}

void append(uint32_t number, Bytes& file) {
  for (const int shift : {24, 16, 8, 0}) file.push_back(uchar(number >> shift));
}

void append_chunk(std::string_view name, const Bytes& content, Bytes& file) {
  append(uint32_t(content.size()), file);
  const size_t begin = file.size();
  file.insert(file.end(), name.begin(), name.end());
  file.insert(file.end(), content.begin(), content.end());
  append(uint32_t(crc32(0, file.data() + begin, uInt(file.size() - begin))), file);
}

Bytes header(const cv::Mat& image, bool indexed) {
  Bytes content;
  append(uint32_t(image.cols), content);
  append(uint32_t(image.rows), content);
  content.insert(content.end(), {8, uchar(indexed ? 3 : 2), 0, 0, 0});  // bits, kind of colour
  return content;
}

Bytes colour_table(const Palette& palette) {
  Bytes content;
  for (const uint32_t colour : palette.entries) {
    content.insert(content.end(), {uchar(colour >> 16), uchar(colour >> 8), uchar(colour)});
  }
  return content;
}

}  // namespace

Bytes to_png(const cv::Mat& image) {
  constexpr std::array<uchar, 8> kSignature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  Bytes file(kSignature.begin(), kSignature.end());
  const std::vector<Count> colours = colours_of(image);
  const Palette palette = colours.size() <= kMostColours ? palette_of(colours) : Palette{};
  const bool indexed = !palette.entries.empty() && palette.off <= kUnseen;
  append_chunk("IHDR", header(image, indexed), file);
  if (indexed) append_chunk("PLTE", colour_table(palette), file);
  append_chunk("IDAT", deflated(indexed ? indexed_rows(image, palette) : coloured_rows(image)),
               file);
  append_chunk("IEND", {}, file);
  return file;
}

}  // namespace foucault::plot
