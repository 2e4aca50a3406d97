#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "foucault/geodesy/local_frame.h"
#include "foucault/state/interfaces.h"
#include "text_file.h"
#include "track_kml.h"

namespace foucault::app {

/// An epoch in the units and axes of solution.csv: local NED of the vehicle's place, attitude of
/// the vehicle (forward-right-down).
std::string csv_row(const Epoch& epoch, const Mounting& mounting);
std::string csv_header();

/// An epoch as a line of TUM's trajectory format, `timestamp x y z qx qy qz qw`, in MRPT's axes:
/// pose of the vehicle (forward-left-up, at the IMU centre) in the East-North-Up frame of `frame`'s
/// origin; stamp in UNIX seconds, lengths in metres.
std::string tum_row(const Epoch& epoch, const Mounting& mounting, const LocalFrame& frame);

/// Streams the solution into solution.csv, solution.tum (frame: the first epoch) and solution.kml
/// of a folder. Throws DataError if they cannot be written.
class SolutionWriter : public Sink {
 public:
  SolutionWriter(const std::filesystem::path& folder, const Mounting& mounting);

  void epoch(const Epoch& epoch) override;

  /// Completes the files.
  void finish();

 private:
  Mounting mounting_;
  std::optional<LocalFrame> frame_;
  TextFile csv_;
  TextFile tum_;
  TrackKml kml_;
};

}  // namespace foucault::app
