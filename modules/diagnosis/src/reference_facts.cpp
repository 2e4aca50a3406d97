#include "foucault/diagnosis/reference_facts.h"

#include <cmath>

#include "foucault/core/elsewhere.h"
#include "foucault/core/position.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/place.h"

namespace foucault::diagnosis {

void ReferenceWatch::add(const ReferencePose& pose) {
  constexpr double kSameTime = 0.5;  // [s]; a car drives 20 m meanwhile, a fifth of kElsewhere
  if (!fix_ || !is_finite(pose.position)) return;
  const double later = seconds_between(fix_->t_ns, pose.t_ns);
  if (std::abs(later) > kSameTime) return;
  const geodesy::Place place(fix_->antenna);
  Eigen::Vector3d apart = geodesy::displacement_n(fix_->antenna, pose.position, place);
  if (pose.velocity_n && pose.velocity_n->allFinite()) {
    apart -= later * *pose.velocity_n;
    ++moved_;
  }
  const double distance = apart.head<2>().norm();
  ++compared_;
  if (distance > kElsewhere) ++far_;
  squares_ += distance * distance;
}

ReferenceFacts ReferenceWatch::facts() const {
  if (compared_ == 0) return {};
  return {compared_, far_, std::sqrt(squares_ / static_cast<double>(compared_)),
          moved_ == compared_};
}

}  // namespace foucault::diagnosis
