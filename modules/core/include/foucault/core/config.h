#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Configuration: every module has plain option structs; each lists its fields once, in
/// `void fields(ConfigFields&)`, with key, unit in the key, range and a line of help. Reading YAML,
/// `--set key=value`, writing the effective configuration and the help text all walk that list.
namespace foucault {

/// Closed range of a number.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};
constexpr Range kPositive{std::numeric_limits<double>::min(),
                          std::numeric_limits<double>::infinity()};
constexpr Range kNotNegative{0, std::numeric_limits<double>::infinity()};

class ConfigFields;

/// Something with fields: an option struct or a root that joins several.
class Configurable {
 public:
  virtual ~Configurable() = default;
  virtual void fields(ConfigFields& f) = 0;
};

/// Visits the fields of a Configurable. Keys are snake_case; numbers are finite.
class ConfigFields {
 public:
  virtual ~ConfigFields() = default;
  virtual void number(std::string_view key, double& value, Range range, std::string_view help) = 0;
  /// `null` clears it.
  virtual void optional_number(std::string_view key, std::optional<double>& value, Range range,
                               std::string_view help) = 0;
  virtual void integer(std::string_view key, int64_t& value, Range range,
                       std::string_view help) = 0;
  virtual void flag(std::string_view key, bool& value, std::string_view help) = 0;
  /// `choices` empty: any text.
  virtual void text(std::string_view key, std::string& value,
                    const std::vector<std::string>& choices, std::string_view help) = 0;
  virtual void numbers(std::string_view key, std::vector<double>& value, Range range,
                       std::string_view help) = 0;
  virtual void vector3(std::string_view key, Eigen::Vector3d& value, std::string_view help) = 0;
  virtual void texts(std::string_view key, std::vector<std::string>& value,
                     std::string_view help) = 0;
  /// A free map of names to texts (e.g. the columns of a CSV mapping).
  virtual void text_map(std::string_view key, std::map<std::string, std::string>& value,
                        std::string_view help) = 0;
  /// A key that there was once, and the one to be set today.
  virtual void replaced(std::string_view /*key*/, std::string_view /*by*/) {}
  virtual void section(std::string_view key, Configurable& inner, std::string_view help) = 0;
};

/// Reads a YAML file into `target`; keys that are absent keep their value.
/// Throws DataError if the file cannot be read, UsageError for what is wrong in it, with file,
/// line, key and, for an unknown key, the nearest valid one.
void load_config(const std::string& path, Configurable& target);

/// The same from text; `origin` stands for the file name in messages.
void load_config_text(const std::string& yaml, const std::string& origin, Configurable& target);

/// Applies `a.b=value`. Lists, maps and quoted texts are read as YAML, all else as it stands; a map
/// is added to, name by name. Throws UsageError as load_config does.
void set_config(const std::string& assignment, Configurable& target);

/// The effective configuration as YAML; load_config_text of it gives the same values.
std::string dump_config(Configurable& target);

/// One line a key: dotted name, default, help with range or choices, in columns; for --help.
std::string describe_config(Configurable& target);

}  // namespace foucault
