#include "foucault/methods/methods.h"

#include <gtest/gtest.h>

#include <map>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/measurement/observation.h"
#include "foucault/simulation/simulated_source.h"

namespace foucault::methods {
namespace {

TEST(Methods, AnUnknownOneIsToldTheKnownOnes) {
  EXPECT_EQ(names(), "batch, rts, ekf, refined, rough, full");
  try {
    find("kalman");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()), "unknown method 'kalman'; known: " + names());
  }
}

TEST(Methods, AGraphWantsNoise) {
  state::Sink sink;
  EXPECT_THROW(find("batch").make({}, sink), UsageError);
}

/// Where the IMU is, to 5 cm.
struct Position final : measurement::Observation {
  explicit Position(const Geodetic& place) : p(place) {}
  std::string_view name() const override { return "position"; }
  state::Linearized linearize(const state::NavState& x, const measurement::MeanMotion&,
                              const state::Layout& layout) const override {
    state::Linearized z(3, layout.size());
    z.r = geodesy::ned_offset(x.position, p);
    state::columns_of(z.H, state::block::position).setIdentity();
    z.R = 25e-4 * Eigen::Matrix3d::Identity();
    return z;
  }
  Geodetic p;
};

struct Epochs : state::Sink {
  void epoch(const state::Epoch& e) override { positions[e.t_ns] = e.position; }
  void observation(const state::ObservationResult& o) override { used += o.used; }
  std::map<int64_t, Geodetic> positions;
  int used = 0;
};

constexpr double kOutage = 150, kLooked = 195, kEnd = 200;  // [s]

/// Without fixes from kOutage on, with the truth as a measurement of one's own in place of them or
/// not: how far off at kLooked [m].
double off(const std::string& method, bool measured) {
  simulation::ScenarioOptions trip;
  trip.duration_s = kEnd;
  trip.imu_rate_hz = 50;
  trip.reference_rate_hz = 0;
  MethodOptions options;
  options.run.imu = imu::imu_preset("ICM20602");
  simulation::SimulatedSource source(trip, options.run.imu);
  Epochs epochs;
  const std::unique_ptr<navigation::Run> run = find(method).make(options, epochs);
  while (const std::optional<Measurement> m = source.next()) {
    const auto* fix = std::get_if<GnssFix>(&*m);
    const bool outage = seconds_between(trip.start_ns(), stamp(*m)) > kOutage;
    if (!fix || !outage) run->process(*m);
    if (!fix || !outage || !measured) continue;
    const Geodetic here = source.truth(fix->t_ns).position;
    run->observe(fix->t_ns, std::make_shared<Position>(here));
  }
  run->finish();
  EXPECT_EQ(epochs.used, measured ? kEnd - kOutage : 0) << method;
  const int64_t looked_ns = trip.start_ns() + nanoseconds(kLooked);
  const Geodetic truth = source.truth(looked_ns).position;
  return geodesy::ned_offset(truth, epochs.positions.at(looked_ns)).norm();
}

/// 45 s of a consumer IMU against positions of 5 cm that have no error.
TEST(Methods, AllUseAMeasurementOfOnesOwn) {
  for (const Method& method : all()) {
    EXPECT_LT(off(method.name, true), 0.05) << method.name;
    EXPECT_GT(off(method.name, false), 1) << method.name;
  }
}

}  // namespace
}  // namespace foucault::methods
