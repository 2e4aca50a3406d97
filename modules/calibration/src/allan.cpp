#include "foucault/calibration/allan.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "foucault/core/constants.h"

namespace foucault::calibration {
namespace {

constexpr std::size_t kLevels = 28;  // a hundred million samples
const double kFlat = 2 * std::log(2.0) / kPi;

constexpr int kTerms = 3;
constexpr double kFits = 3;         // deviance a degree of freedom
constexpr double kTells = 1.0 / 3;  // sigma of a logarithm

/// Variance at tau of a Gauss-Markov process with K = 1, over tau.
double walk_shape(double x) {
  // Near zero the exact one is a difference of nearly equal numbers.
  if (x < 1e-2) return (1 - 0.75 * x) / 3;
  return (1 - (3 - 4 * std::exp(-x) + std::exp(-2 * x)) / (2 * x)) / (x * x);
}

/// Of a term whose coefficient is one.
double shape(int term, double tau, double bias_tau) {
  return term == 0 ? 1 / tau : term == 1 ? kFlat : tau * walk_shape(tau / bias_tau);
}

/// Its two-sided density at an angular frequency.
double density(int term, double omega, double bias_tau) {
  return term == 0 ? 1 : term == 1 ? 1 / omega : 1 / (omega * omega + 1 / (bias_tau * bias_tau));
}

/// What an Allan variance takes of the density at a frequency.
double window(double frequency, double tau) {
  const double x = kPi * frequency * tau;
  return std::pow(std::sin(x), 4) / (x * x);
}

/// Of one stretch with n integrals.
double white_freedom(double n, double m) {
  return (1.5 * (n - 1) / m - 2 * (n - 2) / n) * 4 * m * m / (4 * m * m + 5);
}

double flicker_freedom(double n, double m) {
  if (m < 2) return 2 * (n - 2) * (n - 2) / (2.3 * n - 4.9);
  return 5 * n * n / (4 * m * (n + 3 * m));
}

double walk_freedom(double n, double m) {
  const double a = n - 1;
  return (n - 2) / m * (a * a - 3 * m * a + 4 * m * m) / ((n - 3) * (n - 3));
}

/// Averaging times that are fitted, shortest first.
struct FitPoint {
  double tau = 0, variance = 0;
  Eigen::Vector3d freedom = Eigen::Vector3d::Zero();  ///< of each term
};
struct FitData {
  std::vector<FitPoint> points;
  double longest = 0, bias_tau = 0;  ///< [s]

  Eigen::Vector3d shapes(double tau) const {
    return {shape(0, tau, bias_tau), shape(1, tau, bias_tau), shape(2, tau, bias_tau)};
  }
};

/// Coefficients squared; zero where a term is left out.
struct Trial {
  std::vector<Eigen::Index> terms;
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  Eigen::Vector3d log_sigma = Eigen::Vector3d::Zero();  ///< of the coefficients
  double deviance = 0;

  double cost() const {
    constexpr double kTerm = 9;
    return deviance + kTerm * static_cast<double>(terms.size());
  }
};

/// A point by its model: variance, degrees of freedom as the terms contribute, terms over variance.
struct ByModel {
  double variance = 0, freedom = 0;
  Eigen::VectorXd row;
};

ByModel by_model(const FitData& data, const FitPoint& point, const Trial& trial) {
  constexpr double kModelError = 0.02;                           // of the deviation
  constexpr double kMost = 1 / (2 * kModelError * kModelError);  // degrees of freedom
  const Eigen::Vector3d shapes = data.shapes(point.tau);
  const Eigen::Vector3d parts = trial.squares.cwiseProduct(shapes);
  ByModel out;
  out.variance = parts.sum();
  out.freedom = 1 / (out.variance / parts.dot(point.freedom) + 1 / kMost);
  out.row = shapes(trial.terms) / out.variance;
  return out;
}

/// Correlations of estimates, which overlap in frequency: as those of sums of a periodogram.
Eigen::MatrixXd correlations(const FitData& data, const Trial& trial) {
  constexpr double kStep = 1.01, kHighest = 4;  // of frequencies; in 1 / tau of the shortest
  const auto n = static_cast<Eigen::Index>(data.points.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd power(n);
  for (double f = 0.5 / data.longest; f < kHighest / data.points.front().tau; f *= kStep) {
    double level = 0;
    for (int i = 0; i < kTerms; ++i)
      level += trial.squares[i] * density(i, 2 * kPi * f, data.bias_tau);
    for (Eigen::Index i = 0; i < n; ++i)
      power[i] = level * window(f, data.points[static_cast<std::size_t>(i)].tau);
    sum += f * power * power.transpose();
  }
  const Eigen::VectorXd by = sum.diagonal().cwiseSqrt().cwiseInverse();
  return by.asDiagonal() * sum * by.asDiagonal();
}

/// The sigmas of what was solved for as if estimates were independent, which they are not.
void set_sigmas(const FitData& data, const Eigen::MatrixXd& information, Trial& trial) {
  const auto n = static_cast<Eigen::Index>(data.points.size());
  Eigen::MatrixXd gradients(n, information.cols());
  for (Eigen::Index i = 0; i < n; ++i) {
    const ByModel model = by_model(data, data.points[static_cast<std::size_t>(i)], trial);
    gradients.row(i) = std::sqrt(model.freedom / 2) * model.row.transpose();
  }
  const Eigen::MatrixXd spread = gradients.transpose() * correlations(data, trial) * gradients;
  const Eigen::MatrixXd half = information.ldlt().solve(spread);
  const Eigen::MatrixXd covariance = information.ldlt().solve(half.transpose());
  for (std::size_t i = 0; i < trial.terms.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    trial.log_sigma[trial.terms[i]] =
        0.5 * std::sqrt(covariance(k, k)) / trial.squares[trial.terms[i]];
  }
}

/// Least squares of relative errors; `start`: they are relative to the estimates.
std::optional<Eigen::MatrixXd> improve(const FitData& data, bool start, Trial& trial) {
  const auto n = static_cast<Eigen::Index>(trial.terms.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (const FitPoint& point : data.points) {
    ByModel model;
    if (start) {
      model = {point.variance, point.freedom.mean(),
               data.shapes(point.tau)(trial.terms) / point.variance};
    } else {
      model = by_model(data, point, trial);
    }
    information += model.freedom / 2 * model.row * model.row.transpose();
    right += model.freedom / 2 * model.row * (point.variance / model.variance);
  }
  const Eigen::VectorXd squares = information.ldlt().solve(right);
  if (!squares.allFinite() || squares.minCoeff() <= 0) return std::nullopt;
  trial.squares(trial.terms) = squares;
  return information;
}

/// With some of the terms; none if one comes out negative or not to a third.
std::optional<Trial> fitted(const FitData& data, const std::vector<Eigen::Index>& terms) {
  constexpr int kSteps = 30;
  if (data.points.size() < terms.size() + 1) return std::nullopt;
  Trial trial;
  trial.terms = terms;
  Eigen::MatrixXd information;
  for (int step = 0; step < kSteps; ++step) {
    const std::optional<Eigen::MatrixXd> found = improve(data, step == 0, trial);
    if (!found) return std::nullopt;
    information = *found;
  }
  set_sigmas(data, information, trial);
  if (trial.log_sigma.maxCoeff() > kTells) return std::nullopt;
  for (const FitPoint& point : data.points) {
    const ByModel model = by_model(data, point, trial);
    const double ratio = point.variance / model.variance;
    trial.deviance += model.freedom * (ratio - 1 - std::log(ratio));
  }
  return trial;
}

std::optional<Trial> best(const FitData& data) {
  static const std::vector<std::vector<Eigen::Index>> subsets{{0},    {1},    {2},      {0, 1},
                                                              {0, 2}, {1, 2}, {0, 1, 2}};
  std::optional<Trial> best;
  for (const std::vector<Eigen::Index>& terms : subsets) {
    const std::optional<Trial> trial = fitted(data, terms);
    if (trial && (!best || trial->cost() < best->cost())) best = trial;
  }
  return best;
}

double freedom_of(const AllanCurve& curve, int64_t samples, int axes,
                  double (*of_piece)(double n, double m)) {
  double sum = 0;
  for (const int64_t piece : curve.pieces) {
    if (piece >= 2 * samples && piece > 3)
      sum += of_piece(static_cast<double>(piece + 1), static_cast<double>(samples));
  }
  return axes * sum;
}

Eigen::Vector3d freedoms(const AllanCurve& curve, int64_t samples, int axes) {
  return {freedom_of(curve, samples, axes, white_freedom),
          freedom_of(curve, samples, axes, flicker_freedom),
          freedom_of(curve, samples, axes, walk_freedom)};
}

bool is_octave(int64_t samples) { return (samples & (samples - 1)) == 0; }

/// Octaves, up to a third of the longest stretch.
std::vector<FitPoint> fit_points(const AllanCurve& curve, const std::vector<int>& axes) {
  std::vector<FitPoint> points;
  for (const AllanPoint& point : curve.points) {
    const double variance = variance_of(point, axes);
    if (!is_octave(point.samples) || 3 * point.tau_s > curve.longest_s() || !(variance > 0))
      continue;
    points.push_back(
        {point.tau_s, variance, freedoms(curve, point.samples, static_cast<int>(axes.size()))});
  }
  return points;
}

/// Where the lines do not fit, sigmas are as much larger as it takes to make them fit.
AllanFit fit_of(const Trial& trial, const FitData& data, double misfit) {
  const double factor = misfit < kFits ? 1 : std::sqrt(misfit);
  const auto coefficient = [&](Eigen::Index term) -> std::optional<AllanCoefficient> {
    const double log_sigma = factor * trial.log_sigma[term];
    if (trial.squares[term] <= 0 || log_sigma > kTells) return std::nullopt;
    return AllanCoefficient{std::sqrt(trial.squares[term]), log_sigma};
  };
  return {coefficient(0), coefficient(1),          coefficient(2),
          data.bias_tau,  data.points.front().tau, data.points.back().tau};
}

/// What each term of a fit contributes.
Eigen::Vector3d parts(const AllanFit& fit, double tau) {
  Eigen::Vector3d parts = Eigen::Vector3d::Zero();
  int term = 0;
  for (const std::optional<AllanCoefficient>* one : {&fit.white, &fit.flicker, &fit.walk}) {
    if (*one) parts[term] = (*one)->value * (*one)->value * shape(term, tau, fit.bias_tau_s);
    ++term;
  }
  return parts;
}

}  // namespace

double AllanCurve::length_s() const {
  return interval_s * static_cast<double>(std::accumulate(pieces.begin(), pieces.end(), int64_t{}));
}

double AllanCurve::longest_s() const {
  if (pieces.empty()) return 0;
  return interval_s * static_cast<double>(*std::max_element(pieces.begin(), pieces.end()));
}

const std::vector<std::size_t>& AllanDeviation::multiples(std::size_t level) {
  static const std::vector<std::size_t> first{1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 13, 16, 19, 23, 27};
  static const std::vector<std::size_t> above{16, 19, 23, 27};
  return level == 0 ? first : above;
}

AllanDeviation::AllanDeviation(double interval_s) : interval_s_(interval_s), levels_(kLevels) {
  for (std::size_t k = 0; k < kLevels; ++k) levels_[k].sums.resize(multiples(k).size());
}

void AllanDeviation::add(const SixAxes& sample) {
  if (samples_ == 0) {
    first_ = sample;
    integral_.setZero();
    for (std::size_t k = 0; k < kLevels; ++k) push(k);
  }
  integral_ += (sample - first_) * interval_s_;
  ++samples_;
  for (std::size_t k = 0; k < kLevels && samples_ % (int64_t{1} << k) == 0; ++k) push(k);
}

void AllanDeviation::push(std::size_t k) {
  Level& level = levels_[k];
  const std::size_t now = level.filled++;
  level.ring[now % kRing] = integral_;
  for (std::size_t i = 0; i < level.sums.size(); ++i) {
    const std::size_t m = multiples(k)[i];
    if (now < 2 * m) break;
    level.sums[i].squares +=
        (integral_ - 2 * level.ring[(now - m) % kRing] + level.ring[(now - 2 * m) % kRing])
            .cwiseAbs2();
    ++level.sums[i].count;
  }
}

void AllanDeviation::interrupt() {
  if (samples_ > 0) pieces_.push_back(samples_);
  samples_ = 0;
  for (Level& level : levels_) level.filled = 0;
}

AllanCurve AllanDeviation::curve() const {
  AllanCurve curve{interval_s_, pieces_, {}};
  if (samples_ > 0) curve.pieces.push_back(samples_);
  for (std::size_t k = 0; k < kLevels; ++k) {
    for (std::size_t i = 0; i < levels_[k].sums.size(); ++i) {
      const Sum& sum = levels_[k].sums[i];
      if (sum.count == 0) continue;
      const int64_t samples = static_cast<int64_t>(multiples(k)[i]) << k;
      const double tau = static_cast<double>(samples) * interval_s_;
      curve.points.push_back(
          {samples, tau, sum.squares / (2 * tau * tau * static_cast<double>(sum.count))});
    }
  }
  return curve;
}

double AllanFit::deviation(double tau_s) const { return std::sqrt(parts(*this, tau_s).sum()); }

double variance_of(const AllanPoint& point, const std::vector<int>& axes) {
  return point.variance(axes).mean();
}

double degrees_of_freedom(const AllanCurve& curve, int64_t samples, int axes, const AllanFit& fit) {
  const Eigen::Vector3d all = freedoms(curve, samples, axes);
  const Eigen::Vector3d by = parts(fit, static_cast<double>(samples) * curve.interval_s);
  return by.sum() > 0 ? by.dot(all) / by.sum() : all[0];
}

AllanFit fit(const AllanCurve& curve, const std::vector<int>& axes, double bias_tau_s) {
  constexpr double kLatestStart = 4;  // [s]
  FitData data{fit_points(curve, axes), curve.longest_s(), bias_tau_s};
  std::optional<AllanFit> found;
  double least = 0;
  while (!data.points.empty() && (!found || data.points.front().tau <= kLatestStart)) {
    const std::optional<Trial> trial = best(data);
    if (!trial) break;
    const auto left = static_cast<double>(data.points.size() - trial->terms.size());
    const double misfit = trial->deviance / left;
    if (!found || misfit < least) {
      found = fit_of(*trial, data, misfit);
      least = misfit;
    }
    if (misfit < kFits) break;
    data.points.erase(data.points.begin());
  }
  return found.value_or(AllanFit());
}

double model_deviation(double noise_density, double bias_sigma, double bias_tau_s, double tau_s) {
  const double walk_squared = 2 * bias_sigma * bias_sigma / bias_tau_s;
  return std::sqrt(noise_density * noise_density * shape(0, tau_s, bias_tau_s) +
                   walk_squared * shape(2, tau_s, bias_tau_s));
}

}  // namespace foucault::calibration
