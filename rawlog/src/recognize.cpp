#include "foucault/rawlog/recognize.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string_view>

#include "foucault/core/error.h"
#include "guess_table.h"
#include "inflated_file.h"

namespace foucault::rawlog {

namespace {

/// First bytes of a file, inflated.
using Head = std::string_view;

bool starts_with(Head text, Head with) { return text.substr(0, with.size()) == with; }

bool is_kind(char c, bool (*kind)(int)) { return kind(static_cast<unsigned char>(c)); }
bool is_upper_or_digit(char c) {
  return is_kind(c, [](int x) { return std::isupper(x) != 0 || std::isdigit(x) != 0; });
}

/// Whether one of the first lines is as `matches` has it.
template <class Matches>
bool has_line(Head head, Matches matches) {
  constexpr int kLines = 50;
  for (int i = 0; i < kLines && !head.empty(); ++i) {
    Head line = head.substr(0, head.find('\n'));
    head.remove_prefix(std::min(line.size() + 1, head.size()));
    while (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (matches(line)) return true;
  }
  return false;
}

/// An object of MRPT: the length of its class' name with the highest bit set, then that name.
bool is_rawlog(Head head) {
  if (head.size() < 2 || (static_cast<unsigned char>(head[0]) & 0x80U) == 0) return false;
  const Head name = head.substr(1, static_cast<unsigned char>(head[0]) & 0x7FU);
  return starts_with(name, "mrpt::") || starts_with(name, "CObservation") ||
         starts_with(name, "CSensoryFrame") || starts_with(name, "CActionCollection");
}

bool is_ulog(Head head) { return starts_with(head, "ULog\x01\x12\x35"); }
bool is_bag(Head head) { return starts_with(head, "#ROSBAG V"); }
bool is_mcap(Head head) { return starts_with(head, "\x89MCAP0\r\n"); }
bool is_sqlite(Head head) { return starts_with(head, "SQLite format 3"); }

/// A whole frame with its checksum (Fletcher's, of class to payload) somewhere in the first bytes.
bool is_ubx(Head head) {
  constexpr size_t kAround = 8;
  for (size_t at = head.find("\xB5\x62"); at != Head::npos; at = head.find("\xB5\x62", at + 1)) {
    if (head.size() - at < kAround) return false;
    const auto byte = [&](size_t i) { return static_cast<unsigned char>(head[at + i]); };
    const size_t length = byte(4) + 256U * byte(5);
    if (head.size() - at < length + kAround) continue;
    unsigned a = 0;
    unsigned b = 0;
    for (size_t i = 2; i < length + 6; ++i) {
      a = (a + byte(i)) & 0xFFU;
      b = (b + a) & 0xFFU;
    }
    if (a == byte(length + 6) && b == byte(length + 7)) return true;
  }
  return false;
}

/// `#BESTPOSA,...;...` or `%RAWIMUSA,`.
bool is_oem_line(Head line) {
  if (line.empty() || (line[0] != '#' && line[0] != '%')) return false;
  const Head name = line.substr(1, line.find(',') - 1);
  return name.size() > 4 && name.back() == 'A' && line.find(';') != Head::npos &&
         std::all_of(name.begin(), name.end(), is_upper_or_digit);
}

/// OEM7: binary with a header of 28 bytes, or a short one, or text.
bool is_novatel(Head head) {
  const size_t at = head.find("\xAA\x44\x12");
  const bool is_long = at != Head::npos && at + 3 < head.size() && head[at + 3] == 28;
  return is_long || starts_with(head, "\xAA\x44\x13") || has_line(head, is_oem_line);
}

/// DataFlash: FMT, which describes itself first, in binary or text.
bool is_dataflash(Head head) {
  return starts_with(head, "\xA3\x95\x80\x80") || starts_with(head, "FMT, ");
}

bool is_rinex(Head head) {
  return has_line(head.substr(0, 200), [](Head line) {
    return line.find("RINEX VERSION / TYPE") != Head::npos ||
           line.find("CRINEX VERS") != Head::npos;
  });
}

/// `$GPGGA,...*47`, checksum or not.
bool is_nmea(Head head) {
  return has_line(head, [](Head line) {
    const size_t at = line.find('$');
    if (at == Head::npos || line.size() < at + 8 || line[at + 6] != ',') return false;
    const Head name = line.substr(at + 1, 5);
    return std::all_of(name.begin(), name.end(), is_upper_or_digit);
  });
}

/// The comments of RTKLIB, or a row of date, time, position, quality, satellites and more.
bool is_rtklib(Head head) {
  return has_line(head, [](Head line) {
    if (starts_with(line, "% program")) return true;
    if (line.find("GPST") != Head::npos || line.find("UTC") != Head::npos) return line[0] == '%';
    if (line.size() < 60 || line[4] != '/' || line[7] != '/') return false;
    return line[13] == ':' && line.find(',') == Head::npos;
  });
}

struct Signature {
  FileFormat format;
  bool (*matches)(Head head);
};
constexpr Signature kSignatures[] = {
    {{"a rawlog", ""}, is_rawlog},
    {{"a ULog", "ulog"}, is_ulog},
    {{"a bag of ROS 1", "bag"}, is_bag},
    {{"an MCAP recording", "bag"}, is_mcap},
    {{"a rosbag 2", "bag"}, is_sqlite},
    {{"a DataFlash log", "dataflash"}, is_dataflash},
    {{"UBX of a u-blox receiver", "ubx"}, is_ubx},
    {{"a log of a NovAtel receiver", "novatel"}, is_novatel},
    {{"RINEX", "rinex"}, is_rinex},
    {{"a solution of RTKLIB", "rtklib"}, is_rtklib},
    {{"NMEA", "nmea"}, is_nmea},
};

bool is_table(const std::string& path) {
  try {
    read_guess_table(path, 1);
    return true;
  } catch (const DataError&) {
    return false;
  }
}

}  // namespace

std::optional<FileFormat> recognize(const std::string& path) {
  if (std::filesystem::is_directory(path)) {
    if (!std::filesystem::exists(std::filesystem::path(path) / "metadata.yaml"))
      return std::nullopt;
    return FileFormat{"a rosbag 2", "bag"};
  }
  InflatedFile file(path);
  const Bytes window = file.window();
  const Head head(reinterpret_cast<const char*>(window.begin), window.size());
  for (const Signature& signature : kSignatures) {
    if (signature.matches(head)) return signature.format;
  }
  if (is_table(path)) return FileFormat{"a table", "csv"};
  return std::nullopt;
}

}  // namespace foucault::rawlog
