#include "foucault/geodesy/course.h"

#include <algorithm>
#include <cmath>

namespace foucault::geodesy {

double azimuth(const Eigen::Vector3d& vector) { return std::atan2(vector.y(), vector.x()); }

double horizontal_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
}

double course_sigma(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& way) {
  const Eigen::Vector2d across = Eigen::Vector2d(-way.y(), way.x()).normalized();
  const double variance = across.dot(covariance.topLeftCorner<2, 2>() * across);
  return std::sqrt(variance) / way.head<2>().norm();
}

}  // namespace foucault::geodesy
