#include "foucault/diagnosis/sigma_facts.h"

#include <algorithm>

#include "foucault/geodesy/course.h"

namespace foucault::diagnosis {

bool SigmaFacts::add(const Eigen::Matrix3d& position_covariance) {
  const Eigen::Vector3d variance = position_covariance.diagonal();
  if (!variance.allFinite() || variance.minCoeff() <= 0) {
    ++bad;
    return false;
  }
  const double sigma = geodesy::horizontal_sigma(position_covariance);
  smallest_m = smallest_m > 0 ? std::min(smallest_m, sigma) : sigma;
  largest_m = std::max(largest_m, sigma);
  return true;
}

}  // namespace foucault::diagnosis
