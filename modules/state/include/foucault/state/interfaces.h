#pragma once

#include <cstddef>
#include <optional>

#include "foucault/core/measurement.h"
#include "foucault/state/layout.h"
#include "foucault/state/result.h"

/// The three roles data walks through: Source -> Estimator -> Sink. Each streams: memory does not
/// grow with the length of a log.
namespace foucault::state {

/// How the IMU sits in the vehicle.
struct Mounting {
  Eigen::Quaterniond q_v_b = Eigen::Quaterniond::Identity();  ///< b to forward-right-down
  /// block::mounting of what is estimated, which corrects that; none: as it was told.
  std::optional<SlowBlock> estimated = std::nullopt;

  Mounting with(const Layout& layout) const {
    const SlowBlock* block = layout.find(block::mounting);
    return {q_v_b, block ? std::optional<SlowBlock>(*block) : std::nullopt};
  }
};

/// Time-ordered measurements (order: see Measurement).
/// next() throws DataError on damaged or inconsistent input.
class Source {
 public:
  virtual ~Source() = default;
  virtual std::optional<Measurement> next() = 0;
  /// Known from construction on.
  virtual const Mounting& mounting() const = 0;
  /// How much of the input has been read, 0 to 1; for progress.
  virtual double progress() const = 0;
};

/// Takes what an estimator gives out. Calls come in order of stamps.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual void epoch(const Epoch&) {}
  virtual void fix(const FixResult&) {}
  /// Of all measurements but positions.
  virtual void observation(const ObservationResult&) {}
  virtual void notice(const Notice&) {}
  /// Predictions cost time and come only if they are wanted, from the beginning on.
  virtual bool wants_predictions() const { return false; }
  virtual void prediction(const PredictionResult&) {}
  /// Before each measurement that was held back, as before an alignment, with how many wait behind
  /// it: for progress. What this throws ends the run.
  virtual void catching_up(std::size_t /*left*/) {}
  /// What seems wrong with the recording; at the end, after everything else.
  virtual void warning(const Notice&) {}
};

/// Turns measurements into epochs, which go to the sink it was built with.
class Estimator {
 public:
  virtual ~Estimator() = default;
  virtual void process(const Measurement& measurement) = 0;
  /// The stream is over: give out what is still held back.
  virtual void finish() = 0;
};

}  // namespace foucault::state
