#include "ros_layout.h"

#include <algorithm>
#include <charconv>

namespace foucault::rawlog {

namespace {

constexpr int kMostNested = 16;  ///< types within types
constexpr size_t kMostFields = 4096;
constexpr size_t kLongestArray = 1U << 20;
constexpr const char* kText = "string";

using RosDecoder = double (*)(RecordCursor&);

template <class T>
double ros_number(RecordCursor& cursor) {
  return static_cast<double>(cursor.get<T>());
}

double text_length(RecordCursor& cursor) {
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

RosLayout::RosLayout(const std::string& definition) {
  expand(types_of(definition), "", "", 0, fields_);
}

/// The type itself is called "".
RosLayout::Types RosLayout::types_of(const std::string& definition) {
  Types types;
  std::string name;
  types[name];
  std::string_view left = definition;
  while (!left.empty()) {
    const size_t end = std::min(left.find('\n'), left.size());
    std::string_view text = left.substr(0, end);
    left.remove_prefix(std::min(end + 1, left.size()));
    if (text.substr(0, 3) == "===") continue;
    if (text.substr(0, 4) == "MSG:") {
      text.remove_prefix(4);
      name = next_word(text);
    } else if (const std::optional<Line> line = line_of(text.substr(0, text.find('#')))) {
      types[name].push_back(*line);
    }
  }
  return types;
}

/// None of an empty line and of a constant.
std::optional<RosLayout::Line> RosLayout::line_of(std::string_view text) {
  Line line;
  line.type = next_word(text);
  line.name = next_word(text);
  const bool constant =
      text.find('=') != std::string_view::npos || line.name.find('=') != std::string::npos;
  if (line.name.empty() || constant) return std::nullopt;
  const size_t bracket = line.type.find('[');
  if (bracket == std::string::npos) return line;
  line.array = true;
  line.counted = line.type.substr(bracket) == "[]";
  const char* const end = line.type.data() + line.type.size();
  const auto result = std::from_chars(line.type.data() + bracket + 1, end, line.count);
  if (!line.counted && (result.ec != std::errc{} || line.count > kLongestArray)) {
    throw BadRecord("a message definition with a length that is none");
  }
  line.type.resize(bracket);
  return line;
}

/// `Header`, and types of the same package, go without their package.
std::optional<std::string> RosLayout::find_type(const Types& types, const std::string& type) {
  if (types.count(type) > 0) return type;
  const std::string ending = "/" + type;
  for (const auto& [name, lines] : types) {
    if (name.size() > ending.size() &&
        name.compare(name.size() - ending.size(), ending.size(), ending) == 0) {
      return name;
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
  fields.push_back({path + ".secs", part, 1, false, {}, {}});
  fields.push_back({path + ".nsecs", part, 1, false, {}, {}});
}

void RosLayout::expand(const Types& types, const std::string& type, const std::string& prefix,
                       int depth, std::vector<Field>& fields) {
  if (depth > kMostNested) throw BadRecord("a message definition within itself");
  for (const Line& line : types.at(type)) {
    if (++fields_made_ > kMostFields) throw BadRecord("a message definition that is too long");
    const std::string path = prefix + line.name;
    if (is_time(line.type)) {
      add_time(line, path, fields);
      continue;
    }
    Field field{path, line.type, line.count, line.counted, {}, {}};
    if (ros_decoder(line.type) != nullptr) {
      fields.push_back(field);
    } else {
      const std::optional<std::string> inner = find_type(types, line.type);
      if (!inner) throw BadRecord("a message definition without its part " + line.type);
      field.type.clear();
      expand(types, *inner, path + ".", depth + 1, line.array ? field.members : fields);
      if (line.array) fields.push_back(field);
    }
  }
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

std::vector<double> RosLayout::read(Bytes message) const {
  std::vector<double> values(wanted_);
  RecordCursor cursor(message);
  for (const Field& field : fields_) read_field(field, cursor, message.size(), values);
  return values;
}

void RosLayout::read_field(const Field& field, RecordCursor& cursor, size_t size,
                           std::vector<double>& values) {
  const bool empty = field.type.empty() && field.members.empty();
  const size_t count = field.counted ? cursor.count(empty ? UINT32_MAX : size) : field.count;
  if (empty) return;
  const RosDecoder decode = ros_decoder(field.type);
  for (size_t i = 0; i < count; ++i) {
    if (decode == nullptr) {
      for (const Field& member : field.members) read_field(member, cursor, size, values);
    } else {
      const double value = decode(cursor);
      if (field.slot) values[*field.slot + i] = value;
    }
  }
}

}  // namespace foucault::rawlog
