#include "foucault/rawlog/import_ulog.h"
#include "fuzzing.h"
#include "reading.h"

/// The bytes are a ULog.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault;
  using namespace foucault::fuzz;
  rawlog::UlogImport import;
  import.log = folder().write("log.ulg", text_of(data, size));
  import.out = folder() / "out.rawlog";
  import.lever_arm = Eigen::Vector3d::Zero();
  for (const bool skip_bad_rows : {false, true}) {
    import.skip_bad_rows = skip_bad_rows;
    if (contained([&] { rawlog::import_ulog(import); })) read_own_rawlog(import.out);
  }
  return 0;
}
