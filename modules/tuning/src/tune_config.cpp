#include "foucault/tuning/tune_config.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "foucault/core/error.h"

namespace foucault::tuning {
namespace {

constexpr std::size_t kMostPoints = 1'000'000;

std::string read_file(const std::string& path) {
  if (std::filesystem::is_directory(path)) {
    throw DataError(fmt::format("{}: is a directory, not a grid file", path));
  }
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file) {
    throw DataError(fmt::format("{}: cannot read the grid: {}", path, std::strerror(errno)));
  }
  constexpr const char* kByteOrderMark = "\xef\xbb\xbf";
  return text.compare(0, 3, kByteOrderMark) == 0 ? text.substr(3) : text;
}

/// The file of a search. Its parts are read each in its own way, but with the file's line numbers
/// in messages: what does not belong to a part is blanked out.
class TuneFile {
 public:
  TuneFile(std::string yaml, std::string origin)
      : yaml_(std::move(yaml)), origin_(std::move(origin)) {
    try {
      root_ = YAML::Load(yaml_);
    } catch (const YAML::ParserException& e) {
      throw UsageError(fmt::format("{}:{}: is not YAML: {}", origin_, e.mark.line + 1, e.msg));
    }
    if (!root_.IsMap() || root_.Style() == YAML::EmitterStyle::Flow) {
      throw UsageError(fmt::format(
          "{}: expects lines 'base:', 'grid:', 'methods:', ... with values, without braces around "
          "them all",
          origin_));
    }
    for (const auto& entry : root_) {
      const auto first = find(entry.first.Scalar());
      if (first != parts_.end()) {
        fail(entry.first, fmt::format("{}: is given twice, first in line {}; remove one",
                                      entry.first.Scalar(), first->key.Mark().line + 1));
      }
      parts_.push_back({entry.first, entry.second});
    }
  }

  [[noreturn]] void fail(const YAML::Node& node, const std::string& what) const {
    throw UsageError(fmt::format("{}:{}: {}", origin_, node.Mark().line + 1, what));
  }

  const std::string& origin() const { return origin_; }

  std::optional<YAML::Node> value(const std::string& key) const {
    const auto found = find(key);
    if (found == parts_.end() || found->value.IsNull()) return std::nullopt;
    return found->value;
  }

  /// The value of a key at the place where it stands, and blanks.
  std::string only(const std::string& key) const {
    const auto found = find(key);
    if (found == parts_.end() || found->value.IsNull()) return "";
    return blanked(0, position(found->value)) +
           yaml_.substr(position(found->value), end_of(found) - position(found->value));
  }

  /// All but the values of these keys.
  std::string without(const std::vector<std::string>& keys) const {
    std::string text = yaml_;
    for (const std::string& key : keys) {
      const auto found = find(key);
      if (found == parts_.end()) continue;
      const std::size_t begin = position(found->key);
      text.replace(begin, end_of(found) - begin, blanked(begin, end_of(found)));
    }
    return text;
  }

 private:
  struct Part {
    YAML::Node key;
    YAML::Node value;
  };
  using Found = std::vector<Part>::const_iterator;

  static std::size_t position(const YAML::Node& node) {
    return static_cast<std::size_t>(node.Mark().pos);
  }

  Found find(const std::string& key) const {
    return std::find_if(parts_.begin(), parts_.end(),
                        [&](const Part& part) { return part.key.Scalar() == key; });
  }

  std::size_t end_of(Found part) const {
    const auto next = std::next(part);
    return next == parts_.end() ? yaml_.size() : position(next->key);
  }

  std::string blanked(std::size_t begin, std::size_t end) const {
    std::string text = yaml_.substr(begin, end - begin);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c != '\n'; }, ' ');
    return text;
  }

  std::string yaml_;
  std::string origin_;
  YAML::Node root_;
  std::vector<Part> parts_;
};

std::optional<double> number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

std::string value_text(const TuneFile& file, const YAML::Node& node) {
  if (node.IsScalar()) return node.Scalar();
  if (!node.IsSequence()) file.fail(node, "grid: expects values, not a map or nothing");
  YAML::Emitter out;
  out << YAML::Flow << node;
  return out.c_str();
}

/// `{from: 1, to: 100, steps: 7, scale: log}`.
class Span {
 public:
  Span(const TuneFile& file, const YAML::Node& map) {
    for (const auto& entry : map) {
      const std::string key = entry.first.Scalar();
      if (key == "from") {
        from_ = finite(file, entry.second);
      } else if (key == "to") {
        to_ = finite(file, entry.second);
      } else if (key == "steps") {
        steps_ = finite(file, entry.second);
      } else if (key == "scale") {
        scale_ = entry.second.IsScalar() ? entry.second.Scalar() : "";
      } else {
        file.fail(entry.first, fmt::format("grid: '{}' is none of from, to, steps, scale", key));
      }
    }
    check(file, map);
  }

  /// Evenly spaced, six significant digits.
  std::vector<std::string> values() const {
    std::vector<std::string> values;
    const int last = static_cast<int>(*steps_) - 1;
    for (int i = 0; i <= last; ++i) {
      const double s = static_cast<double>(i) / last;
      const double value =
          scale_ == "log" ? *from_ * std::pow(*to_ / *from_, s) : *from_ + s * (*to_ - *from_);
      values.push_back(fmt::format("{:.6g}", value));
    }
    return values;
  }

 private:
  static double finite(const TuneFile& file, const YAML::Node& node) {
    const std::optional<double> value = node.IsScalar() ? number(node.Scalar()) : std::nullopt;
    if (!value) file.fail(node, "grid: from, to and steps are numbers");
    return *value;
  }

  void check(const TuneFile& file, const YAML::Node& map) const {
    if (!from_ || !to_ || !steps_) file.fail(map, "grid: give all of from, to, steps");
    if (*steps_ < 2 || *steps_ > 10'000 || *steps_ != std::floor(*steps_)) {
      file.fail(map, "grid: steps is a whole number from 2 to 10000");
    }
    if (scale_ != "linear" && scale_ != "log") file.fail(map, "grid: scale is linear or log");
    if (scale_ == "log" && (*from_ <= 0 || *to_ <= 0)) {
      file.fail(map, "grid: scale log needs from and to above 0");
    }
  }

  std::optional<double> from_, to_, steps_;
  std::string scale_ = "linear";
};

std::vector<std::string> axis_values(const TuneFile& file, const YAML::Node& node) {
  if (node.IsMap()) return Span(file, node).values();
  if (!node.IsSequence() || node.size() == 0) {
    file.fail(node, "grid: expects a list of values, or {from: , to: , steps: , scale: log}");
  }
  std::vector<std::string> values;
  for (const YAML::Node& value : node) values.push_back(value_text(file, value));
  return values;
}

/// Numbers ascending; names as they are listed.
GridAxis read_axis(const TuneFile& file, const YAML::Node& key, const YAML::Node& node) {
  GridAxis axis{key.Scalar(), axis_values(file, node), true};
  axis.ordered = std::all_of(axis.values.begin(), axis.values.end(),
                             [](const std::string& value) { return number(value).has_value(); });
  if (axis.ordered) {
    std::sort(axis.values.begin(), axis.values.end(),
              [](const auto& a, const auto& b) { return *number(a) < *number(b); });
  }
  if (std::set<std::string>(axis.values.begin(), axis.values.end()).size() != axis.values.size()) {
    file.fail(node, fmt::format("grid: {}: a value is given twice", axis.key));
  }
  return axis;
}

/// Tries each value on the base.
void check_axis(const TuneFile& file, const YAML::Node& key, const GridAxis& axis,
                const Tunable& tunable) {
  if (axis.key.rfind("outages.", 0) == 0) {
    file.fail(key, "grid: the outages are the same for all points; set them under base");
  }
  for (const std::string& value : axis.values) {
    const std::string assignment = axis.key + "=" + value;
    try {
      tunable.try_on(assignment);
    } catch (const UsageError& error) {
      std::string message = error.what();
      const std::string prefix = fmt::format("--set {}: ", assignment);
      if (message.compare(0, prefix.size(), prefix) == 0) message.erase(0, prefix.size());
      file.fail(key, "grid: " + message);
    }
  }
}

ParameterGrid read_grid(const TuneFile& file, const Tunable& tunable) {
  const std::optional<YAML::Node> node = file.value("grid");
  if (!node || !node->IsMap() || node->size() == 0) {
    throw UsageError(fmt::format(
        "{}: has no grid; give one, such as 'grid: {{imu.arw_deg_sqrt_h: [0.05, 0.1, 0.2]}}'",
        file.origin()));
  }
  ParameterGrid grid;
  std::set<std::string> keys;
  for (const auto& entry : *node) {
    GridAxis axis = read_axis(file, entry.first, entry.second);
    if (!keys.insert(axis.key).second) file.fail(entry.first, "grid: a key is given twice");
    check_axis(file, entry.first, axis, tunable);
    grid.axes.push_back(std::move(axis));
    if (grid.size() > kMostPoints) {
      file.fail(*node, fmt::format("grid: has more than {} points; leave some out", kMostPoints));
    }
  }
  return grid;
}

/// Of either key.
std::vector<std::string> methods_of(const TuneOptions& options, const Tunable& tunable) {
  std::vector<std::string> names = options.methods;
  if (!options.method.empty()) names.insert(names.begin(), options.method);
  if (names.empty()) {
    throw UsageError(
        fmt::format("names no method; add 'method: rough' (of {})", tunable.method_names));
  }
  std::set<std::string> seen;
  for (const std::string& name : names) {
    tunable.check_method(name);
    if (!seen.insert(name).second)
      throw UsageError(fmt::format("method '{}' is given twice", name));
  }
  return names;
}

}  // namespace

void TuneOptions::fields(ConfigFields& f) {
  f.text("method", method, {}, "method to tune");
  f.texts("methods", methods, "methods to tune, each by itself");
  f.text("objective", objective, {"horizontal", "vertical", "weighted"},
         "which RMS of the per-outage maximum drift is to be small");
  f.number("vertical_weight", vertical_weight, kNotNegative,
           "weighted: horizontal + vertical_weight * vertical");
  f.text("search", search, {"full", "coarse_to_fine"},
         "every point, or coarse steps first, then fine ones around the best");
}

double TuneOptions::objective_of(double horizontal_rms, double vertical_rms) const {
  if (objective == "horizontal") return horizontal_rms;
  if (objective == "vertical") return vertical_rms;
  return horizontal_rms + vertical_weight * vertical_rms;
}

std::string TuneOptions::objective_name() const {
  if (objective != "weighted") return fmt::format("RMS {} drift", objective);
  return fmt::format("RMS drift, horizontal + {} vertical", vertical_weight);
}

std::vector<std::string> TuneConfig::values(const GridPoint& point) const {
  std::vector<std::string> values;
  for (std::size_t a = 0; a < point.size(); ++a) values.push_back(grid.axes[a].values[point[a]]);
  return values;
}

std::vector<std::string> TuneConfig::assignments(const GridPoint& point) const {
  std::vector<std::string> assignments = values(point);
  for (std::size_t a = 0; a < point.size(); ++a) {
    assignments[a].insert(0, grid.axes[a].key + "=");
  }
  return assignments;
}

TuneConfig load_tune_config_text(const std::string& yaml, const std::string& origin,
                                 const std::vector<std::string>& assignments,
                                 const Tunable& tunable) {
  const TuneFile file(yaml, origin);
  TuneConfig config;
  load_config_text(file.without({"base", "grid"}), origin, config.options);
  load_config_text(file.only("base"), origin, tunable.base);
  for (const std::string& assignment : assignments) set_config(assignment, tunable.base);
  config.grid = read_grid(file, tunable);
  try {
    config.methods = methods_of(config.options, tunable);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{}: {}", origin, error.what()));
  }
  return config;
}

TuneConfig load_tune_config(const std::string& path, const std::vector<std::string>& assignments,
                            const Tunable& tunable) {
  return load_tune_config_text(read_file(path), path, assignments, tunable);
}

}  // namespace foucault::tuning
