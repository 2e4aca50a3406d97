#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/error.h"
#include "foucault/rawlog/import_mapping.h"
#include "import_run.h"
#include "text_table.h"

/// Readers of tables told by a mapping.
namespace foucault::rawlog {

/// Of the vertical speed where only the one along the ground is known [m/s].
inline constexpr double kOpenVerticalSigma = 10;

/// Where the roles of a mapping stand in the rows of its file.
class Columns {
 public:
  /// Reads the header, if there is one. `section` (imu, gnss, reference) is for messages.
  /// Throws UsageError for unknown roles and columns that are not there.
  Columns(const TableMapping& mapping, TextTable& table, const std::string& section,
          const std::vector<std::string>& roles);

  bool has(const std::string& role) const { return index_.count(role) > 0; }
  bool has_all(const std::vector<std::string>& roles) const;
  /// Throws UsageError if the mapping does not name the role.
  size_t of(const std::string& role) const;
  /// Throws RowError unless the row has as many columns as the header, or as the first row.
  void check_width(const Row& row);
  const std::string& section() const { return section_; }

 private:
  std::string section_;
  std::map<std::string, size_t> index_;
  size_t width_ = 0;
};

/// The time column of a row as a stamp, with the constant offset.
class TimeColumn {
 public:
  /// Throws UsageError if the mapping is incomplete.
  TimeColumn(const TimeMapping& mapping, const Columns& columns);

  int64_t stamp(const Row& row) const;

 private:
  size_t time_;
  std::optional<size_t> week_column_;
  int decimals_ = 9;
  bool gps_ = true;
  int64_t week_ = 0;
  int64_t origin_ns_ = 0;  ///< of the time column, in the GPS week or on the UNIX scale
  int64_t offset_ns_ = 0;
};

/// What a mapping file says, and where its files lie.
struct MappingSource {
  std::string mapping;  ///< YAML
  std::optional<std::string> data_dir;
};
ImportMapping load_mapping(const MappingSource& source);

/// Puts the name of its file before what `action` finds wrong in a mapping.
template <class Action>
void naming_mapping(const std::string& mapping, Action action) {
  try {
    action();
  } catch (const UsageError& error) {
    throw UsageError(mapping + ": " + error.what());
  }
}

/// `given` (of the command line) as it is, else `file` of the mapping, else none.
std::optional<std::string> input_path(const MappingSource& source,
                                      const std::optional<std::string>& given,
                                      const std::string& file);

std::unique_ptr<RecordReader> make_imu_reader(const ImuMapping& mapping, const std::string& path);
std::unique_ptr<RecordReader> make_gnss_reader(const GnssMapping& mapping, const std::string& path);
std::unique_ptr<RecordReader> make_reference_reader(const ReferenceMapping& mapping,
                                                    const std::string& path);

/// Geoid separation to be added to heights [m]; 0 for ellipsoidal ones.
/// Throws UsageError if msl has none.
double height_offset(const std::string& height, const std::optional<double>& separation,
                     const std::string& section);

}  // namespace foucault::rawlog
