#include "recording.h"

/// The bytes are a bag of ROS 1.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return foucault::fuzz::import_recording(data, size);
}
