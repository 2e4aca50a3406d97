#pragma once

#include <memory>
#include <optional>
#include <string>

#include "foucault/core/error.h"
#include "foucault/rawlog/import_mapping.h"
#include "import_run.h"

/// Readers of tables told by a mapping.
namespace foucault::rawlog {

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

/// Files of tables that are told on the command line, instead of the mapping's.
struct TableFiles {
  std::optional<std::string> imu, reference, wheel;
};

/// Tables of an IMU, a reference and wheel speeds, if there are any, and what a mapping says of
/// them; without a file of it (`source.mapping` empty) its defaults. Throws UsageError.
ImportMapping add_tables(const MappingSource& source, const TableFiles& given,
                         ImportInputs& inputs);

std::unique_ptr<RecordReader> make_imu_reader(const ImuMapping& mapping, const std::string& path);
std::unique_ptr<RecordReader> make_gnss_reader(const GnssMapping& mapping, const std::string& path);
std::unique_ptr<RecordReader> make_reference_reader(const ReferenceMapping& mapping,
                                                    const std::string& path);
std::unique_ptr<RecordReader> make_wheel_reader(const WheelMapping& mapping,
                                                const std::string& path);

/// Geoid separation to be added to heights [m]; 0 for ellipsoidal ones.
/// Throws UsageError if msl has none.
double height_offset(const std::string& height, const std::optional<double>& separation,
                     const std::string& section);

}  // namespace foucault::rawlog
