#include "foucault/rawlog/import_csv.h"
#include "fuzzing.h"
#include "reading.h"

/// A mapping with its tables of IMU, GNSS, reference and wheel speeds.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault;
  using namespace foucault::fuzz;
  const std::vector<std::string_view> files = files_of(text_of(data, size), 5);
  rawlog::CsvImport import;
  import.mapping = folder().write("mapping.yaml", files[0]);
  import.imu = folder().write("imu.csv", files[1]);
  import.gnss = folder().write("gnss.csv", files[2]);
  if (!files[3].empty()) import.reference = folder().write("ref.csv", files[3]);
  if (!files[4].empty()) import.wheel = folder().write("wheel.csv", files[4]);
  import.out = folder() / "out.rawlog";
  for (const bool skip_bad_rows : {false, true}) {
    import.skip_bad_rows = skip_bad_rows;
    if (contained([&] { rawlog::import_csv(import); })) read_own_rawlog(import.out);
  }
  return 0;
}
