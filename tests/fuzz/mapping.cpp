#include "foucault/core/config.h"
#include "foucault/rawlog/import_mapping.h"
#include "fuzzing.h"

/// A mapping. What was read and is written again reads as the same.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault;
  using namespace foucault::fuzz;
  rawlog::ImportMapping mapping;
  const std::string text(text_of(data, size));
  if (!contained([&] { load_config_text(text, "mapping.yaml", mapping); })) return 0;
  contained([&] { mapping.imu.mounting(); });
  const std::string dumped = dump_config(mapping);
  rawlog::ImportMapping again;
  load_config_text(dumped, "again", again);
  require(dump_config(again) == dumped, "a mapping that is written and read");
  return 0;
}
