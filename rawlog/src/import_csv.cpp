#include "foucault/rawlog/import_csv.h"

#include <fmt/format.h>

#include "csv_readers.h"
#include "foucault/core/error.h"

namespace foucault::rawlog {

ImportSummary import_csv(const CsvImport& options) {
  const rawlog::MappingSource source{options.mapping, options.data_dir};
  ImportInputs inputs;
  const ImportMapping mapping =
      add_tables(source, {options.imu, options.reference, options.wheel}, inputs);
  const auto gnss = input_path(source, options.gnss, mapping.gnss.file);
  const bool imu = inputs.imu != nullptr;
  if (!imu || !gnss) {
    throw UsageError(fmt::format("'{}' names no {} file; add {}.file, or give it as an option",
                                 options.mapping, imu ? "GNSS" : "IMU", imu ? "gnss" : "imu"));
  }
  naming_mapping(options.mapping, [&] { inputs.gnss = make_gnss_reader(mapping.gnss, *gnss); });
  if (options.lever_arm) inputs.lever_arm_v = options.lever_arm;
  return rawlog::run_import(options, std::move(inputs));
}

}  // namespace foucault::rawlog
