#pragma once

#include <memory>
#include <optional>
#include <variant>

#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/state/interfaces.h"

/// A recording and an estimator whose drifts are known exactly.
namespace foucault::test {

inline const Geodetic kHome{0.84, 0.2, 500};
inline const Eigen::Vector3d kLeverArm(0.1, -0.3, -0.8);

inline constexpr double kFixSigma = 0.3;       // [m]
inline constexpr double kEstimateSigma = 0.4;  // [m]

/// A vehicle at rest at kHome: fixes of its antenna at 2 Hz, references at 4 Hz, IMU at 4 Hz.
class RestSource : public state::Source {
 public:
  RestSource(double duration_s, bool with_reference)
      : end_(static_cast<int>(4 * duration_s)), with_reference_(with_reference) {}

  std::optional<Measurement> next() override {
    while (tick_ <= end_) {
      const int64_t t_ns = tick_ * 250'000'000LL;
      const int kind = kind_++ % 3;
      if (kind == 2) ++tick_;
      if (kind == 0 && tick_ % 2 == 0) return fix(t_ns);
      if (kind == 1 && with_reference_) return reference(t_ns);
      if (kind == 2) return increment(t_ns);
    }
    return std::nullopt;
  }
  const state::Mounting& mounting() const override { return mounting_; }
  double progress() const override { return static_cast<double>(tick_) / end_; }

 private:
  static GnssFix fix(int64_t t_ns) {
    GnssFix fix;
    fix.t_ns = t_ns;
    fix.antenna = geodesy::LocalFrame(kHome).to_geodetic(kLeverArm);
    fix.position_covariance = kFixSigma * kFixSigma * Eigen::Matrix3d::Identity();
    fix.p_b_a = kLeverArm;
    return fix;
  }
  static ReferencePose reference(int64_t t_ns) {
    ReferencePose pose;
    pose.t_ns = t_ns;
    pose.position = kHome;
    return pose;
  }
  static ImuIncrement increment(int64_t t_ns) {
    ImuIncrement increment;
    increment.t_begin_ns = t_ns - 250'000'000;
    increment.t_end_ns = t_ns;
    return increment;
  }

  int end_;
  bool with_reference_;
  int tick_ = 0;
  int kind_ = 0;
  state::Mounting mounting_;
};

/// Drifts north by `scale` times 0.01 m/s^2 t^2 and down by 0.1 m/s t since its last fix, and says
/// that each of its positions has kEstimateSigma.
class DriftingEstimator : public state::Estimator {
 public:
  explicit DriftingEstimator(state::Sink& sink, double scale = 1) : sink_(sink), scale_(scale) {}

  void process(const Measurement& measurement) override {
    if (const auto* fix = std::get_if<GnssFix>(&measurement)) last_fix_ns_ = fix->t_ns;
    if (std::holds_alternative<ImuIncrement>(measurement)) emit(stamp(measurement));
  }
  void finish() override {}

 private:
  void emit(int64_t t_ns) {
    const double t = seconds_between(last_fix_ns_, t_ns);
    state::Epoch epoch;
    epoch.t_ns = t_ns;
    epoch.position = geodesy::LocalFrame(kHome).to_geodetic({scale_ * 0.01 * t * t, 0, 0.1 * t});
    epoch.covariance.diagonal().head<3>().setConstant(kEstimateSigma * kEstimateSigma);
    sink_.epoch(epoch);
  }

  state::Sink& sink_;
  double scale_;
  int64_t last_fix_ns_ = 0;
};

}  // namespace foucault::test
