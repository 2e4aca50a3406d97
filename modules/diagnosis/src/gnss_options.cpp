#include "foucault/diagnosis/gnss_options.h"

#include <Eigen/Cholesky>

#include "foucault/core/fix_quality.h"
#include "foucault/core/position.h"

namespace foucault::diagnosis {

void GnssOptions::fields(ConfigFields& f) {
  f.text("min_quality", min_quality,
         {"any", "single", "differential", "ppp", "float_rtk", "fixed_rtk"},
         "fixes of a lower quality are not used");
  f.number("sigma_scale", sigma_scale, kPositive, "factor on the sigmas of the positions");
  f.number("sigma_floor_m", sigma_floor_m, kNotNegative, "smallest sigma of a position, each axis");
  f.number("gate_false_alarm", gate_false_alarm, {0, 0.5},
           "probability that a good fix is taken for an outlier; 0: no gate");
  f.integer("reinstate_after", reinstate_after, {1, 1e9},
            "outliers in a row after which fixes are believed again");
}

FixQuality GnssOptions::lowest_quality() const {
  return fix_quality(min_quality).value_or(FixQuality::unknown);
}

GnssFix GnssOptions::weighted(const GnssFix& fix) const {
  GnssFix result = fix;
  result.position_covariance *= sigma_scale * sigma_scale;
  const double floor_variance = sigma_floor_m * sigma_floor_m;
  for (int axis = 0; axis < 3; ++axis) {
    double& variance = result.position_covariance(axis, axis);
    if (variance < floor_variance) variance = floor_variance;
  }
  return result;
}

bool GnssOptions::has_valid_sigma(const GnssFix& fix) const {
  return is_valid_covariance(weighted(fix).position_covariance);
}

bool GnssOptions::allows(const GnssFix& fix) const {
  return is_position(fix.antenna) && has_valid_sigma(fix) && fix.quality >= lowest_quality();
}

bool is_valid_covariance(const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite() || covariance.diagonal().minCoeff() <= 0) return false;
  const Eigen::LLT<Eigen::Matrix3d> llt(covariance);
  return llt.info() == Eigen::Success;
}

}  // namespace foucault::diagnosis
