#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "foucault/core/consistency.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/result.h"

/// Whether errors are as large, and as random, as their covariances say.
namespace foucault::evaluation {

/// z = C^-1/2 D^-1 error with the covariance D C D, D its sigmas, C the correlations, C^-1/2
/// symmetric: z ~ N(0, I) if the covariance is right, z'z is the normalized square, and of all such
/// z it is the one whose components are most like those of the error, whatever their order (a
/// Cholesky factor would make the second of the first and the second).
/// None if the covariance is not positive definite or something is not finite.
/// Source: Kessy, Lewin and Strimmer (2018), "Optimal whitening and decorrelation", ZCA-cor.
std::optional<Eigen::Vector3d> whitened(const Eigen::Vector3d& error,
                                        const Eigen::Matrix3d& covariance);

/// The mean of correlated numbers and how many independent ones tell as much about it, in bounded
/// memory: from 4096 numbers on neighbours are joined to means of 2, 4, 8, ... of them.
class CorrelatedMean {
 public:
  void add(double value);

  int64_t samples() const { return samples_; }
  double mean() const;
  /// From the autocorrelation of the joined means, 1 to samples(); 0 without samples.
  double effective_samples() const;

 private:
  void join_neighbours();

  int64_t samples_ = 0;
  double sum_ = 0;
  double sum_of_squares_ = 0;
  int64_t per_block_ = 1;
  int64_t in_open_block_ = 0;
  double open_sum_ = 0;
  std::vector<double> blocks_;  ///< means of per_block_ numbers
};

/// Autocorrelation of a stream of three-vectors up to a lag, mean removed, exact, in bounded
/// memory.
class StreamingAutocorrelation {
 public:
  explicit StreamingAutocorrelation(std::size_t max_lag);

  void add(const Eigen::Vector3d& value);

  int64_t samples() const { return samples_; }
  /// [k - 1]: lag k, as autocorrelation(); up to the longest lag or a quarter of the samples.
  std::vector<Eigen::Vector3d> lags() const;

 private:
  Eigen::Array3d centred(std::size_t lag) const;

  int64_t samples_ = 0;
  Eigen::Array3d sum_ = Eigen::Array3d::Zero();
  std::vector<Eigen::Array3d> products_;  ///< [k]: sum of values times those k before
  std::vector<Eigen::Array3d> first_;     ///< as many as the longest lag
  std::deque<Eigen::Array3d> last_;       ///< the same, latest first
};

/// Cuts a stream of squares of three components into stretches, in bounded memory.
class StretchCollector {
 public:
  void add(int64_t t_ns, double square);
  const StretchConsistency& result() const { return result_; }

 private:
  void close(int64_t end_ns);

  std::vector<double> open_;
  int64_t open_begin_ns_ = 0;
  StretchConsistency result_;
};

/// Statistics of one component of whitened innovations.
class ResidualCollector {
 public:
  void add(double z);
  ResidualStatistics statistics() const;

 private:
  std::array<double, 5> power_sums_{};  ///< [k]: sum of z^k
  std::array<int64_t, 3> inside_{};
  ResidualHistogram histogram_;
};

/// Collects the consistency of a run, in bounded memory.
class ConsistencyCollector {
 public:
  /// Called for every normalized square, those before the start of the statistics and those of
  /// rejected fixes, too; squares of one kind in the order of their fixes or errors.
  using Callback = std::function<void(const NormalizedSquare&)>;

  /// Statistics count from `from_ns` on.
  explicit ConsistencyCollector(int64_t from_ns = std::numeric_limits<int64_t>::min(),
                                Callback callback = {});

  void fix(const state::FixResult& fix);
  void prediction(const state::PredictionResult& prediction);
  /// Position and velocity: NED and `kind`'s block of the covariance; attitude: in v.
  void error(NormalizedKind kind, int64_t t_ns, const Eigen::Vector3d& error,
             const Eigen::Matrix3d& covariance);

  Consistency result() const;

 private:
  struct Squares {
    CorrelatedMean mean;
    int64_t inside = 0;
  };

  struct PredictionSum {
    int64_t samples = 0;
    double sum = 0;
  };

  void add(const NormalizedSquare& square);
  std::optional<double> running_mean(double square);
  SquareConsistency consistency(const Squares& squares) const;
  std::optional<SquareConsistency> nees(NormalizedKind kind) const;
  std::vector<PredictionConsistency> predictions() const;
  ResidualAutocorrelation autocorrelation() const;
  void watch_interval(int64_t t_ns);

  int64_t from_ns_;
  Callback callback_;
  Band single_band_;
  std::array<Squares, 4> squares_;               ///< by kind
  std::map<double, PredictionSum> predictions_;  ///< by horizon [s]
  std::array<ResidualCollector, 3> residuals_;
  StreamingAutocorrelation autocorrelation_;
  NormalizedSquare largest_nis_;
  StretchCollector stretches_;
  std::deque<double> recent_;  ///< squares of used fixes, as many as a running mean takes
  std::optional<int64_t> last_fix_ns_;
  std::vector<double> intervals_s_;  ///< the first ones
};

}  // namespace foucault::evaluation
