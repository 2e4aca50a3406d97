#pragma once

#include "foucault/state/interfaces.h"

namespace foucault::state {

/// A sink that is also told what the forward run of a smoother has.
class ForwardSink : public Sink {
 public:
  /// Where there will be an epoch(), as the run goes; that one comes later, of the same stamp.
  virtual void forward_epoch(const Epoch& epoch) = 0;
};

}  // namespace foucault::state
