#pragma once

#include <functional>
#include <utility>

#include "foucault/state/interfaces.h"

namespace foucault::state {

/// A sink of epochs alone, by a function.
class EpochSink : public Sink {
 public:
  explicit EpochSink(std::function<void(const Epoch&)> take) : take_(std::move(take)) {}
  void epoch(const Epoch& epoch) override { take_(epoch); }

 private:
  std::function<void(const Epoch&)> take_;
};

}  // namespace foucault::state
