#include "ros_layout.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "ros_builtin_types.h"

namespace foucault::rawlog {

namespace {

constexpr int kMostNested = 16;  ///< types within types
constexpr size_t kMostFields = 4096;
constexpr size_t kLongestArray = 1U << 20;
constexpr const char* kText = "string";

}  // namespace

/// Walks over a message. Plain CDR puts each number at a multiple of its size, counted from behind
/// the header, and may have the order of bytes turned round.
class RosCursor {
 public:
  RosCursor(Bytes message, RosEncoding encoding)
      : cdr_(encoding == RosEncoding::cdr),
        turned_(cdr_ && is_big_endian(message)),
        cursor_(cdr_ ? Bytes{message.begin + kCdrHeader, message.end} : message) {}

  template <class T>
  T get() {
    if (cdr_) cursor_.skip((sizeof(T) - cursor_.position() % sizeof(T)) % sizeof(T));
    const unsigned char* const begin = cursor_.take(sizeof(T));
    std::array<unsigned char, sizeof(T)> bytes;
    std::copy(begin, begin + sizeof(T), bytes.begin());
    if (turned_) std::reverse(bytes.begin(), bytes.end());
    T value;
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }

  void skip(size_t count) { cursor_.skip(count); }
  /// In the message.
  size_t position() const { return cursor_.position() + (cdr_ ? kCdrHeader : 0); }

 private:
  static constexpr ptrdiff_t kCdrHeader = 4;

  static bool is_big_endian(Bytes message) {
    if (message.size() < kCdrHeader) throw RecordTooShort();
    if (message.begin[0] != 0 || message.begin[1] > 1) {
      throw BadRecord("a message that is not encoded by plain CDR");
    }
    return message.begin[1] == 0;
  }

  bool cdr_;
  bool turned_;
  RecordCursor cursor_;
};

namespace {

using RosDecoder = double (*)(RosCursor&);

template <class T>
double ros_number(RosCursor& cursor) {
  return static_cast<double>(cursor.get<T>());
}

double text_length(RosCursor& cursor) {
  const auto size = cursor.get<uint32_t>();
  cursor.skip(size);
  return size;
}

/// Null of a type that is none of ROS's own.
RosDecoder ros_decoder(const std::string& type) {
  static const std::map<std::string, RosDecoder> kDecoders{
      {"bool", ros_number<uint8_t>},    {"byte", ros_number<int8_t>},
      {"char", ros_number<uint8_t>},    {"int8", ros_number<int8_t>},
      {"uint8", ros_number<uint8_t>},   {"int16", ros_number<int16_t>},
      {"uint16", ros_number<uint16_t>}, {"int32", ros_number<int32_t>},
      {"uint32", ros_number<uint32_t>}, {"int64", ros_number<int64_t>},
      {"uint64", ros_number<uint64_t>}, {"float32", ros_number<float>},
      {"float64", ros_number<double>},  {kText, text_length}};
  const auto found = kDecoders.find(type);
  return found == kDecoders.end() ? nullptr : found->second;
}

bool is_time(const std::string& type) { return type == "time" || type == "duration"; }

std::string_view next_word(std::string_view& text) {
  const size_t begin = std::min(text.find_first_not_of(" \t\r"), text.size());
  const size_t end = std::min(text.find_first_of(" \t\r", begin), text.size());
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

}  // namespace

/// Puts what is wanted of a message into `values`.
class RosFieldReader {
 public:
  RosFieldReader(Bytes message, RosEncoding encoding, std::vector<double>& values)
      : most_(message.size()), cursor_(message, encoding), values_(values) {}

  void read(const RosLayout::Field& field) {
    const bool empty = field.type.empty() && field.members.empty();
    const size_t count = field.counted ? counted(empty ? UINT32_MAX : most_) : field.count;
    if (empty) return;
    const RosDecoder decode = ros_decoder(field.type);
    for (size_t i = 0; i < count; ++i) {
      if (decode == nullptr) {
        for (const RosLayout::Field& member : field.members) read(member);
      } else {
        take(field, i, decode(cursor_));
      }
    }
  }

 private:
  void take(const RosLayout::Field& field, size_t i, double value) {
    if (!field.slot) return;
    if (field.type == kText) {
      values_[*field.slot] = static_cast<double>(cursor_.position()) - value;
      i = 1;
    }
    values_[*field.slot + i] = value;
  }

  size_t counted(size_t most) {
    const auto count = cursor_.get<uint32_t>();
    if (count > most) throw BadRecord("a length of " + std::to_string(count));
    return count;
  }

  size_t most_;
  RosCursor cursor_;
  std::vector<double>& values_;
};

std::string package_and_type(std::string name) {
  constexpr std::string_view kBetween = "/msg/";
  const size_t found = name.find(kBetween);
  if (found != std::string::npos) name.replace(found, kBetween.size(), "/");
  return name;
}

RosLayout::RosLayout(const RosType& type) : encoding_(type.encoding) {
  if (encoding_ == RosEncoding::unknown) throw BadRecord("an encoding that is not one of ROS");
  const std::string name = package_and_type(type.name);
  Types types;
  if (encoding_ == RosEncoding::cdr) add_types(kRosBuiltinTypes, "", types);
  if (!type.definition.empty()) add_types(type.definition, name, types);
  if (types.count(name) == 0) throw BadRecord("a type that is not defined");
  expand(types, name, "", 0, fields_);
}

/// The definition begins with that of `name`. Those of the same name are replaced.
void RosLayout::add_types(std::string_view definition, const std::string& name, Types& types) {
  std::vector<Line>* lines = &types[name];
  lines->clear();
  while (!definition.empty()) {
    const size_t end = std::min(definition.find('\n'), definition.size());
    std::string_view text = definition.substr(0, end);
    definition.remove_prefix(std::min(end + 1, definition.size()));
    if (text.substr(0, 3) == "===") continue;
    if (text.substr(0, 4) == "MSG:") {
      text.remove_prefix(4);
      lines = &types[package_and_type(std::string(next_word(text)))];
      lines->clear();
    } else if (const std::optional<Line> line = line_of(text.substr(0, text.find('#')))) {
      lines->push_back(*line);
    }
  }
}

/// None of an empty line and of a constant.
std::optional<RosLayout::Line> RosLayout::line_of(std::string_view text) {
  Line line;
  line.type = next_word(text);
  line.name = next_word(text);
  const bool constant =
      line.name.find('=') != std::string::npos || next_word(text).substr(0, 1) == "=";
  if (line.name.empty() || constant) return std::nullopt;
  take_brackets(line);
  line.type.resize(std::min(line.type.find("<="), line.type.size()));  // the longest text allowed
  return line;
}

/// `[]` and `[<=5]`: the number stands before the elements; `[5]`: so many.
void RosLayout::take_brackets(Line& line) {
  const size_t bracket = line.type.find('[');
  if (bracket == std::string::npos) return;
  const std::string inside = line.type.substr(bracket + 1);
  line.type.resize(bracket);
  line.array = true;
  line.counted = inside[0] == ']' || inside.substr(0, 2) == "<=";
  if (line.counted) return;
  const char* const end = inside.data() + inside.size();
  const auto result = std::from_chars(inside.data(), end, line.count);
  if (result.ec != std::errc{} || line.count > kLongestArray) {
    throw BadRecord("a message definition with a length that is none");
  }
}

/// Types of the same package, and `Header`, go without their package.
std::optional<std::string> RosLayout::find_type(const Types& types, const std::string& name,
                                                const std::string& within) {
  const std::string type = package_and_type(name);
  const std::string neighbour = within.substr(0, within.find('/')) + "/" + type;
  for (const std::string& found : {type, neighbour}) {
    if (types.count(found) > 0) return found;
  }
  const std::string ending = "/" + type;
  for (const auto& [found, lines] : types) {
    if (found.size() > ending.size() &&
        found.compare(found.size() - ending.size(), ending.size(), ending) == 0) {
      return found;
    }
  }
  return std::nullopt;
}

/// Two numbers; in an array they are passed over.
void RosLayout::add_time(const Line& line, const std::string& path, std::vector<Field>& fields) {
  if (line.array) {
    fields.push_back({path, "uint64", line.count, line.counted, {}, {}});
    return;
  }
  const std::string part = line.type == "time" ? "uint32" : "int32";
  fields.push_back({path + ".sec", part, 1, false, {}, {}});
  fields.push_back({path + ".nanosec", part, 1, false, {}, {}});
}

void RosLayout::expand(const Types& types, const std::string& type, const std::string& prefix,
                       int depth, std::vector<Field>& fields) {
  if (depth > kMostNested) throw BadRecord("a message definition within itself");
  const std::vector<Line>& lines = types.at(type);
  if (lines.empty() && encoding_ == RosEncoding::cdr) {  // a byte stands for nothing
    fields.push_back({prefix, "uint8", 1, false, {}, {}});
  }
  for (const Line& line : lines) expand_line(types, type, line, prefix + line.name, depth, fields);
}

void RosLayout::expand_line(const Types& types, const std::string& within, const Line& line,
                            const std::string& path, int depth, std::vector<Field>& fields) {
  if (++fields_made_ > kMostFields) throw BadRecord("a message definition that is too long");
  if (is_time(line.type)) {
    add_time(line, path, fields);
    return;
  }
  Field field{path, line.type, line.count, line.counted, {}, {}};
  if (ros_decoder(line.type) != nullptr) {
    fields.push_back(field);
    return;
  }
  const std::optional<std::string> inner = find_type(types, line.type, within);
  if (!inner) throw BadRecord("a message definition without its part " + line.type);
  field.type.clear();
  expand(types, *inner, path + ".", depth + 1, line.array ? field.members : fields);
  if (line.array) fields.push_back(field);
}

std::optional<size_t> RosLayout::want(const std::string& path, size_t count) {
  const std::optional<size_t> plain = want_exactly(path, count);
  return plain ? plain : want_exactly(path + ".data", count);
}

std::optional<size_t> RosLayout::want_exactly(const std::string& path, size_t count) {
  for (Field& field : fields_) {
    const bool numbers = !field.type.empty() && field.type != kText && !field.counted;
    if (field.path != path || !numbers || field.count != count) continue;
    if (!field.slot) {
      field.slot = wanted_;
      wanted_ += count;
    }
    return field.slot;
  }
  return std::nullopt;
}

std::optional<size_t> RosLayout::want_text(const std::string& path) {
  for (Field& field : fields_) {
    if (field.path != path || field.type != kText || field.counted || field.count != 1) continue;
    field.slot = wanted_;
    wanted_ += 2;
    return field.slot;
  }
  return std::nullopt;
}

bool RosLayout::has(const std::string& path) const {
  return std::any_of(fields_.begin(), fields_.end(),
                     [&](const Field& field) { return field.path == path; });
}

std::vector<double> RosLayout::read(Bytes message) const {
  std::vector<double> values(wanted_);
  RosFieldReader reader(message, encoding_, values);
  for (const Field& field : fields_) reader.read(field);
  return values;
}

}  // namespace foucault::rawlog
