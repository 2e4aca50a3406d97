#include "foucault/rawlog/import_i2nav.h"
#include "fuzzing.h"
#include "reading.h"

/// IMU, GNSS, reference and wheel speeds of an i2Nav recording.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault;
  using namespace foucault::fuzz;
  const std::vector<std::string_view> files = files_of(text_of(data, size), 4);
  rawlog::I2navImport import;
  import.imu = folder().write("imu.txt", files[0]);
  import.gnss = folder().write("gnss.pos", files[1]);
  if (!files[2].empty()) import.reference = folder().write("truth.nav", files[2]);
  if (files[2].empty()) import.gps_week = 2200;
  if (!files[3].empty()) import.wheel = folder().write("wheel.csv", files[3]);
  import.out = folder() / "out.rawlog";
  for (const bool skip_bad_rows : {false, true}) {
    import.skip_bad_rows = skip_bad_rows;
    if (contained([&] { rawlog::import_i2nav(import); })) read_own_rawlog(import.out);
  }
  return 0;
}
