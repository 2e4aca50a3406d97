#include "foucault/diagnosis/innovation_line.h"

#include <cmath>

#include "foucault/core/time.h"

namespace foucault::diagnosis {
namespace {

using Eigen::Vector3d;

/// Chosen: no receiver is known whose sigmas are smaller than its errors by more.
constexpr double kSigmasTooSmall = 30;

double count(const InnovationSamples& samples) { return static_cast<double>(samples.size()); }

Vector3d mean_of(const InnovationSamples& samples) {
  Vector3d mean = Vector3d::Zero();
  for (const InnovationSample& s : samples) mean += s.value_n / count(samples);
  return mean;
}

Vector3d mean_variance(const InnovationSamples& samples) {
  Vector3d variance = Vector3d::Zero();
  for (const InnovationSample& s : samples) variance += s.variance_n / count(samples);
  return variance;
}

}  // namespace

Vector3d InnovationLine::at(int64_t at_ns) const {
  return offset_n + seconds_between(t_ns, at_ns) * rate_n;
}

Vector3d InnovationLine::variance_at(int64_t at_ns) const {
  const double dt = seconds_between(t_ns, at_ns);
  return offset_variance_n + dt * dt * rate_variance_n;
}

bool InnovationLine::drifts(const Vector3d& velocity_variance_n) const {
  constexpr double kSigmas = 4;  // one in 5000 of three axes
  const Vector3d sigma = (rate_variance_n + velocity_variance_n).cwiseSqrt();
  return (rate_n.cwiseAbs() - kSigmas * sigma).maxCoeff() > 0;
}

InnovationLine fit_line(const InnovationSamples& samples, const Vector3d& velocity_variance_n) {
  const double n = count(samples);
  InnovationLine line;
  line.t_ns = samples.back().t_ns;
  const Vector3d mean = mean_of(samples), variance = mean_variance(samples);
  double mean_t = 0;
  for (const InnovationSample& s : samples) mean_t += seconds_between(line.t_ns, s.t_ns) / n;
  double tt = 0;
  Vector3d tv = Vector3d::Zero();
  for (const InnovationSample& s : samples) {
    const double t = seconds_between(line.t_ns, s.t_ns) - mean_t;
    tt += t * t;
    tv += t * (s.value_n - mean);
  }
  line.rate_n = tv / tt;
  line.offset_n = mean - mean_t * line.rate_n;
  line.offset_variance_n = variance * (1 / n + mean_t * mean_t / tt);
  line.rate_variance_n = variance / tt + velocity_variance_n;
  return line;
}

bool lie_on(const InnovationSamples& samples, const InnovationLine& line,
            double acceleration_sigma) {
  Vector3d squares = Vector3d::Zero();
  for (const InnovationSample& s : samples) {
    squares += (s.value_n - line.at(s.t_ns)).cwiseAbs2() / count(samples);
  }
  // A parabola a t^2 / 2 leaves a line by a span^2 / 16 at most.
  const double span = seconds_between(samples.front().t_ns, samples.back().t_ns);
  const double bend = acceleration_sigma * span * span / 16;
  const Vector3d limit = 2 * mean_variance(samples).cwiseSqrt() + 3 * bend * Vector3d::Ones();
  return (squares.cwiseSqrt() - limit).maxCoeff() <= 0;
}

bool scatter_about_zero(const InnovationSamples& samples) {
  constexpr double kSigmas = 4;  // of the mean
  const double n = count(samples);
  const Vector3d mean = mean_of(samples);
  Vector3d squares = Vector3d::Zero();
  for (const InnovationSample& s : samples) squares += s.value_n.cwiseAbs2() / n;
  const Vector3d scatter = squares - mean.cwiseAbs2();
  const Vector3d most = kSigmasTooSmall * kSigmasTooSmall * mean_variance(samples);
  return (mean.cwiseAbs2() - kSigmas * kSigmas / n * scatter).maxCoeff() <= 0 &&
         (scatter - most).maxCoeff() <= 0;
}

bool are_smooth(const InnovationSamples& samples) {
  const Vector3d mean = mean_of(samples);
  double variance = 0, steps = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    variance += (samples[i].value_n - mean).squaredNorm();
    if (i > 0) steps += (samples[i].value_n - samples[i - 1].value_n).squaredNorm();
  }
  return steps < variance;
}

}  // namespace foucault::diagnosis
