#pragma once

#include <Eigen/Core>
#include <vector>

namespace foucault::simulation {

/// Uniform B-spline of degree 5 through 3-D control points: C4, its derivatives exact.
/// Control point k belongs to the time (k - 2) * knot_interval; the spline passes near it, not
/// through it, and lies in the hull of six neighbours. Equal control points give a constant with
/// derivatives that are exactly zero.
class QuinticSpline {
 public:
  /// Value and derivatives by time, in the unit of the control points and seconds.
  struct Sample {
    Eigen::Vector3d value;
    Eigen::Vector3d rate;
    Eigen::Vector3d acceleration;
  };

  static constexpr int kControls = 6;        ///< that act on one interval
  static constexpr int kControlsBefore = 2;  ///< control points before t = 0

  /// knot_interval [s]. Throws std::invalid_argument if it is not positive or if there are fewer
  /// than six control points.
  QuinticSpline(double knot_interval, std::vector<Eigen::Vector3d> controls);

  /// t [s] in [0, duration()]; outside, the polynomial of the nearest interval goes on.
  Sample at(double t) const;

  double duration() const { return knot_interval_ * static_cast<double>(intervals()); }  ///< [s]

  /// Control points that a spline over `duration` [s] needs.
  static std::size_t controls_for(double duration, double knot_interval);

 private:
  std::size_t intervals() const { return controls_.size() - (kControls - 1); }

  double knot_interval_;
  std::vector<Eigen::Vector3d> controls_;
};

}  // namespace foucault::simulation
