#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "foucault/core/config.h"

namespace foucault {
namespace {

/// Shortest decimal that reads back as the same double.
std::string number_text(double value) { return fmt::format("{}", value); }

std::string list_text(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number_text(value));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::vector<double> to_list(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Writes the fields as YAML.
class Dumper : public ConfigFields {
 public:
  explicit Dumper(YAML::Emitter& out) : out_(out) {}

  void number(std::string_view key, double& value, Range, std::string_view) override {
    pair(key, number_text(value));
  }
  void optional_number(std::string_view key, std::optional<double>& value, Range,
                       std::string_view) override {
    if (value) pair(key, number_text(*value));
  }
  void integer(std::string_view key, int64_t& value, Range, std::string_view) override {
    pair(key, fmt::format("{}", value));
  }
  void flag(std::string_view key, bool& value, std::string_view) override {
    pair(key, value ? "true" : "false");
  }
  void text(std::string_view key, std::string& value, const std::vector<std::string>&,
            std::string_view) override {
    name(key);
    quote(value);
  }
  void numbers(std::string_view key, std::vector<double>& value, Range, std::string_view) override {
    list(key, value);
  }
  void vector3(std::string_view key, Eigen::Vector3d& value, std::string_view) override {
    list(key, to_list(value));
  }
  void texts(std::string_view key, std::vector<std::string>& value, std::string_view) override {
    name(key);
    out_ << YAML::Flow << YAML::BeginSeq;
    for (const std::string& item : value) quote(item);
    out_ << YAML::EndSeq;
  }
  void text_map(std::string_view key, std::map<std::string, std::string>& value,
                std::string_view) override {
    name(key);
    out_ << YAML::BeginMap;
    for (const auto& [item_key, item] : value) {
      out_ << YAML::Key;
      quote(item_key);
      out_ << YAML::Value;
      quote(item);
    }
    out_ << YAML::EndMap;
  }
  void section(std::string_view key, Configurable& inner, std::string_view) override {
    name(key);
    out_ << YAML::BeginMap;
    inner.fields(*this);
    out_ << YAML::EndMap;
  }

 private:
  void name(std::string_view key) { out_ << YAML::Key << std::string(key) << YAML::Value; }
  void pair(std::string_view key, const std::string& value) {
    name(key);
    out_ << value;
  }
  void list(std::string_view key, const std::vector<double>& values) {
    name(key);
    out_ << YAML::Flow << YAML::BeginSeq;
    for (const double value : values) out_ << number_text(value);
    out_ << YAML::EndSeq;
  }
  /// Quoted unless it is a plain word that no YAML reader takes for something else.
  void quote(const std::string& text) {
    const bool plain = text.size() > 3 && text != "true" && text != "false" && text != "null" &&
                       std::all_of(text.begin(), text.end(),
                                   [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; });
    if (!plain) out_ << YAML::DoubleQuoted;
    out_ << text;
  }

  YAML::Emitter& out_;
};

std::string range_suffix(Range range) {
  const bool above_zero = range.min > 0 && range.min <= kPositive.min;
  if (std::isinf(range.min) && std::isinf(range.max)) return {};
  if (std::isinf(range.max)) {
    return above_zero ? " (> 0)" : fmt::format(" (>= {})", range.min);
  }
  if (std::isinf(range.min)) return fmt::format(" (<= {})", range.max);
  return fmt::format(" ({} {} to {})", above_zero ? "above" : "from", above_zero ? 0 : range.min,
                     range.max);
}

/// Collects one row a field.
class Describer : public ConfigFields {
 public:
  void number(std::string_view key, double& value, Range range, std::string_view help) override {
    row(key, number_text(value), std::string(help) + range_suffix(range));
  }
  void optional_number(std::string_view key, std::optional<double>& value, Range range,
                       std::string_view help) override {
    row(key, value ? number_text(*value) : "-", std::string(help) + range_suffix(range));
  }
  void integer(std::string_view key, int64_t& value, Range range, std::string_view help) override {
    row(key, fmt::format("{}", value), std::string(help) + range_suffix(range));
  }
  void flag(std::string_view key, bool& value, std::string_view help) override {
    row(key, value ? "true" : "false", std::string(help) + " (true, false)");
  }
  void text(std::string_view key, std::string& value, const std::vector<std::string>& choices,
            std::string_view help) override {
    const std::string suffix =
        choices.empty() ? std::string() : fmt::format(" ({})", fmt::join(choices, ", "));
    row(key, value.empty() ? "\"\"" : value, std::string(help) + suffix);
  }
  void numbers(std::string_view key, std::vector<double>& value, Range range,
               std::string_view help) override {
    row(key, list_text(value), std::string(help) + range_suffix(range));
  }
  void vector3(std::string_view key, Eigen::Vector3d& value, std::string_view help) override {
    row(key, list_text(to_list(value)), std::string(help));
  }
  void texts(std::string_view key, std::vector<std::string>& value,
             std::string_view help) override {
    row(key, fmt::format("[{}]", fmt::join(value, ", ")), std::string(help));
  }
  void text_map(std::string_view key, std::map<std::string, std::string>& value,
                std::string_view help) override {
    std::vector<std::string> items;
    for (const auto& [name, text] : value) items.push_back(fmt::format("{}: {}", name, text));
    row(key, fmt::format("{{{}}}", fmt::join(items, ", ")), std::string(help));
  }
  void section(std::string_view key, Configurable& inner, std::string_view help) override {
    row(key, "", std::string(help));
    const std::string outer = prefix_;
    prefix_ += std::string(key) + ".";
    inner.fields(*this);
    prefix_ = outer;
  }

  std::string table() const {
    std::size_t key_width = 0;
    std::size_t value_width = 0;
    for (const Row& r : rows_) {
      key_width = std::max(key_width, r.key.size());
      value_width = std::max(value_width, r.value.size());
    }
    std::string lines;
    for (const Row& r : rows_) {
      lines += fmt::format("{:<{}}  {:<{}}  {}\n", r.key, key_width, r.value, value_width, r.help);
    }
    return lines;
  }

 private:
  struct Row {
    std::string key;
    std::string value;
    std::string help;
  };

  void row(std::string_view key, std::string value, std::string help) {
    rows_.push_back({prefix_ + std::string(key), std::move(value), std::move(help)});
  }

  std::string prefix_;
  std::vector<Row> rows_;
};

}  // namespace

std::string dump_config(Configurable& target) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  Dumper dumper(out);
  target.fields(dumper);
  out << YAML::EndMap;
  return std::string(out.c_str()) + "\n";
}

std::string describe_config(Configurable& target) {
  Describer describer;
  target.fields(describer);
  return describer.table();
}

}  // namespace foucault
