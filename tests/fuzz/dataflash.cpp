#include "foucault/rawlog/import_dataflash.h"
#include "fuzzing.h"
#include "reading.h"

/// The bytes are a DataFlash log, binary or text.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault;
  using namespace foucault::fuzz;
  rawlog::DataflashImport import;
  import.log = folder().write("flight.bin", text_of(data, size));
  import.out = folder() / "out.rawlog";
  import.lever_arm = Eigen::Vector3d::Zero();
  for (const bool skip_bad_rows : {false, true}) {
    import.skip_bad_rows = skip_bad_rows;
    if (contained([&] { rawlog::import_dataflash(import); })) read_own_rawlog(import.out);
  }
  return 0;
}
