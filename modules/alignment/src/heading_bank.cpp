#include "heading_bank.h"

#include <algorithm>
#include <cmath>

#include "foucault/core/so3.h"
#include "foucault/state/vehicle_attitude.h"

namespace foucault::alignment {
namespace {

constexpr double kImpossible = -25;  // log of the odds
constexpr double kSame = 0.3;        // sigmas apart
constexpr int kPruneEvery = 5;       // updates

}  // namespace

void HeadingBank::add(const state::Epoch& start, double log_prior) {
  hypotheses_.push_back({Trial(noise_, layout_, start), log_prior});
}

void HeadingBank::propagate(const ImuIncrement& increment) {
  for (Hypothesis& h : hypotheses_) h.trial.propagate(increment);
}

void HeadingBank::update(const GnssFix& fix) {
  for (Hypothesis& h : hypotheses_) h.trial.update(fix);
  if (++updates_ % kPruneEvery == 0) prune();
}

/// The likeliest first. All are measured by the level of that one.
std::vector<HeadingBank::Summary> HeadingBank::summaries(double& level) const {
  const auto misfit = [&](const Hypothesis& h, double at) {
    return h.trial.agreement().misfit(at) - 2 * h.log_prior;
  };
  const auto best = std::min_element(hypotheses_.begin(), hypotheses_.end(),
                                     [&](auto& a, auto& b) { return misfit(a, 1) < misfit(b, 1); });
  level = best->trial.level();
  std::vector<Summary> all;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    Summary s;
    s.epoch = hypotheses_[i].trial.epoch();
    const state::VehicleAttitude attitude = state::vehicle_attitude(s.epoch, mounting_);
    s.heading = attitude.euler.heading;
    s.variance = level * attitude.sigma.z() * attitude.sigma.z();
    s.log_weight = -0.5 * misfit(hypotheses_[i], level);
    s.index = i;
    all.push_back(s);
  }
  std::sort(all.begin(), all.end(), [](auto& a, auto& b) { return a.log_weight > b.log_weight; });
  for (std::size_t i = all.size(); i-- > 0;) all[i].log_weight -= all[0].log_weight;
  return all;
}

HeadingBelief HeadingBank::belief() const {
  HeadingBelief belief;
  const std::vector<Summary> all = summaries(belief.level);
  double weights = 0, mean = 0, square = 0;
  for (const Summary& s : all) {
    const double w = std::exp(s.log_weight), d = so3::wrap(s.heading - all[0].heading);
    weights += w;
    mean += w * d;
    square += w * (d * d + s.variance);
  }
  mean /= weights;
  belief.best = all[0].epoch;
  belief.settling = hypotheses_[all[0].index].trial.settling();
  belief.heading = so3::wrap(all[0].heading + mean);
  belief.sigma = std::sqrt(std::max(square / weights - mean * mean, all[0].variance));
  return belief;
}

std::vector<state::Epoch> HeadingBank::candidates() const {
  constexpr double kPossible = -14;  // log of the odds, one in a million
  double level = 1;
  std::vector<state::Epoch> candidates;
  for (const Summary& s : summaries(level)) {
    if (s.log_weight > kPossible) candidates.push_back(s.epoch);
  }
  return candidates;
}

void HeadingBank::prune() {
  if (hypotheses_.size() < 2) return;
  double level = 1;
  const std::vector<Summary> all = summaries(level);
  std::vector<Summary> kept;
  for (const Summary& s : all) {
    if (s.log_weight < kImpossible) continue;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const Summary& k) {
      const double d = so3::wrap(s.heading - k.heading);
      return d * d < kSame * kSame * std::min(s.variance, k.variance);
    });
    if (!known) kept.push_back(s);
  }
  std::sort(kept.begin(), kept.end(), [](auto& a, auto& b) { return a.index < b.index; });
  std::vector<Hypothesis> remaining;
  for (const Summary& s : kept) remaining.push_back(std::move(hypotheses_[s.index]));
  hypotheses_ = std::move(remaining);
}

}  // namespace foucault::alignment
