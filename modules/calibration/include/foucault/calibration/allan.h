#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

/// Noise of sensors at rest, by averaging time.
namespace foucault::calibration {

/// Rates of the gyroscopes [rad/s], specific force [m/s^2].
using SixAxes = Eigen::Matrix<double, 6, 1>;

/// Allan variance of one averaging time.
struct AllanPoint {
  int64_t samples = 0;  ///< averaged
  double tau_s = 0;
  SixAxes variance = SixAxes::Zero();
};

struct AllanCurve {
  double interval_s = 0;           ///< from sample to sample
  std::vector<int64_t> pieces;     ///< samples of each stretch without a hole
  std::vector<AllanPoint> points;  ///< four an octave

  double length_s() const;
  double longest_s() const;
};

/// Overlapping Allan variance of samples at rest, all stretches together, each by the number of its
/// differences:
///   sigma^2(tau) = <(x(t + 2 tau) - 2 x(t + tau) + x(t))^2> / (2 tau^2),  x the integral of a
///   rate.
/// Averages of up to 27 samples begin at each sample, longer ones at each sixteenth of their length
/// or less: what lies between is known from its neighbours. Memory is constant.
/// Samples are taken as they were recorded. Whether one is the mean over its interval or the value
/// at its stamp makes no difference here: sums of either have the noise that the increments of the
/// program have.
class AllanDeviation {
 public:
  explicit AllanDeviation(double interval_s);

  void add(const SixAxes& sample);
  /// What comes next does not follow on what came before.
  void interrupt();
  AllanCurve curve() const;

 private:
  static constexpr std::size_t kRing = 64;
  struct Sum {
    SixAxes squares = SixAxes::Zero();
    int64_t count = 0;
  };
  /// Integrals at each 2^k-th sample; the ring holds two of the longest multiples and one more.
  struct Level {
    std::array<SixAxes, kRing> ring;
    std::size_t filled = 0;  ///< since the last interruption
    std::vector<Sum> sums;   ///< by multiples()
  };
  static const std::vector<std::size_t>& multiples(std::size_t level);
  void push(std::size_t level);

  double interval_s_;
  SixAxes first_ = SixAxes::Zero();  ///< of the stretch, so that integrals stay small
  SixAxes integral_ = SixAxes::Zero();
  int64_t samples_ = 0;  ///< of the stretch
  std::vector<int64_t> pieces_;
  std::vector<Level> levels_;
};

/// A coefficient, if the curve shows its slope.
struct AllanCoefficient {
  double value = 0;
  double log_sigma = 0;  ///< of its logarithm
};

/// sigma^2(tau) = N^2 / tau + (2 ln 2 / pi) B^2 + K^2 tau / 3: slopes -1/2, 0, +1/2 of the
/// deviation. Units, of a sensor with unit U: N U sqrt(s), which is U / sqrt(Hz); B U;
/// K U / sqrt(s).
///
/// How this meets the program's model, a first-order Gauss-Markov process of steady-state sigma s
/// and correlation time T (imu.gyro_bias_deg_h, imu.bias_tau_s): far below T it is a random walk of
/// K^2 = 2 s^2 / T. K is fitted with that process of the T that is told, which bends
/// the last slope from T / 4 on (to a top of 0.618 s at 1.89 T), so that s = K sqrt(T / 2) is what
/// the configuration wants whatever T it has. A bias instability B is flat at 0.664 B over decades,
/// which one process is not: its top is flat over an octave to either side. Where the curve is
/// flat at tau, s = 1.07 B with T = tau / 1.89 has its top there.
struct AllanFit {
  std::optional<AllanCoefficient> white;    ///< N, random walk of the integral
  std::optional<AllanCoefficient> flicker;  ///< B, bias instability
  std::optional<AllanCoefficient> walk;     ///< K, rate random walk
  double bias_tau_s = 0;                    ///< T
  double from_s = 0, to_s = 0;              ///< averaging times that the fit is of

  double deviation(double tau_s) const;
};

/// Of some axes together: mean of their variances. By least squares of the logarithm to first
/// order, errors relative to the model and weighted by degrees of freedom, until it stays: the
/// logarithm itself of an estimate of few degrees of freedom is skew and biased. Sigmas are with
/// the correlation of estimates that share frequencies. Of N, B and K those are told without which
/// the curve would be far less likely (as chi-square, 9 for each) and that come out to a third. No
/// sensor follows these lines to better than 2 %: that much is added, and more where they do not
/// fit. Averaging times are octaves from the shortest at which the lines fit (filters and vibration
/// lie below), four seconds at most, to a third of the longest stretch.
AllanFit fit(const AllanCurve& curve, const std::vector<int>& axes, double bias_tau_s);

/// Variance of `axes`, their mean.
double variance_of(const AllanPoint& point, const std::vector<int>& axes);

/// Equivalent degrees of freedom of the estimate at `samples` averaged, for the noise of the fit:
/// of white, flicker and random walk by Riley, Handbook of Frequency Stability Analysis (NIST SP
/// 1065), 5.4; the sum over stretches and axes.
double degrees_of_freedom(const AllanCurve& curve, int64_t samples, int axes, const AllanFit& fit);

/// Allan deviation of a preset's model: white noise and a Gauss-Markov process, exactly.
double model_deviation(double noise_density, double bias_sigma, double bias_tau_s, double tau_s);

}  // namespace foucault::calibration
