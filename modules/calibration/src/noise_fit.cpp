#include "foucault/calibration/noise_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "foucault/ekf/ekf.h"
#include "foucault/imu/increments.h"
#include "foucault/measurement/gnss_position.h"

namespace foucault::calibration {
namespace {

/// Half of 15.1, which a chi-square of one degree of freedom exceeds once in ten thousand.
constexpr double kGain = 7.6;
constexpr double kCoarse = 4;
constexpr double kLargest = 1e4;  // factor
/// Half a second: the noise of a second is wanted, not the course of the covariance within it.
constexpr double kCovarianceStep = 0.5;

using Factors = std::array<double, 4>;

imu::ImuNoise times(imu::ImuNoise noise, const Factors& factors) {
  noise.accel_noise_density *= factors[0];
  noise.gyro_noise_density *= factors[1];
  noise.accel_bias_sigma *= factors[2];
  noise.gyro_bias_sigma *= factors[3];
  noise.accel_turn_on_sigma = std::max(noise.accel_turn_on_sigma, noise.accel_bias_sigma);
  noise.gyro_turn_on_sigma = std::max(noise.gyro_turn_on_sigma, noise.gyro_bias_sigma);
  return noise;
}

double log_density(const state::Innovation& z) {
  const Eigen::LLT<Eigen::Matrix3d> llt(z.covariance);
  const Eigen::Vector3d whitened = llt.matrixL().solve(Eigen::Vector3d(z.value));
  return -0.5 * whitened.squaredNorm() - llt.matrixLLT().diagonal().array().log().sum();
}

class Search {
 public:
  Search(const RecordedWay& way, const imu::ImuNoise& told, const state::Layout& layout)
      : way_(way), told_(told), layout_(layout) {
    factors_.fill(1);
    best_ = first_ = value(factors_);
  }

  void raise() {
    constexpr int kRounds = 2;
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t i = 0; i < factors_.size(); ++i) {
        while (factors_[i] < kLargest && better(i, kCoarse)) {
        }
        if (factors_[i] > 1 && !better(i, 0.5)) better(i, 2);
      }
    }
  }

  NoiseFit result() const { return {times(told_, factors_), best_ - first_, tried_}; }

 private:
  double value(const Factors& factors) {
    ++tried_;
    return log_likelihood(way_, times(told_, factors), layout_);
  }

  /// Goes there if it is.
  bool better(std::size_t i, double factor) {
    Factors next = factors_;
    next[i] *= factor;
    const double found = value(next);
    if (!(found > best_ + (factor > 1 ? kGain : 0))) return false;
    factors_ = next;
    best_ = found;
    return true;
  }

  const RecordedWay& way_;
  const imu::ImuNoise& told_;
  const state::Layout& layout_;
  Factors factors_;
  double best_ = 0, first_ = 0;
  int tried_ = 0;
};

}  // namespace

double log_likelihood(const RecordedWay& way, const imu::ImuNoise& noise,
                      const state::Layout& layout) {
  ekf::EkfOptions options;
  options.cov_interval_s = kCovarianceStep;
  ekf::EkfNavigator filter(noise, layout, options);
  filter.start(way.start);
  double sum = 0;
  auto fix = way.fixes.begin();
  for (ImuIncrement rest : way.increments) {
    for (; fix != way.fixes.end() && fix->t_ns <= rest.t_end_ns; ++fix) {
      if (fix->t_ns > rest.t_begin_ns && fix->t_ns < rest.t_end_ns) {
        const auto [until, after] = imu::split(rest, fix->t_ns);
        filter.propagate(until);
        rest = after;
      } else if (fix->t_ns == rest.t_end_ns && rest.dt() > 0) {
        filter.propagate(rest);
        rest.t_begin_ns = rest.t_end_ns;
      }
      const measurement::ObservationPtr position = measurement::gnss_position(*fix);
      sum += log_density(filter.innovation(*position));
      filter.update(position);
    }
    if (rest.dt() > 0) filter.propagate(rest);
  }
  return std::isfinite(sum) ? sum : -std::numeric_limits<double>::infinity();
}

NoiseFit raised_noise(const RecordedWay& way, const imu::ImuNoise& told,
                      const state::Layout& layout) {
  Search search(way, told, layout);
  search.raise();
  return search.result();
}

}  // namespace foucault::calibration
