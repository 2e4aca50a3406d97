#include "foucault/rawlog/import_bag.h"
#include "fuzzing.h"
#include "reading.h"

/// The bytes are a bag.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault;
  using namespace foucault::fuzz;
  rawlog::BagImport import;
  import.bag = folder().write("log.bag", text_of(data, size));
  import.out = folder() / "out.rawlog";
  import.gnss_sigma = Eigen::Vector3d::Ones();
  for (const bool skip_bad_rows : {false, true}) {
    import.skip_bad_rows = skip_bad_rows;
    if (contained([&] { rawlog::import_bag(import); })) read_own_rawlog(import.out);
  }
  return 0;
}
