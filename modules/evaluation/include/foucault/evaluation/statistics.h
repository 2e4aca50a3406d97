#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "foucault/core/consistency.h"

/// Statistics of drifts over outages: samples are few, so each number has a bootstrap interval; and
/// of correlated samples.
namespace foucault::evaluation {

double root_mean_square(const std::vector<double>& values);
double mean(const std::vector<double>& values);
/// Quantile for p in [0, 1], linear between order statistics (type 7 of Hyndman and Fan 1996).
double quantile(std::vector<double> values, double p);

/// A number with the interval that covers it with the asked confidence.
struct Estimate {
  double value = 0;
  double low = 0;
  double high = 0;
};

/// Percentile bootstrap (Efron 1979). The same seed gives the same interval everywhere. Of more
/// than `most` values the limits that it tends to: normal intervals of means, RMS and their
/// differences, ranks for quantiles; time and memory are linear in the number of values.
struct BootstrapOptions {
  int resamples = 2000;
  double confidence = 0.95;
  uint64_t seed = 42;
  std::size_t most = 2000;
};

struct Summary {
  int64_t count = 0;
  Estimate rms, mean, median, p68, p95, max;
};

/// Throws std::invalid_argument if there are no values.
Summary summarize(const std::vector<double>& values, const BootstrapOptions& options = {});

/// How `other` does against `base` on the same outages.
struct PairedComparison {
  int64_t count = 0;
  double base_rms = 0;
  double other_rms = 0;
  Estimate rms_difference;  ///< other - base; outages are resampled in pairs
  Estimate relative;        ///< the same, divided by base
  double share_larger = 0;  ///< of the outages in which other is larger; ties count half
  /// Probability that an equally large difference of RMS (either sign) comes about if the two
  /// names are swapped at random in each outage.
  double p_value = 1;
};

/// Throws std::invalid_argument if the lengths differ or are zero.
PairedComparison compare_paired(const std::vector<double>& base, const std::vector<double>& other,
                                const BootstrapOptions& options = {});

/// Quantile of the chi-square distribution, p in (0, 1), dof > 0.
double chi_square_quantile(double p, double dof);

/// Where the mean over `samples` independent NEES (or NIS) of `dof` components lies with the given
/// probability if the covariance is right: chi-square of dof * samples, over samples, which may be
/// an effective number.
Band mean_nees_band(int dof, double samples, double probability = 0.95);

/// Autocorrelation at lags 1 ... max_lag (fewer if the values end before), mean removed, all lags
/// divided by the number of values (Box and Jenkins 1976). Zero if all values are equal.
std::vector<double> autocorrelation(const std::vector<double>& values, std::size_t max_lag);

/// 1 + 2 sum of the autocorrelation, at least 1: variance of the mean of these values, relative to
/// that of as many independent ones. Summed over pairs of lags while these are positive and do not
/// grow (Geyer 1992, initial monotone sequence).
double integrated_autocorrelation(const std::vector<double>& values);

}  // namespace foucault::evaluation
