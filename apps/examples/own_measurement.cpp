/// A measurement of your own, in every estimator: the distance to a beacon. Fixes end after 20 s;
/// ranges to two beacons are what is left. Prints how far each estimator is off 40 s later;
/// smoothers know what was measured afterwards. `own_measurement none`: without ranges.

#include <cstdio>
#include <memory>
#include <optional>
#include <random>

#include "foucault/core/time.h"
#include "foucault/ekf/rts.h"
#include "foucault/fgo/batch.h"
#include "foucault/fgo/window_navigator.h"
#include "foucault/geodesy/place.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/simulation/simulated_source.h"

using namespace foucault;
using preintegration::PreintegrationModel;

constexpr int kFixesEnd = 20, kLooked = 60, kEnd = 80;  // [s]
constexpr double kSigma = 0.05;                         // of a range [m]

Eigen::Vector3d way(const Geodetic& from, const Geodetic& to) {
  return geodesy::displacement_n(from, to, geodesy::Place(from));
}

/// All that a new measurement is: how it is predicted, and how that changes with the state.
struct BeaconRange final : measurement::Observation {
  BeaconRange(const Geodetic& place, double distance) : beacon(place), range(distance) {}
  std::string_view name() const override { return "beacon_range"; }
  state::Linearized linearize(const state::NavState& x, const measurement::MeanMotion&,
                              const state::Layout& layout) const override {
    const Eigen::Vector3d way_n = way(x.position, beacon);
    state::Linearized z(1, layout.size());
    z.r[0] = range - way_n.norm();
    state::columns_of(z.H, state::block::position) = -way_n.normalized().transpose();
    z.R(0, 0) = kSigma * kSigma;
    return z;
  }
  Geodetic beacon;
  double range;
};

/// Drives an estimator through the trip and prints how far it is off at kLooked.
void drive(const char* name, measurement::Navigator& navigator, bool with_ranges) {
  simulation::ScenarioOptions trip;
  trip.rest_s = 5;
  trip.duration_s = kEnd;
  simulation::SimulatedSource source(trip, imu::imu_preset("ICM20602"));
  state::Epoch start = source.truth(trip.start_ns());  // alignment::Aligner finds one from data
  start.covariance.diagonal().setConstant(1e-4);
  navigator.start(start);
  std::mt19937 random(1);
  std::normal_distribution<double> error(0, kSigma);
  state::NavState truth, estimate;
  for (std::optional<GnssFix> fix; const auto m = source.next();) {
    if (const auto* received = std::get_if<GnssFix>(&*m)) fix = *received;
    const auto* increment = std::get_if<ImuIncrement>(&*m);
    if (increment != nullptr) navigator.propagate(*increment);
    if (increment == nullptr || !fix || fix->t_ns != increment->t_end_ns) continue;
    const state::NavState now = source.truth(fix->t_ns);
    const double t = seconds_between(trip.start_ns(), fix->t_ns);
    if (t <= kFixesEnd) navigator.update(measurement::gnss_position(*fix));
    for (const Eigen::Vector3d& p_n : {Eigen::Vector3d(200, 150, -30), {-150, 200, -30}}) {
      const Geodetic beacon =
          geodesy::displaced(start.position, p_n, geodesy::Place(start.position));
      const double range = way(now.position, beacon).norm() + error(random);
      if (with_ranges) navigator.update(std::make_shared<BeaconRange>(beacon, range));
    }
    navigator.hold();  // graphs want a node now and then, measured or not
    if (t == kLooked) truth = now, estimate = navigator.epoch();
  }
  if (auto* recording = dynamic_cast<measurement::Recording*>(&navigator))
    estimate = recording->smoothed()[kLooked].state;  // a node a second
  std::printf("%s,%.4f\n", name, way(truth.position, estimate.position).head<2>().norm());
}

int main(int argc, char** /*argv*/) {
  const imu::ImuNoise noise = imu::imu_preset("ICM20602");
  const state::Layout blocks;  // and one of your own: blocks.add({"temperature", 1, "K"}, 5)
  ekf::EkfNavigator filter(noise, blocks, {});
  fgo::WindowNavigator refined({}, PreintegrationModel::refined, noise, blocks);
  fgo::WindowNavigator rough({}, PreintegrationModel::rough, noise, blocks);
  fgo::WindowNavigator full({}, PreintegrationModel::full, noise, blocks);
  ekf::RtsRecorder rts(noise, blocks, {});
  fgo::BatchRecorder batch(std::make_unique<ekf::EkfNavigator>(noise, blocks, ekf::EkfOptions()),
                           {}, PreintegrationModel::full, noise, blocks);
  const bool with_ranges = argc == 1;
  drive("ekf", filter, with_ranges);
  drive("refined", refined, with_ranges);
  drive("rough", rough, with_ranges);
  drive("full", full, with_ranges);
  drive("rts", rts, with_ranges);
  drive("batch", batch, with_ranges);
}
