#include "foucault/rawlog/import_rtklib.h"
#include "fuzzing.h"
#include "reading.h"

/// A solution file of RTKLIB, with an IMU that stays.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault;
  using namespace foucault::fuzz;
  static const std::string mapping = folder().write("mapping.yaml", R"(
imu:
  columns: {week: "1", time: "2", gyro_x: "3", gyro_y: "4", gyro_z: "5", accel_x: "6", accel_y: "7", accel_z: "8"}
  header: false
)");
  static const std::string imu = folder().write("imu.csv",
                                                "2200,100.00,0,0,0,0,0,-9.8\n"
                                                "2200,100.01,0,0,0,0,0,-9.8\n"
                                                "2200,100.02,0,0,0,0,0,-9.8\n");
  rawlog::RtklibImport import;
  import.mapping = mapping;
  import.imu = imu;
  import.gnss = folder().write("gnss.pos", text_of(data, size));
  import.lever_arm = Eigen::Vector3d(0.1, 0.2, 0.3);
  import.out = folder() / "out.rawlog";
  for (const bool skip_bad_rows : {false, true}) {
    import.skip_bad_rows = skip_bad_rows;
    if (contained([&] { rawlog::import_rtklib(import); })) read_own_rawlog(import.out);
  }
  return 0;
}
