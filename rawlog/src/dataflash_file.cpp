#include "dataflash_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "record_cursor.h"

namespace foucault::rawlog {

namespace {

constexpr unsigned char kDataflashHead[] = {0xa3, 0x95};
constexpr size_t kDataflashHeader = 3;
constexpr size_t kFormatType = 128;
constexpr size_t kFormatLength = 89;
constexpr double kHundredth = 1e-2;
constexpr double kTenMillionth = 1e-7;

struct DataflashType {
  size_t size = 0;  ///< [bytes]
  double (*decode)(RecordCursor) = nullptr;
  double scale = 1;
};

template <class T>
double dataflash_number(RecordCursor cursor) {
  return static_cast<double>(cursor.get<T>());
}

const DataflashType* dataflash_type(char letter) {
  static const std::map<char, DataflashType> kTypes{
      {'a', {64}},
      {'b', {1, dataflash_number<int8_t>}},
      {'B', {1, dataflash_number<uint8_t>}},
      {'M', {1, dataflash_number<uint8_t>}},
      {'h', {2, dataflash_number<int16_t>}},
      {'H', {2, dataflash_number<uint16_t>}},
      {'i', {4, dataflash_number<int32_t>}},
      {'I', {4, dataflash_number<uint32_t>}},
      {'f', {4, dataflash_number<float>}},
      {'d', {8, dataflash_number<double>}},
      {'q', {8, dataflash_number<int64_t>}},
      {'Q', {8, dataflash_number<uint64_t>}},
      {'c', {2, dataflash_number<int16_t>, kHundredth}},
      {'C', {2, dataflash_number<uint16_t>, kHundredth}},
      {'e', {4, dataflash_number<int32_t>, kHundredth}},
      {'E', {4, dataflash_number<uint32_t>, kHundredth}},
      {'L', {4, dataflash_number<int32_t>, kTenMillionth}},
      {'n', {4}},
      {'N', {16}},
      {'Z', {64}}};
  const auto found = kTypes.find(letter);
  return found == kTypes.end() ? nullptr : &found->second;
}

/// Up to the first zero.
std::string padded_text(const unsigned char* begin, size_t count) {
  const unsigned char* const end = std::find(begin, begin + count, '\0');
  return {begin, end};
}

std::string_view stripped(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    parts.push_back(stripped(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return parts;
}

template <class T>
std::optional<T> whole_number(std::string_view text) {
  T value{};
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  return read.ec == std::errc{} && read.ptr == end ? std::optional(value) : std::nullopt;
}

}  // namespace

// Messages --------------------------------------------------------------------------------------

std::string_view DataflashMessage::text_of(const DataflashField& field) const {
  if (field.index + 1 < texts_->size()) return (*texts_)[field.index + 1];
  place_->fail(fmt::format("the {} has {} values, too few for its format; remove the line", name(),
                           texts_->size() - 1));
}

double DataflashMessage::value(const DataflashField& field) const {
  const DataflashType* const type = dataflash_type(field.type);
  if (type == nullptr || type->decode == nullptr) {
    place_->fail(fmt::format("a field of {} is no number", name()));
  }
  if (texts_ != nullptr) {
    const std::string_view text = text_of(field);
    const std::optional<double> found = whole_number<double>(text);
    if (found) return *found;
    place_->fail(fmt::format("the {} has '{}', which is no number; remove the line", name(), text));
  }
  try {
    RecordCursor cursor(bytes_);
    cursor.skip(field.offset);
    return type->decode(cursor) * type->scale;
  } catch (const RecordTooShort&) {
    place_->fail(
        fmt::format("the {} is shorter than its format; the file is damaged here", name()));
  }
}

std::optional<double> DataflashMessage::number(std::string_view field) const {
  const auto found = format_->fields.find(field);
  if (found == format_->fields.end()) return std::nullopt;
  const double read = value(found->second);
  if (std::isfinite(read)) return read;
  place_->fail(fmt::format("the {} has a {} that is not finite", name(), field));
}

double DataflashMessage::needed(std::string_view field) const {
  const std::optional<double> found = number(field);
  if (found) return *found;
  place_->fail(fmt::format("the {} has no {}", name(), field));
}

std::string DataflashMessage::text(std::string_view field) const {
  const auto found = format_->fields.find(field);
  if (found == format_->fields.end()) place_->fail(fmt::format("the {} has no {}", name(), field));
  if (texts_ != nullptr) return std::string(text_of(found->second));
  const DataflashType* const type = dataflash_type(found->second.type);
  if (type == nullptr || found->second.offset + type->size > bytes_.size()) {
    place_->fail(
        fmt::format("the {} is shorter than its format; the file is damaged here", name()));
  }
  return padded_text(bytes_.begin + found->second.offset, type->size);
}

// Files -----------------------------------------------------------------------------------------

DataflashFile::DataflashFile(const std::string& path) : file_(path) {
  const Bytes window = file_.window();
  const std::string_view text(reinterpret_cast<const char*>(window.begin), window.size());
  constexpr char kFirst[] = {'\xa3', '\x95', '\x80', '\0'};
  const bool is_binary = text.find(kFirst) != std::string_view::npos;
  is_text_ = !is_binary && text.find("FMT,") != std::string_view::npos;
  if (!is_binary && !is_text_) {
    throw DataError(
        fmt::format("{}: no DataFlash log of ArduPilot begins here, there is no FMT message; check "
                    "the file",
                    file_.place(0)));
  }
  define("FMT", "BBnNZ", "Type,Length,Name,Format,Columns", kFormatType, kFormatLength);
}

std::optional<DataflashMessage> DataflashFile::next() {
  return is_text_ ? next_line() : next_binary();
}

void DataflashFile::pass_over(uint64_t count) {
  if (!lost_ && damages_++ == 0) first_damage_ = file_.offset();
  lost_ = true;
  damaged_bytes_ += static_cast<int64_t>(count);
  file_.skip(count);
}

/// Null where no message is known to begin.
const DataflashFormat* DataflashFile::format_at(Bytes window) const {
  if (window.size() < kDataflashHeader ||
      !std::equal(std::begin(kDataflashHead), std::end(kDataflashHead), window.begin)) {
    return nullptr;
  }
  const auto found = formats_.find(window.begin[2]);
  if (found == formats_.end() || found->second.length > window.size()) return nullptr;
  return &found->second;
}

/// Whether another message, or the end, comes behind one: there is no checksum.
bool DataflashFile::follows(Bytes window, size_t length) const {
  const Bytes behind{window.begin + length, window.end};
  return behind.size() == 0 || format_at(behind) != nullptr;
}

/// Where within a message another one begins that goes on; none if it is whole.
std::optional<size_t> DataflashFile::begins_within(Bytes window, size_t length) const {
  if (follows(window, length)) return std::nullopt;
  for (size_t i = 1; i < length; ++i) {
    const Bytes rest{window.begin + i, window.end};
    const DataflashFormat* const format = format_at(rest);
    if (format != nullptr && follows(rest, format->length)) return i;
  }
  return std::nullopt;
}

std::optional<DataflashMessage> DataflashFile::next_binary() {
  while (true) {
    const Bytes window = file_.window();
    if (window.size() == 0) return std::nullopt;
    const DataflashFormat* const format = format_at(window);
    if (format == nullptr || (lost_ && !follows(window, format->length))) {
      pass_over(1);
      continue;
    }
    if (const std::optional<size_t> inner = begins_within(window, format->length)) {
      pass_over(*inner);
      continue;
    }
    lost_ = false;
    file_.begin_record();
    file_.read(format->length, body_);
    const DataflashMessage message(
        *format, Bytes{body_.data() + kDataflashHeader, body_.data() + body_.size()}, file_);
    if (!is_definition(message)) return message;
  }
}

/// False at the end of the file.
bool DataflashFile::read_line() {
  const Bytes window = file_.window();
  if (window.size() == 0) return false;
  file_.begin_record();
  const unsigned char* const end = std::find(window.begin, window.end, '\n');
  const auto length = static_cast<size_t>(end - window.begin);
  file_.read(std::min(length + 1, window.size()), body_);
  texts_ = split({reinterpret_cast<const char*>(body_.data()), length});
  return true;
}

/// What is written before the definitions, and lines of names that nothing defines, are passed
/// over.
std::optional<DataflashMessage> DataflashFile::next_line() {
  while (read_line()) {
    const auto type = types_.find(texts_.front());
    if (type == types_.end()) continue;
    const DataflashMessage message(formats_.at(type->second), texts_, file_);
    if (!is_definition(message)) return message;
  }
  return std::nullopt;
}

bool DataflashFile::is_definition(const DataflashMessage& message) {
  if (message.name() == "FMT") {
    is_text_ ? define_text() : define_binary();
    return true;
  }
  if (message.name() != "PARM") return false;
  const std::optional<double> value = message.number("Value");
  if (value) parameters_.emplace(message.text("Name"), *value);
  return true;
}

void DataflashFile::define_binary() {
  constexpr size_t kName = 4;
  constexpr size_t kTypes = 16;
  constexpr size_t kColumns = 64;
  RecordCursor cursor(bytes_of(body_));
  cursor.skip(kDataflashHeader);
  const auto type = cursor.get<uint8_t>();
  const auto length = cursor.get<uint8_t>();
  const std::string name = padded_text(cursor.take(kName), kName);
  const std::string types = padded_text(cursor.take(kTypes), kTypes);
  define(name, types, padded_text(cursor.take(kColumns), kColumns), type, length);
}

/// "FMT, type, length, name, format, column,column"
void DataflashFile::define_text() {
  constexpr size_t kColumns = 5;
  if (texts_.size() <= kColumns) file_.fail("an FMT that is cut off; remove the line");
  const std::optional<size_t> type = whole_number<size_t>(texts_[1]);
  const std::optional<size_t> length = whole_number<size_t>(texts_[2]);
  if (!type || !length) file_.fail("an FMT whose type or length is no number; remove the line");
  std::string columns;
  for (size_t i = kColumns; i < texts_.size(); ++i) columns += std::string(texts_[i]) + ",";
  define(std::string(texts_[3]), std::string(texts_[4]), columns, *type, *length);
}

void DataflashFile::define(const std::string& name, const std::string& types,
                           const std::string& columns, size_t type, size_t length) {
  const bool is_own = type == kFormatType && name == "FMT" && length == kFormatLength;
  if (length < kDataflashHeader || (type == kFormatType && !is_own)) {
    file_.fail(fmt::format("a format {} of type {} and {} bytes; the file is damaged here", name,
                           type, length));
  }
  DataflashFormat format;
  format.name = name;
  format.length = length;
  size_t offset = 0;
  const std::vector<std::string_view> names = split(columns);
  for (size_t i = 0; i < types.size() && i < names.size(); ++i) {
    const DataflashType* const known = dataflash_type(types[i]);
    if (known == nullptr) break;  // what comes behind it cannot be found
    if (!names[i].empty()) format.fields[std::string(names[i])] = {types[i], i, offset};
    offset += known->size;
  }
  types_[name] = type;
  formats_[type] = std::move(format);
}

}  // namespace foucault::rawlog
