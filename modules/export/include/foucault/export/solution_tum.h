#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "foucault/export/solution_file.h"
#include "foucault/export/text_file.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/state/interfaces.h"

namespace foucault::exports {

/// An epoch as a line of TUM's trajectory format, `timestamp x y z qx qy qz qw`, in MRPT's axes:
/// pose of the vehicle (forward-left-up, at the IMU centre) in the East-North-Up frame of `frame`'s
/// origin; stamp in UNIX seconds, lengths in metres.
std::string tum_row(const state::Epoch& epoch, const state::Mounting& mounting,
                    const geodesy::LocalFrame& frame);

/// The frame is that of the first epoch.
class SolutionTum : public SolutionFile {
 public:
  SolutionTum(const std::filesystem::path& path, const state::Mounting& mounting);

  void epoch(const state::Epoch& epoch) override;
  void finish() override { file_.close(); }

 private:
  state::Mounting mounting_;
  std::optional<geodesy::LocalFrame> frame_;
  TextFile file_;
};

}  // namespace foucault::exports
