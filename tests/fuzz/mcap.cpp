#include "recording.h"

/// The bytes are MCAP, with messages of ROS 1 and 2.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return foucault::fuzz::import_recording(data, size);
}
