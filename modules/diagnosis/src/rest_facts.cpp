#include "foucault/diagnosis/rest_facts.h"

#include <algorithm>

#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::diagnosis {
namespace {

// Chosen: means over a second of the noisiest consumer IMUs (MPU-6050: 0.005 deg/s and 0.004 m/s^2)
// are far below, those of manoeuvres above; sigmas of fixes may be too small by a factor of some.
constexpr std::size_t kSeconds = 4;
constexpr double kSteadyGyro = 0.005;  // [rad/s]
constexpr double kSteadyAccel = 0.1;   // [m/s^2]
constexpr double kMoving = 15;         // times the scatter that sigmas promise

}  // namespace

void RestWatch::add(const ImuIncrement& increment) {
  second_.gyro += increment.dtheta_b;
  second_.accel += increment.dvel_b;
  second_.length += increment.dt();
  if (second_.length < 1) return;
  second_.gyro /= second_.length;
  second_.accel /= second_.length;
  end_second();
  second_ = Second();
}

void RestWatch::add(const GnssFix& fix) {
  const double sigma = geodesy::horizontal_sigma(fix.position_covariance);
  if (!(sigma > 0)) return;
  if (last_fix_) {
    const geodesy::LocalFrame frame(last_fix_->antenna);
    const double way = frame.to_local(fix.antenna).head<2>().norm();
    last_scatter_ = way / sigma / 2;  // two fixes, two axes
    pending_scatter_.push_back(last_scatter_);
  }
  last_fix_ = fix;
}

void RestWatch::end_second() {
  seconds_.push_back(second_);
  if (seconds_.size() > kSeconds) seconds_.pop_front();
  if (is_still()) {
    take();
  } else {
    for (AllanWatch& allan : allan_) allan.interrupt();
  }
  pending_scatter_.clear();
}

bool RestWatch::is_still() const {
  const auto agrees = [this](const Second& before) {
    return (before.gyro - second_.gyro).cwiseAbs().maxCoeff() < kSteadyGyro &&
           (before.accel - second_.accel).cwiseAbs().maxCoeff() < kSteadyAccel;
  };
  return seconds_.size() == kSeconds && std::all_of(seconds_.begin(), seconds_.end(), agrees) &&
         last_scatter_ < kMoving;
}

void RestWatch::take() {
  ++still_;
  gyro_sum_ += second_.gyro;
  AllanWatch::Vector6d mean;
  mean << second_.gyro, second_.accel;
  for (AllanWatch& allan : allan_) allan.add(mean);
  for (const double scatter : pending_scatter_) scatter_.add(scatter);
}

RestFacts RestWatch::facts() const {
  RestFacts facts;
  facts.seconds = still_;
  AllanWatch::Vector6d density = allan_[0].density();
  for (const AllanWatch& allan : allan_) {
    if (allan.knows()) density = density.cwiseMin(allan.density());
  }
  facts.gyro_noise_density = density.head<3>().maxCoeff();
  facts.accel_noise_density = density.tail<3>().maxCoeff();
  if (still_ > 0) facts.gyro_mean = (gyro_sum_ / static_cast<double>(still_)).cwiseAbs().maxCoeff();
  facts.fix_scatter = scatter_.median() / 0.8326;  // of a Rayleigh distribution, over sqrt(2)
  facts.fix_pairs = static_cast<int64_t>(scatter_.size());
  return facts;
}

}  // namespace foucault::diagnosis
