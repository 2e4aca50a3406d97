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

/// White noise of accelerometers and gyroscopes, then their variations.
using Factors = std::array<double, 4>;
constexpr std::size_t kWhite = 2;

imu::ImuNoise raised(imu::ImuNoise noise, const Factors& factors) {
  noise.accel_noise_density *= factors[0];
  noise.gyro_noise_density *= factors[1];
  noise.accel_bias_sigma *= factors[2];
  noise.gyro_bias_sigma *= factors[3];
  noise.accel_turn_on_sigma = std::max(noise.accel_turn_on_sigma, noise.accel_bias_sigma);
  noise.gyro_turn_on_sigma = std::max(noise.gyro_turn_on_sigma, noise.gyro_bias_sigma);
  return noise;
}

double log_prior(const Factors& factors) {
  constexpr double kUsual = 1.386;  // log(4)
  double sum = 0;
  for (const double factor : factors) sum -= 0.5 * std::pow(std::log(factor) / kUsual, 2);
  return sum;
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
    while (steepest(kWhite)) {
    }
    while (steepest(factors_.size())) {
    }
    for (std::size_t i = 0; i < factors_.size(); ++i) {
      if (factors_[i] > 1 && !go_if_better(times(i, 0.5), 0)) go_if_better(times(i, 2), kGain);
    }
  }

  NoiseFit result() const { return {raised(told_, factors_), best_ - first_, tried_}; }

 private:
  double value(const Factors& factors) {
    ++tried_;
    return log_likelihood(way_, raised(told_, factors), layout_) + log_prior(factors);
  }

  Factors times(std::size_t i, double factor) const {
    Factors next = factors_;
    next[i] *= factor;
    return next;
  }

  struct Found {
    Factors at;
    double value;
  };

  /// To the best of the first axes, each gone along as far as it helps.
  bool steepest(std::size_t axes) {
    Found best{factors_, best_ + kGain};
    for (std::size_t i = 0; i < axes; ++i) {
      const Found found = best_along(i);
      if (found.value > best.value) best = found;
    }
    if (best.at == factors_) return false;
    factors_ = best.at;
    best_ = best.value;
    return true;
  }

  Found best_along(std::size_t i) {
    Found best{factors_, best_};
    for (double factor = kCoarse; factors_[i] * factor <= kLargest; factor *= kCoarse) {
      const Factors next = times(i, factor);
      const double found = value(next);
      if (!(found > best.value)) break;
      best = {next, found};
    }
    return best;
  }

  bool go_if_better(const Factors& next, double gain) {
    const double found = value(next);
    if (!(found > best_ + gain)) return false;
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
