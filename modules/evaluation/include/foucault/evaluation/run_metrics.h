#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foucault/evaluation/consistency.h"
#include "foucault/evaluation/trust.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/result.h"

namespace foucault::evaluation {

/// Fixes of a run. Root mean squares and mean NIS are over those from the start of the statistics
/// on; the counts are over all.
struct GnssMetrics {
  int64_t used = 0;
  int64_t rejected = 0;                                        ///< for whatever reason
  int64_t corrected = 0;                                       ///< used less an error that lasts
  int64_t samples = 0;                                         ///< used fixes behind the statistics
  Eigen::Vector3d innovation_rms_n = Eigen::Vector3d::Zero();  ///< north, east, down [m]
  Eigen::Vector3d postfit_rms_n = Eigen::Vector3d::Zero();     ///< [m]
  double mean_nis = 0;  ///< innovation, squared by its covariance; 3 if that is right
  /// The same of fixes that were rejected though they could be compared with a prediction.
  int64_t rejected_samples = 0;
  Eigen::Vector3d rejected_innovation_rms_n = Eigen::Vector3d::Zero();  ///< [m]
  double rejected_mean_nis = 0;
};

/// How often an error lies inside 1, 2 and 3 of its sigmas, each axis; Gaussian errors do with
/// 0.683, 0.954, 0.997.
struct InsideSigma {
  int64_t samples = 0;
  Eigen::Matrix3d fraction = Eigen::Matrix3d::Zero();  ///< row: axis, column: 1, 2, 3 sigma
};

/// Errors against a reference, from the start of the statistics on.
struct ReferenceMetrics {
  int64_t samples = 0;                  ///< epochs with a reference
  double horizontal_rmse = 0;           ///< root of mean (north^2 + east^2) [m]
  double vertical_rmse = 0;             ///< [m]
  std::optional<double> velocity_rmse;  ///< of the 3D error [m/s]
  std::optional<double> roll_rmse, pitch_rmse, heading_rmse;  ///< of the vehicle [rad]
  InsideSigma position_inside;                                ///< north, east, down
  InsideSigma velocity_inside;                                ///< north, east, down
  InsideSigma attitude_inside;                                ///< roll, pitch, heading
  /// Error squared by its covariance, mean over the epochs; 3 if the covariance is right.
  std::optional<double> position_nees, velocity_nees, attitude_nees;
};

/// A slow block at the last epoch.
struct CalibratedBlock {
  state::Block block;
  std::vector<double> value, sigma;
};
std::vector<CalibratedBlock> calibrated_blocks(const state::Epoch& epoch,
                                               const state::Layout& layout);

struct RunMetrics {
  Aids aids;
  int64_t epochs = 0;
  double duration_s = 0;  ///< from the first to the last epoch
  GnssMetrics gnss;
  std::optional<ReferenceMetrics> reference;  ///< none if no epoch had a reference, or this:
  /// It lies elsewhere, at most epochs further than kElsewhere and ten sigmas of the position: its
  /// horizontal distance, RMS [m]. Nothing is compared with it.
  std::optional<double> reference_elsewhere_m;
  Consistency consistency;
  Trust trust;
};

/// Normalized estimation error squared, e' P^-1 e. None if P is not positive definite.
std::optional<double> normalized_square(const Eigen::Vector3d& error,
                                        const Eigen::Matrix3d& covariance);

/// Collects the metrics of a run, in bounded memory.
class RunMetricsCollector : public state::Sink {
 public:
  /// Statistics count from `from_ns` on (a settling time is left out); counts of epochs and fixes
  /// and the duration are over the whole run. `on_square` is told every normalized square.
  explicit RunMetricsCollector(const state::Mounting& mounting,
                               int64_t from_ns = std::numeric_limits<int64_t>::min(),
                               ConsistencyCollector::Callback on_square = {});

  void epoch(const state::Epoch& epoch) override;
  void fix(const state::FixResult& fix) override;
  void observation(const state::ObservationResult& result) override;
  void prediction(const state::PredictionResult& prediction) override;
  void reference_error(const state::Epoch& epoch, const state::ReferenceError& error);

  RunMetrics metrics() const;

 private:
  /// Mean squares of three-vectors.
  struct Squares {
    int64_t samples = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    void add(const Eigen::Vector3d& value);
    Eigen::Vector3d mean() const;
  };

  /// Errors of one kind with their sigmas.
  struct Errors {
    Squares squares;
    Eigen::Matrix3d inside = Eigen::Matrix3d::Zero();
    void add(const Eigen::Vector3d& error, const Eigen::Vector3d& sigma);
    InsideSigma inside_sigma() const;
  };

  void add_rejected(const state::FixResult& fix);
  void add_attitude(const state::Epoch& epoch, int64_t t_ns, const Eigen::Vector3d& euler_error);
  void compare_with_reference(RunMetrics& m) const;
  ReferenceMetrics reference_metrics(const Consistency& consistency) const;

  state::Mounting mounting_;
  int64_t from_ns_;
  StateCount states_;
  CourseOffset course_;
  int64_t last_ns_ = 0;
  int64_t used_ = 0;
  int64_t rejected_ = 0;
  int64_t corrected_ = 0;
  Squares innovation_;
  Squares postfit_;
  Squares rejected_innovation_;
  double rejected_nis_sum_ = 0;
  Aids aids_;
  int64_t elsewhere_ = 0;  ///< epochs whose reference lies elsewhere
  Errors position_;
  Errors velocity_;
  Errors attitude_;
  ConsistencyCollector consistency_;
};

}  // namespace foucault::evaluation
