#include "ulog_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "record_cursor.h"

namespace foucault::rawlog {

namespace {

constexpr size_t kFileHeader = 16;
constexpr size_t kMessageHeader = 3;
constexpr int kDeepest = 8;  ///< formats within formats
constexpr size_t kLargestMessage = 1U << 16;

size_t size_of_number(const std::string& type) {
  static const std::map<std::string, size_t> kSizes{
      {"int8_t", 1},  {"uint8_t", 1},  {"bool", 1},     {"char", 1},
      {"int16_t", 2}, {"uint16_t", 2}, {"int32_t", 4},  {"uint32_t", 4},
      {"float", 4},   {"int64_t", 8},  {"uint64_t", 8}, {"double", 8}};
  const auto found = kSizes.find(type);
  return found == kSizes.end() ? 0 : found->second;
}

template <class T>
double number_as(RecordCursor cursor) {
  return static_cast<double>(cursor.get<T>());
}

using Decoder = double (*)(RecordCursor);

Decoder decoder_of(const std::string& type) {
  static const std::map<std::string, Decoder> kDecoders{
      {"int8_t", number_as<int8_t>},     {"uint8_t", number_as<uint8_t>},
      {"bool", number_as<uint8_t>},      {"int16_t", number_as<int16_t>},
      {"uint16_t", number_as<uint16_t>}, {"int32_t", number_as<int32_t>},
      {"uint32_t", number_as<uint32_t>}, {"int64_t", number_as<int64_t>},
      {"uint64_t", number_as<uint64_t>}, {"float", number_as<float>},
      {"double", number_as<double>}};
  const auto found = kDecoders.find(type);
  return found == kDecoders.end() ? nullptr : found->second;
}

std::string_view text_of(RecordCursor& cursor, size_t length) {
  return {reinterpret_cast<const char*>(cursor.take(length)), length};
}

}  // namespace

double UlogMessage::number(const UlogField& field, size_t index) const {
  const Decoder decode = decoder_of(field.type);
  if (decode == nullptr || index >= field.count) {
    place_->fail(
        fmt::format("topic {} has a field of another type than this program knows", topic_->name));
  }
  try {
    RecordCursor cursor(bytes_);
    cursor.skip(field.offset + index * size_of_number(field.type));
    return decode(cursor);
  } catch (const RecordTooShort&) {
    place_->fail(
        fmt::format("the message of topic {} has {} bytes, too few for its format; the "
                    "file is damaged here",
                    topic_->name, bytes_.size()));
  }
}

double UlogMessage::finite(const UlogField& field, size_t index) const {
  const double value = number(field, index);
  if (!std::isfinite(value)) {
    place_->fail(fmt::format("topic {} has a value that is not finite", topic_->name));
  }
  return value;
}

int64_t UlogMessage::integer(const UlogField& field) const {
  constexpr double kMost = 0x1p62;
  const double value = finite(field);
  if (std::abs(value) > kMost) {
    place_->fail(
        fmt::format("topic {} has the number {:.3g}, which cannot be; the file is damaged "
                    "here",
                    topic_->name, value));
  }
  return std::llround(value);
}

UlogFile::UlogFile(const std::string& path) : file_(path) {
  static constexpr unsigned char kMagic[] = {'U', 'L', 'o', 'g', 0x01, 0x12, 0x35};
  const bool whole = file_.read(kFileHeader, body_);
  if (!whole || !std::equal(std::begin(kMagic), std::end(kMagic), body_.begin())) {
    throw DataError(
        fmt::format("{}: it does not begin as a ULog of PX4 does; check the file", file_.place(0)));
  }
}

std::optional<UlogMessage> UlogFile::next() {
  char type = 0;
  while (read_message(type)) {
    try {
      if (type == 'D') return data();
      define(type);
    } catch (const RecordTooShort&) {
      file_.fail(
          fmt::format("the message of type {} and {} bytes is too short; the file is damaged "
                      "here",
                      fmt::format("0x{:02x}", static_cast<unsigned char>(type)), body_.size()));
    }
  }
  return std::nullopt;
}

/// The type of the next message, and its bytes in body_. False at the end of the file.
bool UlogFile::read_message(char& type) {
  enter_appended(kMessageHeader);
  file_.begin_record();
  if (file_.at_end()) return false;
  bool whole = file_.read(kMessageHeader, body_);
  if (whole) {
    RecordCursor header(bytes_of(body_));
    const auto size = header.get<uint16_t>();
    type = header.get<char>();
    if (enter_appended(size)) return read_message(type);
    whole = file_.read(size, body_);
  }
  if (!whole) file_.fail("the file ends within a message, it is cut off; get the whole one");
  return true;
}

/// Data that were appended after a crash may begin within a message that was never completed: goes
/// there if they begin within the next `count` bytes.
bool UlogFile::enter_appended(uint64_t count) {
  while (!appended_.empty() && appended_.front() < file_.offset()) {
    appended_.erase(appended_.begin());
  }
  if (appended_.empty()) return false;
  const int64_t left = appended_.front() - file_.offset();
  if (static_cast<int64_t>(count) <= left) return false;
  appended_.erase(appended_.begin());
  return file_.skip(static_cast<uint64_t>(left));
}

void UlogFile::define(char type) {
  switch (type) {
    case 'B':
      define_flags();
      break;
    case 'F':
      define_format();
      break;
    case 'P':
      define_parameter();
      break;
    case 'A':
      subscribe();
      break;
    case 'R': {
      RecordCursor cursor(bytes_of(body_));
      topics_.erase(cursor.get<uint16_t>());
      break;
    }
    default:
      pass_over(type);
      break;
  }
}

/// Information, texts, synchronization and dropouts (holes show in the stamps); another kind is
/// damage, from which the lengths of messages lead back to whole ones by chance.
void UlogFile::pass_over(char type) {
  static constexpr std::string_view kKnown = "IMQLCSO";
  if (kKnown.find(type) != std::string_view::npos) return;
  if (unreadable_ == 0) first_unreadable_ = file_.position();
  unreadable_ += static_cast<int64_t>(kMessageHeader + body_.size());
}

void UlogFile::define_flags() {
  constexpr size_t kFlags = 8;
  constexpr size_t kOffsets = 3;
  RecordCursor cursor(bytes_of(body_));
  cursor.skip(kFlags);
  for (size_t i = 0; i < kFlags; ++i) {
    const auto flags = cursor.get<uint8_t>();
    const bool known = flags == 0 || (i == 0 && flags == 1);  // 1: there are appended data
    if (known) continue;
    throw DataError(
        fmt::format("{}: the ULog needs a reader newer than this one (flag byte {} is "
                    "{}); convert it with PX4's tools",
                    file_.place(file_.position()), i, flags));
  }
  for (size_t i = 0; i < kOffsets; ++i) {
    const auto offset = cursor.get<uint64_t>();
    if (offset > 0 && offset < uint64_t{1} << 62U) {
      appended_.push_back(static_cast<int64_t>(offset));
    }
  }
  std::sort(appended_.begin(), appended_.end());
}

/// "name:type field;type[n] field;"
void UlogFile::define_format() {
  const std::string text(body_.begin(), body_.end());
  const size_t colon = text.find(':');
  if (colon == std::string::npos) file_.fail("a format without a name; the file is damaged here");
  std::vector<Member> members;
  for (size_t begin = colon + 1; begin < text.size();) {
    const size_t end = std::min(text.find(';', begin), text.size());
    const std::optional<Member> member =
        member_of(std::string_view(text).substr(begin, end - begin));
    if (member) members.push_back(*member);
    begin = end + 1;
  }
  formats_[text.substr(0, colon)] = std::move(members);
  sizes_.clear();
}

/// None of an empty text. Throws RowError.
std::optional<UlogFile::Member> UlogFile::member_of(std::string_view text) const {
  if (text.empty()) return std::nullopt;
  const size_t blank = text.find(' ');
  if (blank == std::string_view::npos) {
    file_.fail("a format with a field that has no name; the file is damaged here");
  }
  Member member{std::string(text.substr(blank + 1)), std::string(text.substr(0, blank)), 1};
  const size_t bracket = member.type.find('[');
  if (bracket == std::string::npos) return member;
  const char* const end = member.type.data() + member.type.size();
  const auto [after, error] = std::from_chars(member.type.data() + bracket + 1, end, member.count);
  if (error != std::errc{} || after == end || *after != ']' || member.count > kLargestMessage) {
    file_.fail("a format with a length that is none; the file is damaged here");
  }
  member.type.resize(bracket);
  return member;
}

void UlogFile::define_parameter() {
  RecordCursor cursor(bytes_of(body_));
  const std::string key(text_of(cursor, cursor.get<uint8_t>()));
  const size_t blank = key.find(' ');
  if (blank == std::string::npos) return;
  const std::string type = key.substr(0, blank);
  const Decoder decode = decoder_of(type);
  if (decode != nullptr) parameters_.emplace(key.substr(blank + 1), decode(cursor));
}

void UlogFile::subscribe() {
  RecordCursor cursor(bytes_of(body_));
  const auto instance = cursor.get<uint8_t>();
  const auto id = cursor.get<uint16_t>();
  const std::string name(text_of(cursor, body_.size() - cursor.position()));
  size_t size = 0;
  topics_[id] = {name, instance, layout(name, size)};
}

UlogMessage UlogFile::data() const {
  RecordCursor cursor(bytes_of(body_));
  const auto id = cursor.get<uint16_t>();
  const auto topic = topics_.find(id);
  if (topic == topics_.end()) {
    file_.fail(
        fmt::format("data of message {}, which nothing defines; the file is damaged here", id));
  }
  return {topic->second, {body_.data() + sizeof id, body_.data() + body_.size()}, file_};
}

UlogFields UlogFile::layout(const std::string& format, size_t& size) {
  const auto found = formats_.find(format);
  if (found == formats_.end()) file_.fail("a topic without a format; the file is damaged here");
  UlogFields fields;
  size = 0;
  for (const Member& member : found->second) {
    fields[member.name] = {member.type, member.count, size};
    size += member.count * size_of(member.type, 0);
    if (size > kLargestMessage) file_.fail("a format longer than a message can be");
  }
  return fields;
}

size_t UlogFile::size_of(const std::string& type, int depth) {
  const size_t plain = size_of_number(type);
  if (plain > 0) return plain;
  const auto known = sizes_.find(type);
  if (known != sizes_.end()) return known->second;
  const auto found = formats_.find(type);
  if (found == formats_.end() || depth >= kDeepest) {
    file_.fail("a format with a type that nothing defines; the file is damaged here");
  }
  size_t size = 0;
  for (const Member& member : found->second) {
    size += member.count * size_of(member.type, depth + 1);
    if (size > kLargestMessage) file_.fail("a format longer than a message can be");
  }
  return sizes_[type] = size;
}

}  // namespace foucault::rawlog
