#include "foucault/diagnosis/rest_facts.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "foucault/core/median.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::diagnosis {
namespace {

// Chosen: means over a second of the noisiest consumer IMUs (MPU-6050: 0.005 deg/s and 0.004 m/s^2)
// are far below, those of manoeuvres above.
constexpr std::size_t kSeconds = 4;
constexpr double kSteadyGyro = 0.005;  // [rad/s]
constexpr double kSteadyAccel = 0.1;   // [m/s^2]
// Chosen: fixes of 5 m at 1 Hz show a walk within 20 s.
constexpr std::size_t kLongestStretch = 30;  // [s]
constexpr double kWalk = 1;                  // [m/s]
// Both axes within: all but three in ten thousand at rest.
constexpr double kSigmas = 4;
// Errors of receivers wander as slowly, with the times of satellites and reflections.
constexpr double kWander = 0.1;  // [m/s]

}  // namespace

void RestWatch::add(const ImuIncrement& increment) {
  if (second_.length == 0) second_.begin_ns = increment.t_begin_ns;
  second_.end_ns = increment.t_end_ns;
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
  if (geodesy::horizontal_sigma(fix.position_covariance) > 0) fixes_.push_back(fix);
}

void RestWatch::end_second() {
  seconds_.push_back(second_);
  if (seconds_.size() > kSeconds) seconds_.pop_front();
  if (is_steady()) {
    lengthen();
  } else {
    end_stretch();
    goes_on_ = false;
  }
  if (stretch_.seconds.size() == kLongestStretch) end_stretch();
  if (!fixes_.empty()) fixes_.erase(fixes_.begin(), fixes_.end() - 1);
}

bool RestWatch::is_steady() const {
  const auto agrees = [this](const Second& before) {
    return (before.gyro - second_.gyro).cwiseAbs().maxCoeff() < kSteadyGyro &&
           (before.accel - second_.accel).cwiseAbs().maxCoeff() < kSteadyAccel;
  };
  return seconds_.size() == kSeconds && std::all_of(seconds_.begin(), seconds_.end(), agrees);
}

void RestWatch::lengthen() {
  stretch_.seconds.push_back(second_);
  for (std::size_t i = 1; i < fixes_.size(); ++i) {
    const GnssFix &a = fixes_[i - 1], &b = fixes_[i];
    const double sigma = geodesy::horizontal_sigma(b.position_covariance);
    stretch_.way.add(b, sigma);
    const geodesy::LocalFrame frame(a.antenna);
    stretch_.steps.push_back(
        {frame.to_local(b.antenna).head<2>(), seconds_between(a.t_ns, b.t_ns), sigma});
  }
}

/// What follows on rest needs not show it by itself, as long as it does not show motion.
void RestWatch::end_stretch() {
  const std::optional<SteadyWay::Velocity> velocity = stretch_.way.velocity();
  const double sigmas = velocity ? kSigmas * velocity->sigma : 0;
  const bool rests = velocity && velocity->mean.norm() <= std::max(kWander, sigmas) &&
                     (sigmas < kWalk || goes_on_);
  if (!rests || !goes_on_) {
    for (AllanWatch& allan : allan_) allan.interrupt();
  }
  if (rests) take_stretch();
  goes_on_ = rests;
  stretch_ = Stretch();
}

/// Fixes may creep; of their steps the median is that, whatever outliers are among them.
void RestWatch::take_stretch() {
  for (const Second& second : stretch_.seconds) take(second);
  const Rest rest{stretch_.seconds.front().begin_ns, stretch_.seconds.back().end_ns};
  if (goes_on_ && !rests_.empty()) {
    rests_.back().end_ns = rest.end_ns;
  } else {
    rests_.push_back(rest);
  }
  if (stretch_.steps.empty()) return;
  std::vector<double> north, east;
  for (const Step& step : stretch_.steps) {
    north.push_back(step.way.x() / step.time);
    east.push_back(step.way.y() / step.time);
  }
  const Eigen::Vector2d velocity(median(north), median(east));
  for (const Step& step : stretch_.steps) {
    const double left = (step.way - step.time * velocity).norm();
    scatter_.add(left / step.sigma / 2);  // two fixes, two axes
  }
}

void RestWatch::take(const Second& second) {
  ++still_;
  for (int axis = 0; axis < 3; ++axis) gyro_[axis].add(second.gyro[axis]);
  AllanWatch::Vector6d mean;
  mean << second.gyro, second.accel;
  for (AllanWatch& allan : allan_) allan.add(mean);
}

RestFacts RestWatch::facts() const {
  RestWatch all = *this;
  all.end_stretch();
  return all.taken();
}

/// A slow start looks like rest in its first second.
std::vector<Rest> RestWatch::rests() const {
  RestWatch all = *this;
  all.end_stretch();
  std::vector<Rest> rests;
  for (const Rest& rest : all.rests_) {
    const int64_t end_ns = rest.end_ns - kNanosecondsPerSecond;
    if (end_ns > rest.begin_ns) rests.push_back({rest.begin_ns, end_ns});
  }
  return rests;
}

RestFacts RestWatch::taken() const {
  RestFacts facts;
  facts.seconds = still_;
  AllanWatch::Vector6d density = allan_[0].density();
  for (const AllanWatch& allan : allan_) {
    if (allan.knows()) density = density.cwiseMin(allan.density());
  }
  facts.gyro_noise_density = density.head<3>().maxCoeff();
  facts.accel_noise_density = density.tail<3>().maxCoeff();
  for (const FirstValues& axis : gyro_) {
    facts.gyro_mean = std::max(facts.gyro_mean, std::abs(axis.median()));
  }
  facts.fix_scatter = scatter_.median() / 0.8326;  // of a Rayleigh distribution, over sqrt(2)
  facts.fix_pairs = static_cast<int64_t>(scatter_.size());
  return facts;
}

}  // namespace foucault::diagnosis
