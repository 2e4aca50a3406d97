#include "fuzzing.h"
#include "reading.h"

/// The bytes are a rawlog.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace foucault::fuzz;
  read_rawlog(folder().write("log", text_of(data, size)));
  return 0;
}
