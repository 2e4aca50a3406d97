#include "novatel_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cctype>

#include "foucault/core/time.h"

namespace foucault::rawlog {

namespace {

constexpr size_t kNovatelSync = 3;
constexpr unsigned char kNovatelLong = 0x12;  ///< third byte of the sync
constexpr unsigned char kNovatelShort = 0x13;
constexpr size_t kNovatelLongHeader = 28;  ///< it may grow, and tells its length
constexpr size_t kNovatelShortHeader = 12;
constexpr size_t kNovatelCrc = 4;
constexpr size_t kNovatelCrcDigits = 8;
constexpr int64_t kNanosecondsPerMillisecond = 1'000'000;

const std::vector<std::pair<std::string_view, NovatelId>> kNovatelIds{
    {"BESTPOS", NovatelId::bestpos},
    {"PSRPOS", NovatelId::psrpos},
    {"BESTVEL", NovatelId::bestvel},
    {"PSRVEL", NovatelId::psrvel},
    {"RTKPOS", NovatelId::rtkpos},
    {"RTKVEL", NovatelId::rtkvel},
    {"RAWIMU", NovatelId::rawimu},
    {"RAWIMUS", NovatelId::rawimus},
    {"INSPVA", NovatelId::inspva},
    {"INSPVAS", NovatelId::inspvas},
    {"CORRIMUDATA", NovatelId::corrimudata},
    {"CORRIMUDATAS", NovatelId::corrimudatas},
    {"IMURATECORRIMUS", NovatelId::imuratecorrimus},
    {"BESTGNSSPOS", NovatelId::bestgnsspos},
    {"BESTGNSSVEL", NovatelId::bestgnssvel},
    {"RAWIMUX", NovatelId::rawimux},
    {"RAWIMUSX", NovatelId::rawimusx},
    {"INSPVAX", NovatelId::inspvax},
    {"PPPPOS", NovatelId::ppppos},
    {"PPPVEL", NovatelId::pppvel},
    {"INSCONFIG", NovatelId::insconfig},
    {"CORRIMUS", NovatelId::corrimus}};

std::optional<NovatelId> novatel_id(int number) {
  for (const auto& [name, id] : kNovatelIds) {
    if (static_cast<int>(id) == number) return id;
  }
  return std::nullopt;
}

/// Of a name with the A of its form at the end.
std::optional<NovatelId> novatel_id(std::string_view name) {
  for (const auto& [known, id] : kNovatelIds) {
    if (name.size() == known.size() + 1 && name.back() == 'A' &&
        name.substr(0, known.size()) == known) {
      return id;
    }
  }
  return std::nullopt;
}

/// That of zlib without its inversions.
uint32_t novatel_crc(const unsigned char* begin, size_t count) {
  constexpr uLong kInverted = 0xffffffffUL;
  return static_cast<uint32_t>(crc32(kInverted, begin, static_cast<uInt>(count)) ^ kInverted);
}

uint32_t little_endian(const unsigned char* at, size_t count) {
  uint32_t value = 0;
  for (size_t i = count; i > 0; --i) value = value << 8U | at[i - 1];
  return value;
}

bool is_capital(unsigned char c) { return c >= 'A' && c <= 'Z'; }

std::string_view novatel_text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.begin), bytes.size()};
}

/// The part before the first comma, which is taken off.
std::string_view first_part(std::string_view& text) {
  const size_t comma = std::min(text.find(','), text.size());
  const std::string_view part = text.substr(0, comma);
  text.remove_prefix(std::min(comma + 1, text.size()));
  return part;
}

/// Decimal digits with up to nine behind the point; none if it is something else.
std::optional<int64_t> header_seconds_ns(std::string_view text) {
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = read.ec == std::errc{} && read.ptr == text.data() + text.size();
  if (!whole || !(std::abs(value) < 2 * kSecondsPerWeek)) return std::nullopt;
  return nanoseconds(value);
}

}  // namespace

std::string_view name_of(NovatelId id) {
  for (const auto& [name, known] : kNovatelIds) {
    if (known == id) return name;
  }
  return "?";
}

// Fields ----------------------------------------------------------------------------------------

void NovatelFields::fail(const char* what) const {
  message_->place->fail(
      fmt::format("log {} has {}; the file is damaged here", name_of(message_->id), what));
}

std::string_view NovatelFields::token() {
  if (text_.empty()) fail("too few fields");
  std::string_view part = first_part(text_);
  while (!part.empty() && part.front() == ' ') part.remove_prefix(1);
  return part;
}

int NovatelFields::code(const NovatelNames& names) {
  if (!message_->ascii) return static_cast<int>(binary<uint32_t>());
  const std::string_view text = token();
  for (const auto& [name, number] : names) {
    if (name == text) return number;
  }
  return -1;
}

void NovatelFields::skip_codes(int count) {
  static const NovatelNames kNone;
  for (int i = 0; i < count; ++i) code(kNone);
}

// Frames ----------------------------------------------------------------------------------------

/// Goes to where a log may begin. False at the end of the file.
bool NovatelFile::find_start() {
  while (true) {
    const Bytes window = file_.window();
    if (window.size() == 0) return false;
    const unsigned char* const start = std::find_if(window.begin, window.end, [](unsigned char c) {
      return c == 0xaa || c == '#' || c == '%';
    });
    const auto before = static_cast<uint64_t>(start - window.begin);
    file_.skip(before);
    if (before < window.size()) return true;
  }
}

/// None where no log begins.
std::optional<NovatelFile::Frame> NovatelFile::binary_frame(Bytes bytes) {
  if (bytes.size() < kNovatelShortHeader || bytes.begin[1] != 0x44) return std::nullopt;
  const unsigned char third = bytes.begin[2];
  if (third != kNovatelLong && third != kNovatelShort) return std::nullopt;
  const bool is_long = third == kNovatelLong;
  Frame frame;
  frame.body = is_long ? bytes.begin[kNovatelSync] : kNovatelShortHeader;
  if (is_long && frame.body < kNovatelLongHeader) return std::nullopt;
  const size_t length = is_long ? little_endian(bytes.begin + 8, 2) : bytes.begin[kNovatelSync];
  frame.body_end = frame.body + length;
  frame.end = frame.body_end + kNovatelCrc;
  frame.whole =
      frame.end <= bytes.size() && novatel_crc(bytes.begin, frame.body_end) ==
                                       little_endian(bytes.begin + frame.body_end, kNovatelCrc);
  return frame;
}

/// None where no log begins; one of another number counts where it is whole.
std::optional<NovatelFile::Frame> NovatelFile::ascii_frame(Bytes bytes) {
  constexpr size_t kLongestLine = 4096;  // of the logs that are read
  const std::string_view window = novatel_text(bytes).substr(0, kLongestLine);
  const std::string_view line =
      window.substr(0, std::min(window.find_first_of("\r\n"), window.size()));
  const size_t comma = line.find(',');
  const size_t semicolon = line.find(';');
  if (comma == std::string_view::npos || line.size() < 2 || !is_capital(bytes.begin[1])) {
    return std::nullopt;
  }
  const bool known = novatel_id(line.substr(1, comma - 1)).has_value();
  const size_t star = line.rfind('*');
  Frame frame;
  frame.end = line.size();
  const bool complete = semicolon != std::string_view::npos && star != std::string_view::npos &&
                        semicolon < star && star + 1 + kNovatelCrcDigits <= line.size();
  if (complete) {
    uint32_t told = 0;
    const char* const digits = line.data() + star + 1;
    const auto read = std::from_chars(digits, digits + kNovatelCrcDigits, told, 16);
    frame.body = semicolon + 1;
    frame.body_end = star;
    frame.end = star + 1 + kNovatelCrcDigits;
    frame.whole =
        read.ptr == digits + kNovatelCrcDigits && novatel_crc(bytes.begin + 1, star - 1) == told;
  }
  return known || frame.whole ? std::optional(frame) : std::nullopt;
}

std::optional<NovatelMessage> NovatelFile::next() {
  while (find_start()) {
    file_.begin_record();
    const Bytes window = file_.window();
    const bool ascii = *window.begin != 0xaa;
    const std::optional<Frame> frame = ascii ? ascii_frame(window) : binary_frame(window);
    if (!frame || !frame->whole) {
      if (frame && damaged_++ == 0) first_damaged_ = file_.position();
      file_.skip(1);  // a log may begin within what a wrong length spans
      continue;
    }
    file_.read(frame->end, bytes_);
    ++messages_;
    std::optional<NovatelMessage> message = ascii ? ascii_message(*frame) : binary_message();
    if (!message) continue;
    message->body = {bytes_.data() + frame->body, bytes_.data() + frame->body_end};
    message->ascii = ascii;
    message->place = &file_;
    return message;
  }
  return std::nullopt;
}

/// None of a log that is not needed, or a response to a command.
std::optional<NovatelMessage> NovatelFile::binary_message() const {
  constexpr unsigned char kResponse = 0x80;
  const unsigned char* const bytes = bytes_.data();
  const bool is_long = bytes[2] == kNovatelLong;
  const std::optional<NovatelId> id = novatel_id(static_cast<int>(little_endian(bytes + 4, 2)));
  if (!id || (is_long && (bytes[6] & kResponse) != 0)) return std::nullopt;
  const unsigned char* const time = bytes + (is_long ? 14 : 6);
  NovatelMessage message;
  message.id = *id;
  message.week = little_endian(time, 2);
  message.tow_ns = int64_t{little_endian(time + 2, 4)} * kNanosecondsPerMillisecond;
  return message;
}

/// "#NAMEA,port,sequence,idle,status,week,seconds,...;" or "%NAMEA,week,seconds;"
std::optional<NovatelMessage> NovatelFile::ascii_message(const Frame& frame) const {
  std::string_view header(reinterpret_cast<const char*>(bytes_.data()) + 1, frame.body - 2);
  const std::optional<NovatelId> id = novatel_id(first_part(header));
  if (!id) return std::nullopt;
  if (bytes_[0] == '#') {
    for (int i = 0; i < 4; ++i) first_part(header);
  }
  constexpr int64_t kLastWeek = 0xffff;  // as the binary form can hold
  const std::string_view week = first_part(header);
  NovatelMessage message;
  message.id = *id;
  const auto read = std::from_chars(week.data(), week.data() + week.size(), message.week);
  const std::optional<int64_t> tow_ns = header_seconds_ns(first_part(header));
  if (read.ec != std::errc{} || message.week < 0 || message.week > kLastWeek || !tow_ns) {
    file_.fail(
        fmt::format("log {} has a header without week and seconds; remove the line", name_of(*id)));
  }
  message.tow_ns = *tow_ns;
  return message;
}

}  // namespace foucault::rawlog
