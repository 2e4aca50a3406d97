#pragma once

#include "foucault/state/result.h"

namespace foucault::exports {

/// A solution in one file format, streamed. A format is a class of this kind and a line in
/// solution_writer.cpp.
class SolutionFile {
 public:
  virtual ~SolutionFile() = default;
  virtual void epoch(const state::Epoch& epoch) = 0;
  /// Completes the file.
  virtual void finish() = 0;
};

}  // namespace foucault::exports
