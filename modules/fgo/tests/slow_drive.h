#pragma once

#include <functional>

#include "foucault/geodesy/place.h"
#include "foucault/measurement/observation.h"
#include "noisy_drive.h"

/// A drive with things that do not change: a temperature, that ranges depend on, and scale factors.
namespace foucault::testing {

inline constexpr state::Block kTemperature{"temperature", 1, "K"};
inline constexpr double kPerKelvin = 0.1;  // [m/K]
inline constexpr double kRangeSigma = 0.05;

/// Range to a beacon, too long by kPerKelvin times the temperature.
class BeaconRange final : public measurement::Observation {
 public:
  BeaconRange(const Geodetic& beacon, double range) : beacon_(beacon), range_(range) {}

  std::string_view name() const override { return "beacon"; }

  state::Linearized linearize(const state::NavState& x, const measurement::MeanMotion& /*mean*/,
                              const state::Layout& layout) const override {
    const Vector3d way = geodesy::displacement_n(x.position, beacon_, geodesy::Place(x.position));
    const int temperature = *layout.slow_index(kTemperature);
    state::Linearized z(1, layout.size());
    z.r[0] = range_ - way.norm() - kPerKelvin * x.slow[temperature];
    state::columns_of(z.H, state::block::position) = -way.normalized().transpose();
    z.H(0, state::kNodeSize + temperature) = kPerKelvin;
    z.R(0, 0) = kRangeSigma * kRangeSigma;
    return z;
  }

 private:
  Geodetic beacon_;
  double range_;
};

class SlowDrive : public NoisyDrive {
 protected:
  static state::Layout layout() {
    return state::Layout()
        .add(kTemperature, 5)
        .add(state::block::gyro_scale, 3e-3)
        .add(state::block::accel_scale, 3e-3);
  }

  /// Draws what does not change, within its prior.
  void draw_slow() {
    temperature_ = 5 * normal_(rng_);
    scale_.gyro = draw(3e-3);
    scale_.accel = draw(3e-3);
  }

  state::SlowVector slow() const {
    state::SlowVector all(7);
    all << temperature_, scale_.gyro, scale_.accel;
    return all;
  }

  measurement::ObservationPtr range_at(double t) {
    const Geodetic beacon = frame_.to_geodetic({300, 200, -50});
    const Geodetic here = frame_.to_geodetic(motion_.p(t));
    const double range = geodesy::displacement_n(here, beacon, geodesy::Place(here)).norm();
    return std::make_shared<BeaconRange>(
        beacon, range + kPerKelvin * temperature_ + kRangeSigma * normal_(rng_));
  }

  ImuIncrement scaled_increment(int64_t begin_ns, int64_t end_ns) {
    ImuIncrement out = noisy_increment(begin_ns, end_ns);
    out.dtheta_b += scale_.gyro.cwiseProduct(out.dtheta_b);
    out.dvel_b += scale_.accel.cwiseProduct(out.dvel_b);
    return out;
  }

  /// Fixes and ranges every second but in [outage_begin, outage_end).
  void drive(
      measurement::Navigator& navigator, int seconds, int outage_begin, int outage_end,
      const std::function<void()>& each = [] {}) {
    constexpr int64_t kStep = 10'000'000;
    for (int second = 1; second <= seconds; ++second) {
      for (int64_t t = (second - 1) * 1'000'000'000LL; t < second * 1'000'000'000LL; t += kStep)
        navigator.propagate(scaled_increment(t, t + kStep));
      if (second >= outage_begin && second < outage_end) {
        navigator.hold();
      } else {
        navigator.update(measurement::gnss_position(fix_at(second, 0.02)));
        navigator.update(range_at(second));
      }
      each();
    }
  }

  /// Of all blocks.
  state::StateVector whole_error(const state::Epoch& epoch) const {
    state::StateVector e(state::kNodeSize + slow().size());
    e << error(epoch), slow() - epoch.slow;
    return e;
  }

  double temperature_ = 0;
  state::ImuScale scale_;
};

/// Sums of squared errors by their covariance.
struct Consistency {
  double node = 0, temperature = 0, scale = 0, all = 0;
  int runs = 0;

  void add(const state::StateVector& e, const state::Epoch& epoch) {
    const auto part_of = [&](Eigen::Index at, Eigen::Index rows) {
      const Eigen::VectorXd own = e.segment(at, rows);
      const Eigen::MatrixXd P = epoch.covariance.block(at, at, rows, rows);
      return own.dot(P.ldlt().solve(own));
    };
    node += part_of(0, state::kNodeSize);
    temperature += part_of(state::kNodeSize, 1);
    scale += part_of(state::kNodeSize + 1, 6);
    all += part_of(0, e.size());
    ++runs;
  }

  /// 99.9 %.
  void expect_within() const {
    const auto expect = [&](double sum, double rows) {
      EXPECT_NEAR(sum, rows * runs, 3.3 * std::sqrt(2 * rows * runs));
    };
    expect(node, state::kNodeSize);
    expect(temperature, 1);
    expect(scale, 6);
    expect(all, state::kNodeSize + 7);
  }
};

}  // namespace foucault::testing
