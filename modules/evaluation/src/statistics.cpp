#include "foucault/evaluation/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>
#include <utility>

namespace foucault::evaluation {
namespace {

using Indices = std::vector<std::size_t>;

void draw(std::mt19937_64& rng, Indices& indices) {
  // The remainder favours small indices by 1e-17, and is the same with every standard library.
  for (std::size_t& index : indices) index = static_cast<std::size_t>(rng() % indices.size());
}

std::vector<double> chosen(const std::vector<double>& values, const Indices& indices) {
  std::vector<double> picked(indices.size());
  std::transform(indices.begin(), indices.end(), picked.begin(),
                 [&values](std::size_t i) { return values[i]; });
  return picked;
}

Estimate interval(double value, const std::vector<double>& resampled, double confidence) {
  return {value, quantile(resampled, (1 - confidence) / 2),
          quantile(resampled, (1 + confidence) / 2)};
}

/// The bootstrap of `statistic`, a function of the indices of a resample.
template <class Statistic>
Estimate bootstrap(std::size_t count, const BootstrapOptions& options, Statistic statistic) {
  Indices indices(count);
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  const double value = statistic(indices);
  std::mt19937_64 rng{options.seed};
  std::vector<double> resampled;
  for (int i = 0; i < options.resamples; ++i) {
    draw(rng, indices);
    resampled.push_back(statistic(indices));
  }
  return interval(value, resampled, options.confidence);
}

double difference_p_value(const std::vector<double>& base, const std::vector<double>& other,
                          const BootstrapOptions& options) {
  const double observed = std::abs(root_mean_square(other) - root_mean_square(base));
  std::mt19937_64 rng{options.seed};
  int at_least = 1;  // the observed one belongs to the permutations
  std::vector<double> a(base.size());
  std::vector<double> b(base.size());
  for (int i = 0; i < options.resamples; ++i) {
    for (std::size_t k = 0; k < base.size(); ++k) {
      const bool swap = (rng() >> 63) != 0;
      a[k] = swap ? other[k] : base[k];
      b[k] = swap ? base[k] : other[k];
    }
    // Rounding must not decide between equal sums.
    if (std::abs(root_mean_square(b) - root_mean_square(a)) >= observed * (1 - 1e-12)) ++at_least;
  }
  return static_cast<double>(at_least) / (options.resamples + 1);
}

/// Of a standard normal: holds it with this probability, to both sides.
double normal_bound(double confidence) { return std::sqrt(chi_square_quantile(confidence, 1)); }

/// The normal limit of the bootstrap of a statistic; `influence(i)` is what value i changes it by,
/// times the number of values. No interval where that is not finite.
template <class Influence>
Estimate normal_interval(double value, std::size_t count, double confidence, Influence influence) {
  double square = 0;
  for (std::size_t i = 0; i < count; ++i) square += std::pow(influence(i), 2);
  const double half = normal_bound(confidence) * std::sqrt(square) / static_cast<double>(count);
  if (!std::isfinite(half)) return {value, value, value};
  return {value, value - half, value + half};
}

Estimate rms_limit(const std::vector<double>& values, double confidence) {
  const double rms = root_mean_square(values);
  if (rms == 0) return {};
  return normal_interval(rms, values.size(), confidence, [&](std::size_t i) {
    return (values[i] * values[i] - rms * rms) / (2 * rms);
  });
}

/// Type 7, as quantile().
double at_position(const std::vector<double>& sorted, double position) {
  const double last = static_cast<double>(sorted.size() - 1);
  position = std::clamp(position, 0.0, last);
  const auto index = static_cast<std::size_t>(position);
  const double low = sorted[index], high = sorted[std::min(index + 1, sorted.size() - 1)];
  if (high == low) return low;  // infinities, too
  return low + (position - static_cast<double>(index)) * (high - low);
}

/// How many values of a resample lie below one of them is binomial.
Estimate quantile_limit(const std::vector<double>& sorted, double p, double confidence) {
  const auto count = static_cast<double>(sorted.size());
  const double position = p * (count - 1);
  const double half = normal_bound(confidence) * std::sqrt(count * p * (1 - p));
  return {at_position(sorted, position), at_position(sorted, position - half),
          at_position(sorted, position + half)};
}

/// A resample lacks the k largest values with exp(-k).
Estimate maximum_limit(const std::vector<double>& sorted, double confidence) {
  const double lacking = std::floor(-std::log((1 - confidence) / 2));
  const double largest = sorted.back();
  return {largest, at_position(sorted, static_cast<double>(sorted.size() - 1) - lacking), largest};
}

Summary limits(const std::vector<double>& values, double confidence) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  Summary s;
  s.count = static_cast<int64_t>(values.size());
  const double centre = evaluation::mean(values);
  s.rms = rms_limit(values, confidence);
  s.mean = normal_interval(centre, values.size(), confidence,
                           [&](std::size_t i) { return values[i] - centre; });
  s.median = quantile_limit(sorted, 0.5, confidence);
  s.p68 = quantile_limit(sorted, 0.68, confidence);
  s.p95 = quantile_limit(sorted, 0.95, confidence);
  s.max = maximum_limit(sorted, confidence);
  return s;
}

/// If names are swapped, the difference of the sums of squares is normal; that of the RMS grows
/// with it, since their sum stays.
double swap_limit(const std::vector<double>& base, const std::vector<double>& other) {
  double sum = 0, square = 0;
  for (std::size_t i = 0; i < base.size(); ++i) {
    const double difference = other[i] * other[i] - base[i] * base[i];
    sum += difference;
    square += difference * difference;
  }
  if (square == 0 || !std::isfinite(square)) return 1;
  return std::erfc(std::abs(sum) / std::sqrt(2 * square));
}

/// The differences of `c`, whose RMS are there.
void add_limits(const std::vector<double>& base, const std::vector<double>& other,
                double confidence, PairedComparison& c) {
  const double a = c.base_rms, b = c.other_rms;
  const auto of_base = [&](std::size_t i) { return (base[i] * base[i] - a * a) / (2 * a); };
  const auto of_other = [&](std::size_t i) { return (other[i] * other[i] - b * b) / (2 * b); };
  c.rms_difference = normal_interval(b - a, base.size(), confidence,
                                     [&](std::size_t i) { return of_other(i) - of_base(i); });
  c.relative = normal_interval((b - a) / a, base.size(), confidence, [&](std::size_t i) {
    return (of_other(i) - b / a * of_base(i)) / a;
  });
  c.p_value = swap_limit(base, other);
}

double share_larger(const std::vector<double>& base, const std::vector<double>& other) {
  double larger = 0;
  for (std::size_t i = 0; i < base.size(); ++i) {
    larger += other[i] > base[i] ? 1 : (other[i] == base[i] ? 0.5 : 0);
  }
  return larger / static_cast<double>(base.size());
}

/// Regularized lower incomplete gamma function P(a, x). Series below a + 1, else Lentz's continued
/// fraction. Source: Abramowitz and Stegun 6.5.29, 6.5.31.
double gamma_p(double a, double x) {
  if (x <= 0) return 0;
  int sign = 1;  // of Gamma(a); std::lgamma would write it where all threads do
  const double front = std::exp(a * std::log(x) - x - lgamma_r(a, &sign));
  if (x < a + 1) {
    double term = 1 / a;
    double sum = term;
    for (double n = a + 1; term > sum * 1e-17; ++n) sum += term *= x / n;
    return front * sum;
  }
  double b = x + 1 - a;
  double c = 1e300;
  double d = 1 / b;
  double fraction = d;
  for (int i = 1; i < 100'000; ++i) {
    const double an = -i * (i - a);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    fraction *= d * c;
    if (std::abs(d * c - 1) < 1e-16) break;
  }
  return 1 - front * fraction;
}

/// Values less their mean.
class Deviations {
 public:
  explicit Deviations(std::vector<double> values) : values_(std::move(values)) {
    const double centre = mean(values_);
    for (double& value : values_) value -= centre;
    square_ = product(0);
  }

  double correlation(std::size_t lag) const {
    if (lag == 0) return 1;
    return square_ > 0 ? product(lag) / square_ : 0;
  }

 private:
  double product(std::size_t lag) const {
    const auto later = values_.begin() + static_cast<std::ptrdiff_t>(lag);
    return std::inner_product(later, values_.end(), values_.begin(), 0.0);
  }

  std::vector<double> values_;
  double square_ = 0;
};

}  // namespace

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double root_mean_square(const std::vector<double>& values) {
  const double sum = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double quantile(std::vector<double> values, double p) {
  const double position = p * static_cast<double>(values.size() - 1);
  const auto index = static_cast<std::size_t>(position);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(index);
  std::nth_element(values.begin(), at, values.end());
  const double low = *at;
  if (index + 1 >= values.size()) return low;
  const double high = *std::min_element(at + 1, values.end());
  if (high == low || position == static_cast<double>(index)) return low;  // infinities, too
  return low + (position - static_cast<double>(index)) * (high - low);
}

Summary summarize(const std::vector<double>& values, const BootstrapOptions& options) {
  if (values.empty()) throw std::invalid_argument("there are no values to summarize");
  if (values.size() > options.most) return limits(values, options.confidence);
  const auto of = [&](auto statistic) {
    return bootstrap(values.size(), options,
                     [&](const Indices& indices) { return statistic(chosen(values, indices)); });
  };
  Summary s;
  s.count = static_cast<int64_t>(values.size());
  s.rms = of([](const std::vector<double>& v) { return root_mean_square(v); });
  s.mean = of([](const std::vector<double>& v) { return evaluation::mean(v); });
  s.median = of([](const std::vector<double>& v) { return quantile(v, 0.5); });
  s.p68 = of([](const std::vector<double>& v) { return quantile(v, 0.68); });
  s.p95 = of([](const std::vector<double>& v) { return quantile(v, 0.95); });
  s.max = of([](const std::vector<double>& v) { return *std::max_element(v.begin(), v.end()); });
  return s;
}

PairedComparison compare_paired(const std::vector<double>& base, const std::vector<double>& other,
                                const BootstrapOptions& options) {
  if (base.empty() || base.size() != other.size()) {
    throw std::invalid_argument("a paired comparison needs as many values on both sides");
  }
  const auto difference = [&](const Indices& indices) {
    return root_mean_square(chosen(other, indices)) - root_mean_square(chosen(base, indices));
  };
  const auto relative = [&](const Indices& indices) {
    return difference(indices) / root_mean_square(chosen(base, indices));
  };
  PairedComparison c;
  c.count = static_cast<int64_t>(base.size());
  c.base_rms = root_mean_square(base);
  c.other_rms = root_mean_square(other);
  c.share_larger = share_larger(base, other);
  if (base.size() > options.most) {
    add_limits(base, other, options.confidence, c);
    return c;
  }
  c.rms_difference = bootstrap(base.size(), options, difference);
  c.relative = bootstrap(base.size(), options, relative);
  c.p_value = difference_p_value(base, other, options);
  return c;
}

double chi_square_quantile(double p, double dof) {
  double low = 0;
  double high = 2 * dof + 50;
  while (gamma_p(dof / 2, high / 2) < p) high *= 2;
  for (int i = 0; i < 200 && high - low > 1e-14 * high; ++i) {
    const double middle = (low + high) / 2;
    (gamma_p(dof / 2, middle / 2) < p ? low : high) = middle;
  }
  return (low + high) / 2;
}

Band mean_nees_band(int dof, double samples, double probability) {
  return {chi_square_quantile((1 - probability) / 2, dof * samples) / samples,
          chi_square_quantile((1 + probability) / 2, dof * samples) / samples};
}

std::vector<double> autocorrelation(const std::vector<double>& values, std::size_t max_lag) {
  const Deviations deviations(values);
  std::vector<double> result;
  for (std::size_t lag = 1; lag <= max_lag && lag < values.size(); ++lag) {
    result.push_back(deviations.correlation(lag));
  }
  return result;
}

double integrated_autocorrelation(const std::vector<double>& values) {
  const Deviations deviations(values);
  double sum = 0;
  double last = std::numeric_limits<double>::infinity();
  for (std::size_t lag = 0; lag + 1 < values.size(); lag += 2) {
    const double pair = deviations.correlation(lag) + deviations.correlation(lag + 1);
    if (pair <= 0) break;
    last = std::min(last, pair);
    sum += last;
  }
  return std::max(1.0, 2 * sum - 1);
}

}  // namespace foucault::evaluation
