#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "foucault/calibration/noise_model.h"
#include "foucault/calibration/recorded_way.h"

namespace foucault::calibration {

/// A prediction that met a measurement: its error and the covariance that the noise gives it, in
/// sigmas of the measurement as it was told.
struct Prediction {
  NoiseOf kind = NoiseOf::position;
  int rows = 0;                ///< 1 to 3
  Eigen::Vector3d error;       ///< rows beyond are zero
  Eigen::Matrix3d covariance;  ///< and here one
  double horizon_s = 0;        ///< without any fix before; 0: from node to node
  int64_t t_ns = 0;
};

/// How far ahead, and how often.
struct Horizons {
  std::vector<double> lengths_s;  ///< rising
  double every_s = 0;             ///< from start to start
};

/// Innovations of a Kalman filter over the way; and from one start after the other, without fixes
/// (aids are used), the first fix at or after each horizon. Those of the first half minute are not
/// counted: the way begins with the covariance of the noise that was told.
std::vector<Prediction> predictions(const RecordedWay& way, const NoiseModel& noise,
                                    const Horizons& horizons);

/// The logarithm of its density without the constant.
double log_density(const Prediction& prediction);

/// Mean of squared errors of positions in sigmas, a row; one if the noise is right.
struct NormalizedError {
  double horizon_s = 0;
  int count = 0;  ///< predictions
  double mean = 0;
};
std::vector<NormalizedError> normalized_errors(const std::vector<Prediction>& predictions);

}  // namespace foucault::calibration
