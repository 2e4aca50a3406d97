#pragma once

#include <optional>
#include <vector>

#include "foucault/state/epoch.h"
#include "foucault/state/interfaces.h"
#include "trial.h"

namespace foucault::alignment {

/// What the fixes so far say of the heading.
struct HeadingBelief {
  state::Epoch best;    ///< of the likeliest trial
  double heading = 0;   ///< of the vehicle, mean [rad]
  double sigma = 0;     ///< of all trials together [rad]
  double level = 1;     ///< see Trial
  double settling = 1;  ///< of the likeliest trial, see there
};

/// Filters that drive from states which differ in the heading, side by side, each of the width of
/// the gap between them: a sum of Gaussians. A wrong heading turns the accelerations that the
/// accelerometers feel away from those that the fixes make, whatever the vehicle and wherever it
/// goes: no assumption about its course is made. Those that have become unlikely (e^-25) go, and of
/// two that have come to say the same one stays.
/// Source of the idea: Alspach and Sorenson, IEEE Trans. Automatic Control 17 (1972), 439.
class HeadingBank {
 public:
  HeadingBank(const imu::ImuNoise& noise, const state::Layout& layout,
              const state::Mounting& mounting)
      : noise_(noise), layout_(layout), mounting_(mounting) {}

  /// log_prior: of its heading.
  void add(const state::Epoch& start, double log_prior);
  bool started() const { return !hypotheses_.empty(); }

  void propagate(const ImuIncrement& increment);
  void update(const GnssFix& fix);

  HeadingBelief belief() const;
  /// What the trials that may still be true have come to, the likeliest first.
  std::vector<state::Epoch> candidates() const;

 private:
  struct Hypothesis {
    Trial trial;
    double log_prior = 0;
  };
  struct Summary {
    state::Epoch epoch;
    double heading = 0, variance = 0;  ///< [rad], [rad^2]
    double log_weight = 0;             ///< against the best
    std::size_t index = 0;
  };

  std::vector<Summary> summaries(double& level) const;
  void prune();

  imu::ImuNoise noise_;
  state::Layout layout_;
  state::Mounting mounting_;
  std::vector<Hypothesis> hypotheses_;
  int updates_ = 0;
};

}  // namespace foucault::alignment
