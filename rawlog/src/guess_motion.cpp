#include "guess_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "foucault/core/constants.h"
#include "foucault/core/median.h"

namespace foucault::rawlog {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Complex = std::complex<double>;

/// Less likely than this by chance: sure.
constexpr double kChance = 1e-4;
/// Fixes beyond this many are thinned out: more tell little, and take long.
constexpr size_t kMostEpochs = 1200;
/// Below it a course says little [m/s].
constexpr double kSlowest = 0.5;
/// Beyond it a fix jumped, whatever the vehicle [m/s^2, rad/s].
constexpr double kMostAcceleration = 30;
constexpr double kMostTurn = 3;

double wrapped(double angle) { return std::remainder(angle, 2 * kPi); }
double azimuth_of(const Vector3d& v) { return std::atan2(v.y(), v.x()); }

/// Regression of complex numbers y = slope x: real ones give what they would by themselves.
struct Sums {
  Complex xy = 0;
  double xx = 0, yy = 0;
  size_t n = 0;

  /// `independent` of the samples; `degrees`: real numbers in each.
  Regression result(double independent, double degrees, double trials) const {
    Regression r;
    if (xx <= 0 || yy <= 0 || independent < 4) return r;
    r.coherence = std::min(std::norm(xy) / (xx * yy), 1 - 1e-12);
    r.slope = std::abs(xy) / xx;
    r.sigma = r.slope * std::sqrt((1 / r.coherence - 1) / (degrees * independent));
    r.log_chance = (independent - 2) * degrees / 2 * std::log(1 - r.coherence) + std::log(trials);
    return r;
  }
};

/// Integral over time of a series, once (mean rates) and twice.
class Integral {
 public:
  Integral(const std::vector<double>& t, const std::vector<Vector3d>& values)
      : t_(t), once_(t.size()), twice_(t.size()), gaps_(t.size()) {
    const double longest_step = std::max(0.5, 5 * median_step(t));
    for (size_t i = 1; i < t.size(); ++i) {
      const double dt = t[i] - t[i - 1];
      once_[i] = once_[i - 1] + values[i] * dt;
      twice_[i] = twice_[i - 1] + (once_[i - 1] + once_[i]) * (dt / 2);
      gaps_[i] = gaps_[i - 1] + (dt > longest_step ? 1 : 0);
    }
    if (!once_.empty()) once_[0] = twice_[0] = Vector3d::Zero();
  }

  bool covers(double begin, double end) const {
    if (t_.size() < 2 || begin < t_.front() || end > t_.back()) return false;
    return gaps_[index(begin)] == gaps_[index(end)];
  }
  Vector3d once(double t) const { return at(once_, t); }
  Vector3d twice(double t) const {
    const size_t i = index(t);
    const double dt = t - t_[i];
    return twice_[i] + (once_[i] + once(t)) * (dt / 2);
  }

 private:
  /// Of the sample before, not the last.
  size_t index(double t) const {
    const auto next = std::upper_bound(t_.begin(), t_.end(), t);
    const auto i = static_cast<size_t>(next - t_.begin());
    return std::clamp<size_t>(i, 1, t_.size() - 1) - 1;
  }
  Vector3d at(const std::vector<Vector3d>& values, double t) const {
    const size_t i = index(t);
    const double step = t_[i + 1] - t_[i];
    const double part = step > 0 ? (t - t_[i]) / step : 0;
    return values[i] + part * (values[i + 1] - values[i]);
  }

  const std::vector<double>& t_;
  std::vector<Vector3d> once_, twice_;
  std::vector<int> gaps_;
};

/// Fixes at any time between two that are near.
class Track {
 public:
  explicit Track(const FixSeries& fixes)
      : fixes_(fixes), longest_step_(std::max(0.1, 3.5 * median_step(fixes.t))) {}

  std::optional<Vector3d> at(const std::vector<Vector3d>& values, double t) const {
    constexpr double kRound = 1e-6;
    const auto next = std::lower_bound(fixes_.t.begin(), fixes_.t.end(), t - kRound);
    if (next == fixes_.t.end()) return std::nullopt;
    const auto i = static_cast<size_t>(next - fixes_.t.begin());
    if (fixes_.t[i] - t < kRound) return values[i];
    if (i == 0 || fixes_.t[i] - fixes_.t[i - 1] > longest_step_) return std::nullopt;
    const double part = (t - fixes_.t[i - 1]) / (fixes_.t[i] - fixes_.t[i - 1]);
    return Vector3d(values[i - 1] + part * (values[i] - values[i - 1]));
  }

 private:
  const FixSeries& fixes_;
  double longest_step_;
};

/// What fixes say of one instant.
struct Epoch {
  double t = 0;
  Complex force;     ///< forward + i right [m/s^2]
  double climb = 0;  ///< gravity's part along the track, which is felt too [m/s^2]
  double turn = 0;   ///< course rate, clockwise [rad/s]
};

/// What differs by the source of velocities: how a window of the IMU is weighted.
struct Window {
  double length = 1;  ///< [s]
  bool doppler = false;

  double reach() const { return doppler ? length / 2 : length; }
  Vector3d mean(const Integral& integral, double t) const {
    const double h = reach();
    if (doppler) return (integral.once(t + h) - integral.once(t - h)) / length;
    return (integral.twice(t + h) - 2 * integral.twice(t) + integral.twice(t - h)) / (h * h);
  }
};

/// Velocities before and after an instant, and at it.
struct Ways {
  Vector3d before, after, now;
};

std::optional<Ways> ways_at(const Track& track, const FixSeries& fixes, double t,
                            const Window& window) {
  const double h = window.reach();
  const auto& values = window.doppler ? fixes.velocity : fixes.p;
  const auto before = track.at(values, t - h), now = track.at(values, t),
             after = track.at(values, t + h);
  if (!before || !now || !after) return std::nullopt;
  if (window.doppler) return Ways{*before, *after, *now};
  return Ways{(*now - *before) / h, (*after - *now) / h, (*after - *before) / (2 * h)};
}

std::optional<Epoch> epoch_of(const Ways& ways, double t, const Window& window, double slowest) {
  const Vector2d before = ways.before.head<2>(), now = ways.now.head<2>(),
                 after = ways.after.head<2>();
  if (std::min({before.norm(), now.norm(), after.norm()}) < slowest) return std::nullopt;
  const Vector2d along = now.normalized();
  const Vector2d a = (after - before) / window.length;
  Epoch epoch;
  epoch.t = t;
  epoch.force = {a.dot(along), along.x() * a.y() - along.y() * a.x()};
  epoch.climb = -kStandardGravity * ways.now.z() / ways.now.norm();
  epoch.turn = wrapped(azimuth_of(ways.after) - azimuth_of(ways.before)) / window.length;
  if (a.norm() > kMostAcceleration || std::abs(epoch.turn) > kMostTurn) return std::nullopt;
  return epoch;
}

std::vector<Epoch> epochs_of(const FixSeries& fixes, const Window& window, double slowest) {
  std::vector<Epoch> epochs;
  const Track track(fixes);
  const size_t step = fixes.t.size() / kMostEpochs + 1;
  for (size_t i = 0; i < fixes.t.size(); i += step) {
    const std::optional<Ways> ways = ways_at(track, fixes, fixes.t[i], window);
    if (!ways) continue;
    if (const auto epoch = epoch_of(*ways, fixes.t[i], window, slowest)) epochs.push_back(*epoch);
  }
  return epochs;
}

/// How the vehicle feels its motion.
struct Feel {
  bool leaning;   ///< into turns, as motorcycles and aircraft do: nothing to the side
  bool climbing;  ///< heights are good enough to say what gravity does along the track

  Complex of(const Epoch& epoch) const {
    return {epoch.force.real() + (climbing ? epoch.climb : 0), leaning ? 0 : epoch.force.imag()};
  }
};
constexpr Feel kFeels[] = {{false, false}, {false, true}, {true, false}, {true, true}};

/// What IMU and fixes have of the same instants.
struct Instants {
  std::vector<Complex> felt;  ///< along the level axes
  std::vector<double> rate;   ///< about up
  std::vector<Epoch> epochs;
  double independent = 0;  ///< as many as windows that do not overlap
};

Instants instants_at(const Integral& gyro, const Integral& accel, const std::vector<Epoch>& epochs,
                     const Window& window, const Vector3d& up, double lag) {
  Instants instants;
  const LevelAxes level = level_axes(up, 0);
  double last = -std::numeric_limits<double>::infinity();
  for (const Epoch& epoch : epochs) {
    const double t = epoch.t + lag;
    if (!accel.covers(t - window.reach(), t + window.reach())) continue;
    const Vector3d f = window.mean(accel, t);
    instants.felt.emplace_back(f.dot(level.first), f.dot(level.second));
    instants.rate.push_back(window.mean(gyro, t).dot(up));
    instants.epochs.push_back(epoch);
    instants.independent += std::min(1.0, (epoch.t - last) / window.length);
    last = epoch.t;
  }
  return instants;
}

template <class Value>
void take_mean(std::vector<Value>& values) {
  Value sum = 0;
  for (const Value& value : values) sum += value;
  for (Value& value : values) value -= sum / static_cast<double>(values.size());
}

Sums sums_of(const std::vector<Complex>& x, const std::vector<Complex>& y) {
  Sums sums;
  for (size_t i = 0; i < x.size(); ++i) {
    sums.xy += y[i] * std::conj(x[i]);
    sums.xx += std::norm(x[i]);
    sums.yy += std::norm(y[i]);
  }
  return sums;
}

/// The force as it is seen, or its mirror image, against what is felt.
ForceMatch force_match(std::vector<Complex> seen, const std::vector<Complex>& felt, bool mirrored,
                       double independent, double trials) {
  if (mirrored) {
    for (Complex& a : seen) a = std::conj(a);
  }
  const Sums all = sums_of(seen, felt);
  ForceMatch match;
  match.regression = all.result(independent, 2, trials);
  // felt = conj(a) e^(i arg); turned over it is -conj(felt) = a e^(i (pi - arg)) on level axes
  // there
  match.forward = mirrored ? wrapped(kPi - std::arg(all.xy)) : std::arg(all.xy);
  return match;
}

MotionMatch match_of(const Instants& instants, const Feel& feel, double lag, double trials) {
  MotionMatch match;
  match.lag = lag;
  match.samples = instants.felt.size();
  if (instants.felt.empty()) return match;
  std::vector<Complex> felt = instants.felt, seen, rate, turn;
  for (size_t i = 0; i < felt.size(); ++i) {
    seen.push_back(feel.of(instants.epochs[i]));
    turn.emplace_back(-instants.epochs[i].turn);
    rate.emplace_back(instants.rate[i]);
  }
  for (std::vector<Complex>* values : {&felt, &seen, &rate, &turn}) take_mean(*values);
  match.force = force_match(seen, felt, false, instants.independent, trials);
  match.mirrored = force_match(seen, felt, true, instants.independent, trials);
  const Sums turns = sums_of(rate, turn);
  match.turn = turns.result(instants.independent, 1, trials);
  if (turns.xy.real() < 0) match.turn.slope *= -1;
  return match;
}

/// Of the forces that agree with the turns' sign, where they have one.
double log_chance(const MotionMatch& match) {
  const double force = match.force.regression.log_chance;
  const double mirrored = match.mirrored.regression.log_chance;
  if (!match.turn.is_sure()) return std::min(force, mirrored) + match.turn.log_chance;
  return (match.turn.slope < 0 ? mirrored : force) + match.turn.log_chance;
}

/// The best match of each quarter of the circle that forward may be in.
class Quarters {
 public:
  void take(const MotionMatch& match) {
    const double forward = is_reversed(match) ? match.mirrored.forward : match.force.forward;
    if (!std::isfinite(forward)) return;
    const auto quarter = static_cast<size_t>(std::lround(forward / (kPi / 2)) + 4) % 4;
    std::optional<MotionMatch>& best = best_[quarter];
    if (!best || log_chance(match) < log_chance(*best)) best = match;
  }

  /// What is felt comes back after the period of a vehicle's accelerations, turned over: another
  /// lag says another quarter. The lead over that is what counts.
  std::optional<MotionMatch> best() const {
    std::optional<MotionMatch> best;
    double second = std::numeric_limits<double>::infinity();
    for (const std::optional<MotionMatch>& match : best_) {
      if (!match) continue;
      const double before = best ? log_chance(*best) : second;
      const bool better = !best || log_chance(*match) < before;
      second = std::min(second, better ? before : log_chance(*match));
      if (better) best = match;
    }
    if (best) best->lead = second - log_chance(*best);
    return best;
  }

 private:
  static bool is_reversed(const MotionMatch& match) {
    if (match.turn.is_sure()) return match.turn.slope < 0;
    return match.mirrored.regression.log_chance < match.force.regression.log_chance;
  }

  std::array<std::optional<MotionMatch>, 4> best_;
};

/// Clocks that are nearly right, and those that are off by the leap seconds of GPS.
std::vector<double> lags() {
  constexpr double kStep = 0.1, kNear = 2.5, kLeapFrom = 15.6, kLeapTo = 18.5;
  std::vector<double> lags;
  for (double lag = -kNear; lag < kNear + kStep / 2; lag += kStep) lags.push_back(lag);
  for (double lag = kLeapFrom; lag < kLeapTo; lag += 2 * kStep) {
    lags.push_back(lag);
    lags.push_back(-lag);
  }
  return lags;
}

}  // namespace

bool drop_ahead(std::vector<double>& stamps, double t, size_t most) {
  size_t kept = stamps.size();
  while (kept > 0 && stamps[kept - 1] > t) --kept;
  if (stamps.size() - kept > most) return false;
  stamps.resize(kept);
  return true;
}

double scatter_of(const std::vector<Vector3d>& values) {
  std::vector<double> bends;
  for (size_t i = 2; i < values.size(); ++i) {
    // of two axes, each with the sum of squares of 1, 2, 1
    const double bend = (values[i] - 2 * values[i - 1] + values[i - 2]).head<2>().norm();
    if (std::isfinite(bend)) bends.push_back(bend / std::sqrt(12.0));
  }
  return bends.empty() ? 0 : median(bends);
}

double median_step(const std::vector<double>& t) {
  std::vector<double> steps;
  for (size_t i = 1; i < t.size(); ++i) {
    if (t[i] > t[i - 1]) steps.push_back(t[i] - t[i - 1]);
  }
  return steps.empty() ? 0 : median(steps);
}

std::optional<Gravity> gravity_of(const ImuSeries& imu) {
  constexpr double kWindow = 1;
  std::vector<double> norms;
  Vector3d sum = Vector3d::Zero(), all = Vector3d::Zero();
  size_t count = 0;
  double begin = imu.t.empty() ? 0 : imu.t.front();
  for (size_t i = 0; i < imu.t.size(); ++i) {
    sum += imu.accel[i];
    all += imu.accel[i];
    ++count;
    if (imu.t[i] - begin < kWindow && i + 1 < imu.t.size()) continue;
    norms.push_back((sum / static_cast<double>(count)).norm());
    sum.setZero();
    count = 0;
    begin = imu.t[i];
  }
  if (norms.empty() || all.norm() == 0 || !std::isfinite(all.norm())) return std::nullopt;
  Gravity gravity;
  gravity.norm = median(norms);
  for (double& norm : norms) norm = std::abs(norm - gravity.norm);
  gravity.spread = median(norms) / std::max(gravity.norm, 1e-300);
  gravity.up = all.normalized();
  return gravity;
}

bool Regression::is_sure() const { return log_chance < std::log(kChance); }

Regression tilt_match(const ImuSeries& imu) {
  constexpr double kWindow = 0.3;  ///< over vibration, under the periods of turns
  const Integral gyro(imu.t, imu.gyro), accel(imu.t, imu.accel);
  Sums sums;
  if (imu.t.size() < 10) return {};
  const double h = std::max(kWindow, 3 * median_step(imu.t));
  double last = -std::numeric_limits<double>::infinity();
  for (const double t : imu.t) {
    if (t - last < h || !accel.covers(t - 1.5 * h, t + 1.5 * h)) continue;
    last = t;
    const Vector3d before = accel.once(t - h / 2) - accel.once(t - 1.5 * h);
    const Vector3d after = accel.once(t + 1.5 * h) - accel.once(t + h / 2);
    const Vector3d angle = gyro.once(t + h) - gyro.once(t - h);
    const double norm = (before + after).norm() / 2;
    if (norm == 0) continue;
    const Vector3d seen = (after - before) / norm;
    const Vector3d felt = -angle.cross((before + after) / (2 * norm));
    sums.xy += felt.dot(seen);
    sums.xx += felt.squaredNorm();
    sums.yy += seen.squaredNorm();
    ++sums.n;
  }
  Regression r = sums.result(static_cast<double>(sums.n), 1, 1);
  if (sums.xy.real() < 0) r = {};  // gravity turns against the sensor, or it is not gravity
  return r;
}

std::optional<MotionMatch> match_motion(const ImuSeries& imu, const FixSeries& fixes,
                                        const Vector3d& up) {
  if (imu.t.size() < 10 || fixes.t.size() < 5) return std::nullopt;
  const Integral gyro(imu.t, imu.gyro), accel(imu.t, imu.accel);
  const double shortest = std::max(1.0, std::round(median_step(fixes.t) * 1e3) / 1e3);
  const std::vector<double> all_lags = lags();
  Quarters quarters;
  for (const bool doppler : {true, false}) {
    if (doppler && fixes.velocity.empty()) continue;
    for (const double length : {shortest, 2 * shortest, 4 * shortest}) {
      const Window window{length, doppler};
      const double scatter = doppler ? scatter_of(fixes.velocity) : scatter_of(fixes.p) / length;
      const double slowest = std::max(kSlowest, 4 * scatter);
      const std::vector<Epoch> epochs = epochs_of(fixes, window, slowest);
      const double trials = 24 * static_cast<double>(all_lags.size());
      for (const double lag : all_lags) {
        const Instants instants = instants_at(gyro, accel, epochs, window, up, lag);
        for (const Feel& feel : kFeels) {
          quarters.take(match_of(instants, feel, lag, trials));
        }
      }
    }
  }
  return quarters.best();
}

LevelAxes level_axes(const Vector3d& up, int first) {
  const Vector3d down = -up;
  Vector3d axis = Vector3d::Unit(first);
  if (std::abs(axis.dot(down)) > 0.9) axis = Vector3d::Unit((first + 1) % 3);
  LevelAxes level;
  level.first = (axis - axis.dot(down) * down).normalized();
  level.second = down.cross(level.first);
  return level;
}

NearestAxis nearest_axis(const Vector3d& direction) {
  NearestAxis nearest;
  direction.cwiseAbs().maxCoeff(&nearest.axis);
  nearest.sign = direction[nearest.axis] < 0 ? -1 : 1;
  nearest.angle = std::acos(std::min(1.0, std::abs(direction[nearest.axis]) / direction.norm()));
  return nearest;
}

}  // namespace foucault::rawlog
