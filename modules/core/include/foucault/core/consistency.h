#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Whether errors are as large as an estimator says they are, as plain values.
namespace foucault {

struct Band {
  double low = 0;
  double high = 0;
  bool holds(double value) const { return value >= low && value <= high; }
};

enum class NormalizedKind { innovation, position, velocity, attitude };

/// An error of three components squared by its covariance, e' P^-1 e: chi-square of three degrees
/// of freedom if P is right. Of an innovation it is called NIS, of an estimate against a reference
/// NEES.
struct NormalizedSquare {
  int64_t t_ns = 0;
  NormalizedKind kind = NormalizedKind::innovation;
  bool used = true;  ///< false: the innovation of a fix that was rejected
  double value = 0;
  /// Mean of this and the used innovations before it, kRunningMeanFixes in all; none before there
  /// are so many, nor for other kinds.
  std::optional<double> running_mean;
};

constexpr int64_t kRunningMeanFixes = 30;

/// Normalized squares of one kind.
struct SquareConsistency {
  int64_t samples = 0;
  /// So many independent ones tell as much about the mean: samples / (1 + 2 sum of their
  /// autocorrelation). Errors of real receivers are coloured, those of estimates always are.
  double effective_samples = 0;
  double mean = 0;          ///< 3 if the covariances are right
  Band mean_band;           ///< holds the mean of the effective samples with 95 % if they are
  double inside_share = 0;  ///< of the samples in Consistency::single_band; 0.95 if they are
};

/// kRunningMeanFixes used innovations after another, those of the next stretch after them, and so
/// on. The size of a stretch is the root of its median square over that of chi-square of three
/// degrees of freedom: 1 if the covariances are right, and a single fix does not change it.
struct StretchConsistency {
  int64_t stretches = 0;
  int64_t too_large = 0;       ///< of size kTooLarge and more
  double worst = 0;            ///< the largest size
  int64_t worst_begin_ns = 0;  ///< its first fix
  int64_t worst_end_ns = 0;    ///< its last
  static constexpr double kTooLarge = 3;
};

/// Fixes predicted some time ahead, see PredictionResult. Predictions do not overlap and count as
/// independent.
struct PredictionConsistency {
  double ahead_s = 0;
  int64_t samples = 0;
  double mean_nis = 0;  ///< 3 if the covariances are right
  Band mean_band;       ///< holds it with 95 % if they are
};

/// Counts of bins of equal width over [-kLimit, kLimit).
struct ResidualHistogram {
  static constexpr double kLimit = 5;
  static constexpr std::size_t kBins = 50;
  static constexpr double kWidth = 2 * kLimit / kBins;
  std::array<int64_t, kBins> counts{};
  int64_t outside = 0;
};

/// One component of whitened innovations, N(0, 1) if their covariances are right.
struct ResidualStatistics {
  int64_t samples = 0;
  double mean = 0;
  double sigma = 0;                       ///< about the mean
  std::optional<double> excess_kurtosis;  ///< 0 of a Gaussian; none if all are equal
  std::array<double, 3> inside{};         ///< share of |z| <= 1, 2, 3
  ResidualHistogram histogram;
};

/// Autocorrelation of whitened innovations, mean removed, over the lag in used fixes (over gaps
/// they count on). White ones stay inside +-white_bound at 95 % of the lags.
struct ResidualAutocorrelation {
  int64_t samples = 0;
  double interval_s = 0;             ///< between used fixes, median of the first thousand
  double white_bound = 0;            ///< 1.96 / sqrt(samples)
  std::vector<Eigen::Vector3d> lag;  ///< [k - 1]: lag k; north, east, down
  double outside_share = 0;          ///< of all lags of all axes
};

/// Of a run, from the start of the statistics on; innovations are those of used fixes.
struct Consistency {
  Band single_band;        ///< holds a normalized square with 95 %, 2.5 % on each side
  Band running_mean_band;  ///< the same for the mean of kRunningMeanFixes independent ones
  SquareConsistency nis;
  NormalizedSquare largest_nis;  ///< value 0 without innovations
  StretchConsistency stretches;
  std::array<ResidualStatistics, 3> innovations;  ///< whitened; north, east, down
  ResidualAutocorrelation autocorrelation;
  std::vector<PredictionConsistency> predictions;  ///< in order of their horizons
  std::optional<SquareConsistency> position_nees, velocity_nees, attitude_nees;
};

/// Whether what a run gave out can be believed.
struct Trust {
  bool trustworthy = true;
  /// One line each: what, and the remedy. What is only remarkable, too, if the run is trustworthy.
  std::vector<std::string> reasons;
};

}  // namespace foucault
