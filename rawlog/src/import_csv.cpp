#include "foucault/rawlog/import_csv.h"

#include <fmt/format.h>

#include "csv_readers.h"
#include "foucault/core/error.h"

namespace foucault::rawlog {

ImportSummary import_csv(const CsvImport& options) {
  const rawlog::MappingSource source{options.mapping, options.data_dir};
  const ImportMapping mapping = rawlog::load_mapping(source);
  const auto imu = rawlog::input_path(source, options.imu, mapping.imu.file);
  const auto gnss = rawlog::input_path(source, options.gnss, mapping.gnss.file);
  const auto reference = rawlog::input_path(source, options.reference, mapping.reference.file);
  if (!imu || !gnss) {
    throw UsageError(fmt::format("'{}' names no {} file; add {}.file, or give it as an option",
                                 options.mapping, imu ? "GNSS" : "IMU", imu ? "gnss" : "imu"));
  }
  rawlog::ImportInputs inputs;
  rawlog::naming_mapping(options.mapping, [&] {
    inputs.imu = rawlog::make_imu_reader(mapping.imu, *imu);
    inputs.gnss = rawlog::make_gnss_reader(mapping.gnss, *gnss);
    if (reference) inputs.reference = rawlog::make_reference_reader(mapping.reference, *reference);
    inputs.mounting = mapping.imu.mounting();
  });
  inputs.mapping = options.mapping;
  inputs.lever_arm_v = options.lever_arm ? options.lever_arm : mapping.lever_arm();
  inputs.sensor = mapping.imu.sensor;
  return rawlog::run_import(options, std::move(inputs));
}

}  // namespace foucault::rawlog
