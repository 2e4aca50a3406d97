#include "foucault/diagnosis/fix_judge.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/median.h"
#include "foucault/core/time.h"

namespace foucault::diagnosis {
namespace {

/// After a hole the attitude may be off by tens of degrees, beyond what is linear: sigmas are then
/// too small for a while, and every fix is needed.
constexpr int64_t kGateOpenNs = 10 * kNanosecondsPerSecond;
/// Chosen: a new alignment and a bridged hole settle within a minute of fixes.
constexpr int64_t kStateDoubtedNs = 60 * kNanosecondsPerSecond;
/// By KITTI and rtk_car (0.62 m instead of 1.05 m RMS over splices; outliers of 16 cm stand out):
/// the median of 31 is known to a quarter, and fewer than half of them may be outliers.
constexpr std::size_t kLevelMemory = 31;  // fixes
constexpr std::size_t kLevelNeeds = 5;    // fixes; chosen: two of five may be outliers
/// Chosen: sigmas are too small in turns of a minute at most, and no fix counts for more than ten.
constexpr double kBelievedMemory = 60;  // fixes
constexpr double kLargestShare = 10;    // times the level
double chi_square_median(int dimension) {
  constexpr std::array<double, 4> kMedian{0, 0.455, 1.386, 2.366};
  return kMedian[static_cast<std::size_t>(dimension)];
}

}  // namespace

double mahalanobis_squared(const Eigen::Vector3d& value, const Eigen::Matrix3d& covariance) {
  return value.dot(Eigen::LLT<Eigen::Matrix3d>(covariance).solve(value));
}

double mahalanobis_squared(const state::Innovation& innovation) {
  return innovation.value.dot(innovation.covariance.llt().solve(innovation.value));
}

void FixJudge::start(int64_t t_ns) {
  squares_.clear();
  believed_level_ = 1;
  state_doubted_until_ns_ = t_ns + kStateDoubtedNs;
}

void FixJudge::doubt_state(int64_t t_ns) {
  state_doubted_until_ns_ = t_ns + kStateDoubtedNs;
  gate_open_until_ns_ = std::max(gate_open_until_ns_, t_ns + kGateOpenNs);
}

/// Two more dimensions than k make it larger by (x/2)^(k/2) exp(-x/2) / Gamma(k/2 + 1).
double chi_square_tail(double square, int dimension) {
  const double half = square / 2;
  const bool even = dimension % 2 == 0;
  double tail = even ? std::exp(-half) : std::erfc(std::sqrt(half));
  for (double k = even ? 2 : 1; k < dimension; k += 2)
    tail += std::pow(half, k / 2) * std::exp(-half) / std::tgamma(k / 2 + 1);
  return tail;
}

double FixJudge::level() const {
  double level = std::max(1.0, believed_level_);
  if (squares_.size() < kLevelNeeds) return level;
  const double middle = median(std::vector<double>(squares_.begin(), squares_.end()));
  return std::max(level, middle / chi_square_median(dimension_));
}

void FixJudge::remember(double square) {
  squares_.push_back(square);
  if (squares_.size() > kLevelMemory) squares_.pop_front();
}

bool FixJudge::passes(double square) const {
  return chi_square_tail(square / level(), dimension_) >= options_.gate_false_alarm;
}

bool FixJudge::believes(int64_t t_ns, const state::Innovation& innovation) {
  const double square = mahalanobis_squared(innovation);
  const bool passed = passes(square);
  remember(square);
  if (!passed) return gate_is_open(t_ns);
  const double share = std::min(square / dimension_, kLargestShare * level());
  believed_level_ += (share - believed_level_) / kBelievedMemory;
  return true;
}

}  // namespace foucault::diagnosis
