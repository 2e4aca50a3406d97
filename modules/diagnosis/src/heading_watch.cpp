#include "foucault/diagnosis/heading_watch.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "foucault/core/median.h"
#include "foucault/core/so3.h"
#include "lasting_noise.h"

namespace foucault::diagnosis {
namespace {

constexpr std::size_t kHeadingMemory = 120, kLeastHeadings = 30;

}  // namespace

bool HeadingFindings::contradicts() const {
  constexpr double kSigmas = 3;
  return std::abs(offset) > kSigmas * state_sigma + least_sigma;
}

/// About the first, so that differences near half a turn do not fall apart.
void HeadingWatch::add(double difference, double variance) {
  constexpr double kUncertain = 2;  // sigmas of a variance
  samples_.push_back({difference, variance});
  if (samples_.size() > kHeadingMemory) samples_.pop_front();
  if (samples_.size() < kLeastHeadings) return;
  const double first = samples_.front().difference;
  std::vector<double> differences, variances;
  for (const Sample& sample : samples_) {
    differences.push_back(so3::wrap(sample.difference - first));
    variances.push_back(sample.variance);
  }
  const double middle = median(differences);
  for (double& d : differences) d -= middle;
  const LastingNoise noise = lasting_noise(differences);
  const double beyond_doubt = std::max(0.0, noise.variance - kUncertain * noise.variance_sigma);
  found_ = HeadingFindings{so3::wrap(first + middle), std::sqrt(median(variances)),
                           std::sqrt(beyond_doubt * noise.factor)};
}

}  // namespace foucault::diagnosis
