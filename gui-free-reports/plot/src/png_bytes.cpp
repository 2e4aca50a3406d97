#include "png_bytes.h"

#include <png.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <unordered_map>

namespace foucault::plot {
namespace {

using Bytes = std::vector<unsigned char>;

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

/// Of each pixel, the place in the palette.
Bytes places_of(const cv::Mat& image, const Palette& palette) {
  Bytes places;
  places.reserve(image.total());
  uint32_t last = kNoColour;
  uchar place = 0;
  for (int y = 0; y < image.rows; ++y) {
    const uchar* pixel = image.ptr(y);
    for (int x = 0; x < image.cols; ++x, pixel += 3) {
      const uint32_t colour = colour_at(pixel);
      if (colour != last) place = palette.places.at(last = colour);
      places.push_back(place);
    }
  }
  return places;
}

/// As `pixels` are in memory, rows of `stride` bytes; `entries`: of its palette, if it has one.
Bytes written(png_image& png, const void* pixels, size_t stride, const uchar* entries) {
  png.version = PNG_IMAGE_VERSION;
  png.flags = PNG_IMAGE_FLAG_FAST;  // no filters and little search: figures are flat
  Bytes file(PNG_IMAGE_PNG_SIZE_MAX(png));
  png_alloc_size_t size = file.size();
  if (png_image_write_to_memory(&png, file.data(), &size, 0, pixels, int(stride), entries) == 0) {
    throw std::runtime_error(std::string("an image cannot be written: ") + png.message);
  }
  file.resize(size);
  return file;
}

}  // namespace

Bytes to_png(const cv::Mat& image) {
  const std::vector<Count> colours = colours_of(image);
  const Palette palette = colours.size() <= kMostColours ? palette_of(colours) : Palette{};
  png_image png{};
  png.width = png_uint_32(image.cols);
  png.height = png_uint_32(image.rows);
  png.format = PNG_FORMAT_BGR;
  if (palette.entries.empty() || palette.off > kUnseen) {
    return written(png, image.data, image.step, nullptr);
  }
  png.format = PNG_FORMAT_BGR_COLORMAP;
  png.colormap_entries = png_uint_32(palette.entries.size());
  Bytes entries;
  for (const uint32_t colour : palette.entries) {
    entries.insert(entries.end(), {uchar(colour), uchar(colour >> 8), uchar(colour >> 16)});
  }
  return written(png, places_of(image, palette).data(), size_t(image.cols), entries.data());
}

}  // namespace foucault::plot
