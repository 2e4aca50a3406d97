#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "foucault/core/measurement.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::exports {

/// The reference around the epochs as a TUM file in the frame and axes of solution.tum, whose
/// origin, the first epoch, a comment at its head names; poses without attitude have the identity,
/// and a comment says so. Poses wait for the origin in memory; without any there is no file.
class ReferenceTum {
 public:
  explicit ReferenceTum(std::filesystem::path path) : path_(std::move(path)) {}

  void add(const ReferencePose& pose);
  /// Epochs stand at fixes: the last pose before this and the first after it are kept.
  void fix();
  /// The first call counts.
  void origin(const Geodetic& place) {
    if (!origin_) origin_ = place;
  }
  /// Writes the file, if there is anything for it. Throws WriteError.
  void finish() const;

 private:
  void keep_last();

  std::filesystem::path path_;
  std::optional<Geodetic> origin_;
  std::vector<ReferencePose> poses_;
  std::optional<ReferencePose> last_;  ///< if it is not kept yet
  bool keeps_next_ = false;
};

}  // namespace foucault::exports
