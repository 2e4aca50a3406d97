#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "foucault/rawlog/import_novatel.h"
#include "fuzzing.h"
#include "reading.h"

namespace {

constexpr size_t kCrc = 4;

uint32_t crc_of(const uint8_t* begin, size_t count) {
  return static_cast<uint32_t>(crc32(0xffffffffUL, begin, static_cast<uInt>(count))) ^ 0xffffffffU;
}

/// The length of the log that begins there without its CRC, if it lies within the bytes.
size_t binary_length(const std::string& bytes, size_t at) {
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(bytes[at + i]); };
  if (at + 12 > bytes.size() || byte(0) != 0xaa || byte(1) != 0x44) return 0;
  if (byte(2) != 0x12 && byte(2) != 0x13) return 0;
  const size_t length =
      byte(2) == 0x12 ? size_t{byte(3)} + byte(8) + 256U * byte(9) : size_t{12} + byte(3);
  return at + length + kCrc <= bytes.size() ? length : 0;
}

/// Chance makes no CRCs: they are set right, so that what lies behind them is reached.
std::string mended(std::string bytes) {
  for (size_t at = 0; at < bytes.size(); ++at) {
    const auto* const begin = reinterpret_cast<const uint8_t*>(bytes.data()) + at;
    const size_t length = binary_length(bytes, at);
    if (length > 0) {
      const uint32_t crc = crc_of(begin, length);
      std::memcpy(&bytes[at + length], &crc, kCrc);
      at += length + kCrc - 1;
    } else if (bytes[at] == '#' || bytes[at] == '%') {
      const size_t star = bytes.find('*', at);
      if (star == std::string::npos || star + 9 > bytes.size()) continue;
      char digits[9];
      std::snprintf(digits, sizeof digits, "%08x", crc_of(begin + 1, star - at - 1));
      bytes.replace(star + 1, 8, digits, 8);
      at = star + 8;
    }
  }
  return bytes;
}

}  // namespace

/// The bytes are a recording of a NovAtel receiver.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault;
  using namespace foucault::fuzz;
  rawlog::NovatelImport import;
  import.log = folder().write("drive.gps", mended(std::string(text_of(data, size))));
  import.out = folder() / "out.rawlog";
  import.lever_arm = Eigen::Vector3d::Zero();
  for (const bool skip_bad_rows : {false, true}) {
    import.skip_bad_rows = skip_bad_rows;
    if (contained([&] { rawlog::import_novatel(import); })) read_own_rawlog(import.out);
    import.lever_arm.reset();
  }
  return 0;
}
