#pragma once

#include "foucault/rawlog/import_bag.h"
#include "fuzzing.h"
#include "reading.h"

namespace foucault::fuzz {

/// The bytes are a recording of ROS.
inline int import_recording(const uint8_t* data, size_t size) {
  rawlog::BagImport import;
  import.bag = folder().write("recording", text_of(data, size));
  import.out = folder() / "out.rawlog";
  import.gnss_sigma = Eigen::Vector3d::Ones();
  for (const bool skip_bad_rows : {false, true}) {
    import.skip_bad_rows = skip_bad_rows;
    if (contained([&] { rawlog::import_bag(import); })) read_own_rawlog(import.out);
  }
  return 0;
}

}  // namespace foucault::fuzz
