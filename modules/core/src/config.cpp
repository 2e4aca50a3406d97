#include "foucault/core/config.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <utility>

#include "foucault/core/edit_distance.h"
#include "foucault/core/error.h"

namespace foucault {
namespace {

std::string joined(std::string_view prefix, std::string_view key) {
  return prefix.empty() ? std::string(key) : fmt::format("{}.{}", prefix, key);
}

/// Short enough for a message.
std::string shortened(const std::string& text) {
  constexpr std::size_t kLongest = 60;
  return text.size() > kLongest ? text.substr(0, kLongest - 3) + "..." : text;
}

/// Messages are one line, whatever the input that they quote holds.
[[noreturn]] void refuse(std::string message) {
  for (char& c : message) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7F) c = ' ';
  }
  throw UsageError(message);
}

/// Lowest and highest second byte of a character: none that is longer than need be, no surrogate,
/// nothing beyond Unicode.
std::pair<unsigned char, unsigned char> second_bytes(unsigned char first) {
  switch (first) {
    case 0xE0:
      return {0xA0, 0xBF};
    case 0xED:
      return {0x80, 0x9F};
    case 0xF0:
      return {0x90, 0xBF};
    case 0xF4:
      return {0x80, 0x8F};
    default:
      return {0x80, 0xBF};
  }
}

/// How many bytes of UTF-8 the character at the front takes; 0 if it is none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  if (length == 0 || first > 0xF4 || text.size() < length) return 0;
  const auto [lowest, highest] = second_bytes(first);
  if (byte(1) < lowest || byte(1) > highest) return 0;
  for (std::size_t i = 2; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  return length;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

/// The part after the last dot.
std::string_view leaf(std::string_view key) { return key.substr(key.rfind('.') + 1); }

/// The nearest of `valid`: a key of the same name in another section comes before a similar one.
/// Of a key longer than any of ours the beginning decides, whatever has been taken for a key.
std::string nearest(std::string_view key, const std::vector<std::string>& valid) {
  constexpr std::size_t kLongest = 100;
  const std::string_view begin = key.substr(0, kLongest);
  const std::string* best = nullptr;
  std::pair<bool, std::size_t> least;
  for (const std::string& candidate : valid) {
    const std::pair<bool, std::size_t> cost{leaf(candidate) != leaf(key),
                                            edit_distance(candidate, begin)};
    if (best != nullptr && cost >= least) continue;
    best = &candidate;
    least = cost;
  }
  return best == nullptr ? std::string() : *best;
}

/// Collects the dotted names of all keys and sections.
class KeyCollector : public ConfigFields {
 public:
  static std::vector<std::string> keys_of(Configurable& target) {
    KeyCollector collector;
    target.fields(collector);
    return collector.keys_;
  }

  void number(std::string_view key, double&, Range, std::string_view) override { add(key); }
  void optional_number(std::string_view key, std::optional<double>&, Range,
                       std::string_view) override {
    add(key);
  }
  void integer(std::string_view key, int64_t&, Range, std::string_view) override { add(key); }
  void flag(std::string_view key, bool&, std::string_view) override { add(key); }
  void text(std::string_view key, std::string&, const std::vector<std::string>&,
            std::string_view) override {
    add(key);
  }
  void numbers(std::string_view key, std::vector<double>&, Range, std::string_view) override {
    add(key);
  }
  void vector3(std::string_view key, Eigen::Vector3d&, std::string_view) override { add(key); }
  void texts(std::string_view key, std::vector<std::string>&, std::string_view) override {
    add(key);
  }
  void text_map(std::string_view key, std::map<std::string, std::string>&,
                std::string_view) override {
    add(key);
  }
  void section(std::string_view key, Configurable& inner, std::string_view) override {
    add(key);
    const std::string outer = prefix_;
    prefix_ = joined(prefix_, key);
    inner.fields(*this);
    prefix_ = outer;
  }

 private:
  void add(std::string_view key) { keys_.push_back(joined(prefix_, key)); }

  std::string prefix_;
  std::vector<std::string> keys_;
};

/// What is the same for all sections of one input.
struct Input {
  std::string origin;                   ///< file name or option
  bool has_lines = true;                ///< marks of nodes are lines of `origin`
  std::vector<std::string> valid_keys;  ///< dotted

  [[noreturn]] void fail(const YAML::Node& node, std::string_view key,
                         std::string_view what) const {
    const YAML::Mark mark = node.Mark();
    const std::string place =
        has_lines && !mark.is_null() ? fmt::format("{}:{}", origin, mark.line + 1) : origin;
    const std::string name =
        key.empty() ? std::string() : fmt::format("{}: ", shortened(std::string(key)));
    refuse(fmt::format("{}: {}{}", place, name, what));
  }
};

/// What stands there, short enough for one line.
std::string shown(const YAML::Node& node) {
  if (node.IsNull()) return "nothing";
  if (node.IsMap()) return "a map";
  if (node.IsSequence()) return "a list";
  return fmt::format("'{}'", shortened(node.Scalar()));
}

std::string range_text(Range range) {
  if (range.min > 0 && range.min <= kPositive.min) {
    return std::isinf(range.max) ? "more than 0" : fmt::format("in (0, {}]", range.max);
  }
  if (std::isinf(range.max)) return fmt::format("at least {}", range.min);
  if (std::isinf(range.min)) return fmt::format("at most {}", range.max);
  return fmt::format("in [{}, {}]", range.min, range.max);
}

bool is_quoted(const YAML::Node& node) { return node.Tag() == "!"; }

bool is_null(const YAML::Node& node) {
  return node.IsNull() ||
         (node.IsScalar() && !is_quoted(node) && (node.Scalar() == "null" || node.Scalar() == "~"));
}

/// Reads all of a scalar as a number of type T; a leading '+' is allowed.
template <class T>
std::optional<T> parsed(const YAML::Node& node, std::errc& error) {
  if (!node.IsScalar() || is_quoted(node)) return std::nullopt;
  std::string_view text = node.Scalar();
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  T value{};
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  error = code;
  if (code == std::errc::invalid_argument || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool is_yaml_non_finite(const YAML::Node& node) {
  static const std::vector<std::string> names{".inf", "-.inf", "+.inf", ".nan",
                                              ".NaN", ".Inf",  "-.Inf", "+.Inf"};
  return node.IsScalar() && std::find(names.begin(), names.end(), node.Scalar()) != names.end();
}

/// Gives the values of one map to the fields of one Configurable.
class Reader : public ConfigFields {
 public:
  Reader(const Input& input, std::string prefix, const YAML::Node& map)
      : input_(input), prefix_(std::move(prefix)) {
    if (map.IsNull()) return;
    if (!map.IsMap()) {
      input_.fail(map, prefix_, fmt::format("expects keys with values, got {}", shown(map)));
    }
    for (const auto& entry : map) add_entry(entry.first, entry.second);
  }

  /// To be called after all fields: what is left is unknown.
  void finish() const {
    for (const Entry& entry : entries_) {
      if (!entry.used) fail_unknown(entry);
    }
  }

  void number(std::string_view key, double& value, Range range, std::string_view) override {
    if (const Entry* entry = take(key)) value = checked_number(entry->value, key, range);
  }

  void optional_number(std::string_view key, std::optional<double>& value, Range range,
                       std::string_view) override {
    const Entry* entry = take(key);
    if (!entry) return;
    if (is_null(entry->value)) {
      value.reset();
    } else {
      value = checked_number(entry->value, key, range);
    }
  }

  void integer(std::string_view key, int64_t& value, Range range, std::string_view) override {
    const Entry* entry = take(key);
    if (!entry) return;
    std::errc error{};
    const std::optional<int64_t> read = parsed<int64_t>(entry->value, error);
    if (!read) fail_type(entry->value, key, "a whole number");
    if (error == std::errc::result_out_of_range) {
      fail(entry->value, key, fmt::format("{} is too large", shown(entry->value)));
    }
    check_range(entry->value, key, static_cast<double>(*read), range);
    value = *read;
  }

  void flag(std::string_view key, bool& value, std::string_view) override {
    const Entry* entry = take(key);
    if (!entry) return;
    const bool plain = entry->value.IsScalar() && !is_quoted(entry->value);
    if (!plain || !YAML::convert<bool>::decode(entry->value, value)) {
      fail_type(entry->value, key, "true or false");
    }
  }

  void text(std::string_view key, std::string& value, const std::vector<std::string>& choices,
            std::string_view) override {
    const Entry* entry = take(key);
    if (!entry) return;
    const std::string read = checked_text(entry->value, key);
    if (!choices.empty() && std::find(choices.begin(), choices.end(), read) == choices.end()) {
      fail(entry->value, key,
           fmt::format("expects one of {}, got {}", fmt::join(choices, ", "), shown(entry->value)));
    }
    value = read;
  }

  void numbers(std::string_view key, std::vector<double>& value, Range range,
               std::string_view) override {
    const Entry* entry = take(key);
    if (!entry) return;
    if (!entry->value.IsSequence()) {
      fail_type(entry->value, key, "a list of numbers such as [0, 75]");
    }
    std::vector<double> read;
    for (const YAML::Node& item : entry->value) read.push_back(checked_number(item, key, range));
    value = read;
  }

  void vector3(std::string_view key, Eigen::Vector3d& value, std::string_view) override {
    const Entry* entry = take(key);
    if (!entry) return;
    if (!entry->value.IsSequence() || entry->value.size() != 3) {
      fail_type(entry->value, key, "a list of three numbers such as [0.1, 0, -1]");
    }
    for (int i = 0; i < 3; ++i) value[i] = checked_number(entry->value[i], key, Range{});
  }

  void texts(std::string_view key, std::vector<std::string>& value, std::string_view) override {
    const Entry* entry = take(key);
    if (!entry) return;
    if (!entry->value.IsSequence()) fail_type(entry->value, key, "a list of texts such as [a, b]");
    std::vector<std::string> read;
    for (const YAML::Node& item : entry->value) read.push_back(checked_text(item, key));
    value = read;
  }

  void text_map(std::string_view key, std::map<std::string, std::string>& value,
                std::string_view) override {
    const Entry* entry = take(key);
    if (!entry) return;
    if (!entry->value.IsMap()) {
      fail_type(entry->value, key, "a map of names to texts such as {a: b}");
    }
    std::map<std::string, std::string> read;
    if (!input_.has_lines) read = value;  // one assignment sets one name
    const Reader inner(input_, dotted(key), entry->value);
    for (const Entry& item : inner.entries_)
      read[item.key] = inner.checked_text(item.value, item.key);
    value = read;
  }

  void replaced(std::string_view key, std::string_view by) override {
    if (const Entry* entry = take(key))
      fail(entry->key_node, key, fmt::format("is set by {} now", by));
  }

  void section(std::string_view key, Configurable& inner, std::string_view) override {
    const Entry* entry = take(key);
    if (!entry) return;
    Reader reader(input_, dotted(key), entry->value);
    inner.fields(reader);
    reader.finish();
  }

 private:
  struct Entry {
    std::string key;
    YAML::Node key_node;
    YAML::Node value;
    bool used = false;
  };

  void add_entry(const YAML::Node& key, const YAML::Node& value) {
    if (!key.IsScalar()) {
      input_.fail(key, prefix_, fmt::format("a key must be a name, got {}", shown(key)));
    }
    check_utf8(key, prefix_);
    for (const Entry& entry : entries_) {
      if (entry.key == key.Scalar()) {
        fail(key, entry.key,
             fmt::format("is given twice, first in line {}; remove one",
                         entry.key_node.Mark().line + 1));
      }
    }
    entries_.push_back({key.Scalar(), key, value});
  }

  std::string dotted(std::string_view key) const { return joined(prefix_, key); }

  const Entry* take(std::string_view key) {
    for (Entry& entry : entries_) {
      if (entry.key != key) continue;
      entry.used = true;
      return &entry;
    }
    return nullptr;
  }

  [[noreturn]] void fail(const YAML::Node& node, std::string_view key,
                         std::string_view what) const {
    input_.fail(node, dotted(key), what);
  }

  [[noreturn]] void fail_type(const YAML::Node& node, std::string_view key,
                              std::string_view expected) const {
    const bool quoted_number = node.IsScalar() && is_quoted(node);
    fail(node, key,
         fmt::format("expects {}, got {}{}", expected, quoted_number ? "the text " : "",
                     shown(node)));
  }

  [[noreturn]] void fail_unknown(const Entry& entry) const {
    const std::string key = dotted(entry.key);
    const std::string suggestion = nearest(key, input_.valid_keys);
    fail(entry.key_node, entry.key,
         suggestion.empty() ? "is not a key; there are none here"
                            : fmt::format("is not a key; did you mean {}?", suggestion));
  }

  double checked_number(const YAML::Node& node, std::string_view key, Range range) const {
    std::errc error{};
    const std::optional<double> read = parsed<double>(node, error);
    if (is_yaml_non_finite(node) || (read && !std::isfinite(*read)) ||
        error == std::errc::result_out_of_range) {
      fail(node, key, fmt::format("expects a finite number, got {}", shown(node)));
    }
    if (!read) fail_type(node, key, "a number");
    check_range(node, key, *read, range);
    return *read;
  }

  void check_range(const YAML::Node& node, std::string_view key, double value, Range range) const {
    if (value >= range.min && value <= range.max) return;
    fail(node, key, fmt::format("must be {}, is {}", range_text(range), shortened(node.Scalar())));
  }

  std::string checked_text(const YAML::Node& node, std::string_view key) const {
    if (!node.IsScalar()) fail_type(node, key, "a text");
    check_utf8(node, dotted(key));
    return node.Scalar();
  }

  /// Other bytes would be written as something else, and not be the same when read again.
  void check_utf8(const YAML::Node& node, std::string_view name) const {
    if (!is_utf8(node.Scalar())) input_.fail(node, name, "is not UTF-8; save it in that encoding");
  }

  const Input& input_;
  std::string prefix_;
  std::vector<Entry> entries_;
};

void read(const Input& input, const YAML::Node& root, Configurable& target) {
  Reader reader(input, "", root);
  target.fields(reader);
  reader.finish();
}

/// Takes no notice of anything.
class NoEvents : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

/// Not with YAML::LoadAll: of "{a: b}\n, c" that makes documents until the memory is full.
bool goes_on_after_first_document(const std::string& yaml) {
  std::istringstream stream(yaml);
  YAML::Parser parser(stream);
  NoEvents events;
  return parser.HandleNextDocument(events) && parser.HandleNextDocument(events);
}

YAML::Node parse_yaml(const std::string& yaml, const std::string& origin) {
  try {
    if (goes_on_after_first_document(yaml)) {
      refuse(fmt::format("{}: holds more than one YAML document; keep one", origin));
    }
    return YAML::Load(yaml);
  } catch (const YAML::ParserException& e) {
    refuse(fmt::format("{}:{}: is not YAML: {}", origin, e.mark.line + 1, e.msg));
  }
}

std::string trimmed(const std::string& text) {
  constexpr const char* kBlanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

/// The value of an assignment. Lists, maps and quoted texts are YAML; all else stands for itself,
/// so that a path with a '#' or a ':' needs no second pair of quotes.
YAML::Node assigned_value(const std::string& text, const std::string& origin) {
  if (text.empty()) refuse(fmt::format("{}: has no value after '='", origin));
  const bool is_yaml = std::strchr("[{\"'", text.front()) != nullptr;
  if (is_yaml) return parse_yaml(text, origin);
  YAML::Node node(text);
  node.SetTag("?");
  return node;
}

/// {a: {b: value}} of "a.b".
YAML::Node nested(const std::string& dotted, const YAML::Node& value) {
  const std::size_t dot = dotted.find('.');
  const std::string head = dotted.substr(0, dot);
  YAML::Node map(YAML::NodeType::Map);
  map[head] = dot == std::string::npos ? value : nested(dotted.substr(dot + 1), value);
  return map;
}

}  // namespace

void load_config(const std::string& path, Configurable& target) {
  if (std::filesystem::is_directory(path)) {
    throw DataError(fmt::format("{}: is a directory, not a configuration file", path));
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw DataError(
        fmt::format("{}: cannot read the configuration: {}", path, std::strerror(errno)));
  }
  const std::string yaml{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  load_config_text(yaml, path, target);
}

void load_config_text(const std::string& yaml, const std::string& origin, Configurable& target) {
  const Input input{origin, true, KeyCollector::keys_of(target)};
  read(input, parse_yaml(yaml, origin), target);
}

void set_config(const std::string& assignment, Configurable& target) {
  const std::string origin = fmt::format("--set {}", assignment);
  const std::size_t equals = assignment.find('=');
  const std::string key = trimmed(assignment.substr(0, equals));
  if (equals == std::string::npos || key.empty()) {
    refuse(fmt::format("{}: expects key=value, such as fgo.window_s=20", origin));
  }
  const Input input{origin, false, KeyCollector::keys_of(target)};
  read(input, nested(key, assigned_value(trimmed(assignment.substr(equals + 1)), origin)), target);
}

}  // namespace foucault
