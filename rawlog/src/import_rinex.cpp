#include "csv_readers.h"
#include "pos_reader.h"
#include "raw_gnss.h"
#include "rtklib_run.h"

namespace foucault::rawlog {

namespace {

/// Of the work, what RTKLIB does.
constexpr double kRtklibPart = 0.9;

}  // namespace

ImportSummary import_raw_observations(const RawGnssImport& options, ImportInputs inputs,
                                      const ImportMapping& mapping) {
  const auto progress = [&](double part) {
    if (options.progress) options.progress(part);
  };
  const ScratchFolder folder;
  const RtklibSolution solution =
      solve_with_rtklib(options, folder, [&](double part) { progress(kRtklibPart * part); });
  inputs.gnss = make_pos_reader(mapping.gnss, solution.pos);
  ImportOptions rest = options;
  rest.progress = [&](double part) { progress(kRtklibPart + (1 - kRtklibPart) * part); };
  ImportSummary summary = run_import(rest, std::move(inputs));
  summary.gnss.file = options.rover;
  std::vector<std::string>& notices = summary.gnss.notices;
  notices.insert(notices.end(), solution.notices.begin(), solution.notices.end());
  return summary;
}

ImportSummary import_rinex(const RawGnssImport& options) {
  ImportInputs inputs;
  const ImportMapping mapping = add_tables({options.mapping, options.data_dir},
                                           {options.imu, options.reference, options.wheel}, inputs);
  if (options.lever_arm) inputs.lever_arm_v = options.lever_arm;
  return import_raw_observations(options, std::move(inputs), mapping);
}

}  // namespace foucault::rawlog
