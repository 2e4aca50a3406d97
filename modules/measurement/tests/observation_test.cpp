#include "foucault/measurement/observation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/geodesy/place.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/measurement/gnss_velocity.h"
#include "foucault/measurement/heading.h"
#include "foucault/measurement/nonholonomic.h"
#include "foucault/measurement/predicted.h"
#include "foucault/measurement/wheel_speed.h"
#include "foucault/measurement/zero_rate.h"
#include "foucault/measurement/zero_velocity.h"
#include "foucault/simulation/scenario.h"

namespace foucault::measurement {
namespace {

constexpr double kEarthRadius = 6.3e6;  ///< [m], less than any
constexpr double kMostLever = 2;        ///< [m]
constexpr double kMostRate = 3;         ///< [rad/s]

double between(std::mt19937& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

Eigen::Vector3d draw3(std::mt19937& rng) {
  return Eigen::Vector3d::NullaryExpr([&] { return between(rng, -1, 1); });
}

Eigen::Matrix3d random_covariance(std::mt19937& rng) {
  Eigen::Matrix3d root;
  for (int i = 0; i < 3; ++i) root.col(i) = draw3(rng);
  const Eigen::Matrix3d m = root * root.transpose() + 0.1 * Eigen::Matrix3d::Identity();
  return 0.5 * (m + m.transpose());
}

/// Seen by no observation but the beacon's.
constexpr state::Block kTemperature{"temperature", 1, "K"};

/// A distance from the antenna to a beacon, off by metres per kelvin of a block that no program
/// has: range = |p_beacon - p - C l| + k T.
class BeaconRange final : public Observation {
 public:
  static constexpr double kMetresPerKelvin = 0.3;

  BeaconRange(const Geodetic& beacon, const Eigen::Vector3d& p_b_a, double range)
      : beacon_e_(geodesy::wgs84::geodetic_to_ecef(beacon)), p_b_a_(p_b_a), range_(range) {}

  std::string_view name() const override { return "beacon_range"; }

  state::Linearized linearize(const state::NavState& x, const MeanMotion& /*mean*/,
                              const state::Layout& layout) const override {
    const Eigen::Matrix3d R_e_n = geodesy::wgs84::R_e_n(x.position.latitude, x.position.longitude);
    const Eigen::Matrix3d C = x.q_n_b.toRotationMatrix();
    const Eigen::Vector3d to_beacon_n =
        R_e_n.transpose() * (beacon_e_ - geodesy::wgs84::geodetic_to_ecef(x.position)) - C * p_b_a_;
    const Eigen::RowVector3d away = -to_beacon_n.normalized();
    state::Linearized z(1, layout.size());
    z.r[0] = range_ - to_beacon_n.norm();
    state::columns_of(z.H, state::block::position) = away;
    state::columns_of(z.H, state::block::attitude) = -away * C * so3::skew(p_b_a_);
    z.R(0, 0) = 0.01;
    if (const state::SlowBlock* temperature = layout.find(kTemperature)) {
      z.r[0] -= kMetresPerKelvin * x.slow[temperature->index];
      state::columns_of(z.H, *temperature).setConstant(kMetresPerKelvin);
    }
    return z;
  }

 private:
  Eigen::Vector3d beacon_e_;
  Eigen::Vector3d p_b_a_;
  double range_;
};

/// A fix some decimetres and decimetres per second off, of any lever arm.
GnssFix random_fix(const state::NavState& x, std::mt19937& rng) {
  GnssFix fix;
  fix.p_b_a = between(rng, 0, kMostLever) * draw3(rng).normalized();
  fix.antenna = geodesy::displaced(x.position, x.q_n_b * fix.p_b_a + 0.3 * draw3(rng),
                                   geodesy::Place(x.position));
  fix.velocity_n = x.velocity_n + draw3(rng);
  fix.since_first_s = between(rng, 0, 10);
  fix.position_covariance = random_covariance(rng);
  fix.velocity_covariance = random_covariance(rng);
  return fix;
}

ObservationPtr random_beacon(const state::NavState& x, std::mt19937& rng) {
  const Eigen::Vector3d way_n = between(rng, 50, 500) * draw3(rng).normalized();
  const Geodetic beacon = geodesy::displaced(x.position, way_n, geodesy::Place(x.position));
  return std::make_shared<BeaconRange>(beacon, kMostLever * draw3(rng).normalized(),
                                       between(rng, 50, 500));
}

/// Half a second of turning and accelerating, with biases near those of the state.
BodyStretch random_stretch(const state::NavState& x, std::mt19937& rng) {
  BodyStretchBuilder builder;
  builder.start(0, {x.bias.gyro + 1e-3 * draw3(rng), x.bias.accel + 1e-2 * draw3(rng)});
  for (int i = 0; i < 10; ++i) {
    ImuIncrement increment;
    increment.t_begin_ns = i * 50'000'000;
    increment.t_end_ns = increment.t_begin_ns + 50'000'000;
    increment.dtheta_b = 0.05 * draw3(rng);
    increment.dvel_b = 0.5 * draw3(rng);
    builder.add(increment);
    builder.mark();
  }
  return *builder.stretch();
}

Eigen::Quaterniond random_mounting(std::mt19937& rng) { return so3::exp(3 * draw3(rng)); }

/// Of a baseline that is not steep, wherever it was a tenth of a second ago: its azimuth would tell
/// little and bend much.
ObservationPtr random_heading(const state::NavState& x, std::mt19937& rng) {
  const Eigen::Quaterniond q_v_b = random_mounting(rng);
  GnssFix fix = random_fix(x, rng);
  fix.heading = GnssHeading{between(rng, -kPi, kPi), 0.01, 0};
  fix.since_first_s = 0.2;
  double down = 1;
  while (std::abs(down) > 0.4) {
    double& baseline = fix.heading->baseline;
    baseline = between(rng, -kPi, kPi);
    down =
        (x.q_n_b * (q_v_b.conjugate() * Eigen::Vector3d(std::cos(baseline), std::sin(baseline), 0)))
            .z();
  }
  return std::make_shared<Heading>(fix, q_v_b);
}

/// Every slow block there is; a new one is one line here.
state::Layout every_block() {
  state::Layout layout;
  layout.add(state::block::accel_scale, 1e-3)
      .add(state::block::time_offset, 0.3)
      .add(kTemperature, 5)
      .add(state::block::lever_arm, 1)
      .add(state::block::gyro_scale, 1e-3)
      .add(state::block::time_drift, 0.1)
      .add(state::block::mounting, 0.2)
      .add(state::block::cornering_compliance, 0.005)
      .add(state::block::wheel_scale, 0.05);
  return layout;
}

/// All there is. A new observation is one line here; EveryObservationHasALine asks for it.
struct Kind {
  std::string name;
  std::function<ObservationPtr(const state::NavState&, std::mt19937&)> make;
};
const std::vector<Kind> kKinds = {
    {"gnss_position", [](const auto& x, auto& rng) { return gnss_position(random_fix(x, rng)); }},
    {"gnss_velocity", [](const auto& x, auto& rng) { return gnss_velocity(random_fix(x, rng)); }},
    {"beacon_range", random_beacon},
    {"predicted",
     [](const auto& x, auto& rng) {
       const ObservationPtr sound = random_beacon(x, rng);
       return predicted("predicted", 0, 0.1, [sound](const state::NavState& at) {
         return -sound->linearize(at, {}, {}).r[0];
       });
     }},
    {"predicted_values",
     [](const auto& x, auto& rng) {
       const ObservationPtr sound = gnss_velocity(random_fix(x, rng));
       return predicted("predicted_values", Predicted::Values::Zero(3), 0.1,
                        [sound](const state::NavState& at) -> Predicted::Values {
                          return -sound->linearize(at, {}, {}).r;
                        });
     }},
    {"nonholonomic",
     [](const auto& x, auto& rng) {
       return std::make_shared<Nonholonomic>(random_stretch(x, rng), random_mounting(rng),
                                             Eigen::Vector2d(0.1, 0.2));
     }},
    {"wheel_speed",
     [](const auto& x, auto& rng) {
       return std::make_shared<WheelSpeedMean>(random_stretch(x, rng), random_mounting(rng), 20,
                                               0.02);
     }},
    {"heading", random_heading},
    {"zero_velocity", [](const auto&, auto&) { return std::make_shared<ZeroVelocity>(0.02); }},
    {"zero_rate",
     [](const auto&, auto& rng) { return std::make_shared<ZeroRate>(draw3(rng), 1e-4); }},
};

/// Latitudes to +-80 deg, velocities to 250 m/s, any attitude, scale factors of several per cent.
state::NavState random_state(std::mt19937& rng, const state::Layout& layout) {
  state::NavState x;
  x.position = {between(rng, -80, 80) * kDegree, between(rng, -kPi, kPi), between(rng, -100, 12e3)};
  x.velocity_n = between(rng, 0, 250) * draw3(rng).normalized();
  x.q_n_b = so3::exp(between(rng, 0, kPi) * draw3(rng).normalized());
  x.bias = {0.1 * draw3(rng), 0.5 * draw3(rng)};
  x.slow =
      0.1 * state::SlowVector::NullaryExpr(layout.slow_size(), [&] { return between(rng, -1, 1); });
  return x;
}

/// An observation at a state, and the rate there.
struct Sample {
  state::NavState x;
  MeanMotion mean;
  ObservationPtr observation;
};

Sample random_sample(const Kind& kind, const state::Layout& layout, std::mt19937& rng) {
  Sample s;
  s.x = random_state(rng, layout);
  s.mean = {kMostRate * draw3(rng), 20 * draw3(rng)};
  s.observation = kind.make(s.x, rng);
  return s;
}

/// d predicted / d error by central differences, of which those of twice the step take off the
/// third derivatives: r is minus the prediction.
state::StateVector gradient_by_differences(const Sample& s, const state::Layout& layout, int row) {
  state::StateVector gradient(layout.size());
  for (int i = 0; i < layout.size(); ++i) {
    const double h = i < state::block::position.size ? 0.1 : 1e-4;
    const state::StateVector step = h * state::StateVector::Unit(layout.size(), i);
    const auto r = [&](const state::StateVector& error) {
      return s.observation->linearize(state::boxplus(s.x, error), s.mean, layout).r[row];
    };
    gradient[i] = (8 * (r(-step) - r(step)) - (r(-2 * step) - r(2 * step))) / (12 * h);
  }
  return gradient;
}

/// What differences may be off by.
/// Position, steps of 0.1 m: coordinates rounded by 3 nm each, over the step, 1e-7; third
/// derivatives of a range of 50 m or more, 3 / 50^2, times h^2 / 6 are 2e-6; and the north and east
/// that turn with the place, (1 + tan(latitude)) / R times the lever arm and the fix's error, which
/// H leaves out.
/// All others, steps h of 1e-4: rounding of 10 km/s (a bend's k u^2 omega), 2e-12 over the step, is
/// 2e-8, fifth derivatives are less; 5e-7 is what is asked for.
state::StateVector tolerance(const Sample& s, const state::Layout& layout) {
  const double turning = (1 + std::tan(std::abs(s.x.position.latitude))) / kEarthRadius;
  state::StateVector tolerance = state::StateVector::Constant(layout.size(), 5e-7);
  state::part(tolerance, state::block::position).setConstant(3e-6 + (kMostLever + 1) * turning);
  return tolerance;
}

/// Largest error of H by its tolerance.
double worst_of(const Sample& s, const state::Layout& layout) {
  const state::Linearized z = s.observation->linearize(s.x, s.mean, layout);
  if (z.H.cols() != layout.size() || z.H.rows() != z.r.size()) return INFINITY;
  double worst = 0;
  for (int row = 0; row < z.r.size(); ++row) {
    const state::StateVector error =
        gradient_by_differences(s, layout, row) - state::StateVector(z.H.row(row).transpose());
    worst = std::max(worst, error.cwiseAbs().cwiseQuotient(tolerance(s, layout)).maxCoeff());
  }
  return worst;
}

class Observations : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(All, Observations, ::testing::ValuesIn(kKinds),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(Observations, JacobianIsThatOfDifferences) {
  std::mt19937 rng{42};
  for (int i = 0; i < 100; ++i)
    EXPECT_LE(worst_of(random_sample(GetParam(), every_block(), rng), every_block()), 1) << i;
}

/// Blocks elsewhere, or not at all.
TEST_P(Observations, JacobianFollowsTheLayout) {
  std::mt19937 rng{43};
  std::vector<state::Layout> layouts(9);
  layouts[7].add(state::block::time_drift, 1);
  layouts[1].add(state::block::gyro_scale, 1).add(kTemperature, 1);
  layouts[2].add(kTemperature, 1);
  layouts[3]
      .add(state::Block{"unknown", 4, "1"}, 1)
      .add(state::block::gyro_scale, 1)
      .add(state::block::accel_scale, 1);
  layouts[4].add(state::block::time_offset, 1).add(state::block::time_drift, 1);
  layouts[5].add(state::block::lever_arm, 1).add(state::block::accel_scale, 1);
  layouts[6]
      .add(state::block::wheel_scale, 1)
      .add(state::block::wheel_lever_arm, 1)
      .add(state::block::cornering_compliance, 1)
      .add(state::block::mounting, 1);
  layouts[8]
      .add(state::block::time_offset, 1)
      .add(state::block::baseline_heading, 1)
      .add(state::block::gyro_scale, 1)
      .add(state::block::time_drift, 1);
  for (const state::Layout& layout : layouts) {
    for (int i = 0; i < 20; ++i)
      EXPECT_LE(worst_of(random_sample(GetParam(), layout, rng), layout), 1) << layout.size();
  }
}

/// An estimate without slow blocks and one where they are zero predict the same.
TEST_P(Observations, SlowBlocksThatAreZeroChangeNothing) {
  std::mt19937 rng{44};
  const state::Layout none;
  for (int i = 0; i < 20; ++i) {
    Sample s = random_sample(GetParam(), none, rng);
    const state::Linearized alone = s.observation->linearize(s.x, s.mean, none);
    s.x.slow = state::SlowVector::Zero(every_block().slow_size());
    const state::Linearized with = s.observation->linearize(s.x, s.mean, every_block());
    EXPECT_EQ(alone.r, with.r);
    EXPECT_EQ(alone.H, with.H.leftCols(none.size()));
    EXPECT_EQ(alone.R, with.R);
  }
}

TEST_P(Observations, NoiseIsACovarianceOfEachRow) {
  std::mt19937 rng{45};
  const Sample s = random_sample(GetParam(), every_block(), rng);
  const state::Linearized z = s.observation->linearize(s.x, s.mean, every_block());
  EXPECT_LE(z.r.size(), state::kMostMeasured);
  ASSERT_EQ(z.R.rows(), z.r.size());
  ASSERT_EQ(z.R.cols(), z.r.size());
  EXPECT_EQ(z.R, z.R.transpose());
  EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(z.R).info(), Eigen::Success);
}

TEST_P(Observations, HasItsName) {
  std::mt19937 rng{46};
  const Sample s = random_sample(GetParam(), every_block(), rng);
  EXPECT_EQ(s.observation->name(), GetParam().name);
}

/// Level, looking east, its baseline to the right: azimuth 180 deg; turning right, 0.1 s ago it was
/// less.
TEST(Heading, IsTheAzimuthOfTheBaselineAtItsTime) {
  state::NavState x;
  x.q_n_b = so3::from_euler({0, 0, 0.5 * kPi});
  x.slow = Eigen::Vector2d(0.1, 0.02);
  state::Layout layout;
  layout.add(state::block::time_offset, 1).add(state::block::baseline_heading, 1);
  GnssFix fix;
  fix.heading = GnssHeading{-3, 0.01, 0.5 * kPi};
  const Heading heading(fix, Eigen::Quaterniond::Identity());
  const state::Linearized z = heading.linearize(x, {{0, 0, 0.5}, {0, 0, 0}}, layout);
  EXPECT_NEAR(z.r[0], so3::wrap(-3 - (kPi + 0.02 - 0.05)), 1e-12);
  EXPECT_NEAR(state::part(state::StateVector(z.H.row(0).transpose()),
                          *layout.find(state::block::time_offset))[0],
              -0.5, 1e-12);
  EXPECT_NEAR(z.R(0, 0), 1e-4, 1e-15);
}

TEST(Heading, OfASteepBaselineTellsNothing) {
  state::NavState x;
  x.q_n_b = so3::from_euler({0, 85 * kDegree, 0});
  GnssFix fix;
  fix.heading = GnssHeading{1, 0.01, 0};
  const Heading heading(fix, Eigen::Quaterniond::Identity());
  EXPECT_GT(heading.linearize(x, {}, {}).R(0, 0), 1e5);
}

TEST(Observation, EveryObservationHasALine) {
  int headers = 0;
  for (const auto& entry : std::filesystem::directory_iterator(FOUCAULT_MEASUREMENT_HEADERS)) {
    const std::string name = entry.path().stem().string();
    std::ifstream file(entry.path());
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (text.find(": public Observation") == std::string::npos) continue;
    ++headers;
    const bool there = std::any_of(kKinds.begin(), kKinds.end(),
                                   [&](const Kind& kind) { return kind.name == name; });
    EXPECT_TRUE(there) << name;
  }
  EXPECT_GE(headers, 2);
}

TEST(Predicted, ValuesHaveOneSigmaAndErrorsOfTheirOwn) {
  const auto north_and_east = [](const state::NavState& x) -> Predicted::Values {
    return x.velocity_n.head<2>();
  };
  state::NavState x;
  x.velocity_n = {1, 2, 3};
  const state::Linearized z =
      predicted("velocity", Eigen::Vector2d(1.5, 2.25), 0.1, north_and_east)->linearize(x, {}, {});
  EXPECT_EQ(z.r, Eigen::Vector2d(0.5, 0.25));
  EXPECT_TRUE(z.R.isApprox(0.01 * Eigen::Matrix2d::Identity(), 1e-15));
}

/// Negative control: a column left out, one of the wrong sign, one a thousandth too large.
class Spoilt final : public Observation {
 public:
  Spoilt(ObservationPtr sound, int column, double factor)
      : sound_(std::move(sound)), column_(column), factor_(factor) {}
  std::string_view name() const override { return "spoilt"; }
  state::Linearized linearize(const state::NavState& x, const MeanMotion& mean,
                              const state::Layout& layout) const override {
    state::Linearized z = sound_->linearize(x, mean, layout);
    z.H.col(column_) *= factor_;
    return z;
  }

 private:
  ObservationPtr sound_;
  int column_;
  double factor_;
};

TEST_P(Observations, WrongColumnsAreSeen) {
  std::mt19937 rng{47};
  const state::Layout layout = every_block();
  const Sample sound = random_sample(GetParam(), layout, rng);
  const state::Linearized z = sound.observation->linearize(sound.x, sound.mean, layout);
  int spoilt = 0;
  for (int column = 0; column < layout.size(); ++column) {
    if (z.H.col(column).cwiseAbs().maxCoeff() < 0.05) continue;
    for (const double factor : {0.0, -1.0, 1.001}) {
      Sample s = sound;
      s.observation = std::make_shared<Spoilt>(sound.observation, column, factor);
      EXPECT_GT(worst_of(s, layout), 2) << column << " * " << factor;
      ++spoilt;
    }
  }
  EXPECT_GE(spoilt, 9);
}

/// An antenna of a simulated vehicle, by another route: its place and velocity from its way in
/// ECEF.
class Antenna {
 public:
  Antenna() : trajectory_(simulation::make_trajectory(options())) {}

  double duration() const { return trajectory_.duration(); }
  simulation::Motion imu(double t) const { return trajectory_.at(t); }

  Eigen::Vector3d p_e(double t) const {
    const simulation::Motion m = imu(t);
    return m.p_e +
           geodesy::wgs84::R_e_n(m.position.latitude, m.position.longitude) * (m.q_n_v * p_b_a);
  }

  /// Velocity in the NED of the IMU, by differences: ECEF is rounded to 1e-9 m, over 1 ms.
  Eigen::Vector3d velocity_n(double t) const {
    const simulation::Motion m = imu(t);
    const Eigen::Vector3d velocity_e = (p_e(t + 5e-4) - p_e(t - 5e-4)) / 1e-3;
    return geodesy::wgs84::R_e_n(m.position.latitude, m.position.longitude).transpose() *
           velocity_e;
  }

  const Eigen::Vector3d p_b_a{0.4, -0.7, -1.2};

 private:
  static simulation::ScenarioOptions options() {
    simulation::ScenarioOptions o;
    o.name = "city";
    o.duration_s = 300;
    o.seed = 5;
    return o;
  }

  simulation::Trajectory trajectory_;
};

/// The state and the rate that sensors of these errors would show.
struct AtAntenna {
  state::NavState x;
  MeanMotion mean;
};

AtAntenna at(const simulation::Motion& m, const state::Layout& layout) {
  AtAntenna a;
  a.x.position = m.position;
  a.x.velocity_n = m.velocity_n;
  a.x.q_n_b = m.q_n_v;
  a.x.bias.gyro = Eigen::Vector3d(0.02, -0.01, 0.03);
  a.x.slow = state::SlowVector::LinSpaced(layout.slow_size(), -0.03, 0.04);
  for (const state::Block& of_antenna :
       {state::block::lever_arm, state::block::time_offset, state::block::time_drift}) {
    if (const state::SlowBlock* slow = layout.find(of_antenna)) {
      a.x.slow.segment(slow->index, slow->block.size).setZero();
    }
  }
  const Eigen::Array3d scale = 1 + layout.imu_scale(a.x.slow).gyro.array();
  a.mean.rate_b = (scale * m.omega_iv_v.array()).matrix() + a.x.bias.gyro;
  return a;
}

/// Largest residuals along the way, of position [m] and velocity [m/s].
struct Residuals {
  double position = 0, velocity = 0;
};

Residuals along_the_way(const Antenna& antenna, const Eigen::Vector3d& lever_arm) {
  Residuals most;
  const state::Layout layout = every_block();
  for (double t = 1; t < antenna.duration() - 1; t += 0.5) {
    const AtAntenna a = at(antenna.imu(t), layout);
    GnssFix fix;
    fix.p_b_a = lever_arm;
    fix.antenna = geodesy::wgs84::ecef_to_geodetic(antenna.p_e(t));
    fix.velocity_n = antenna.velocity_n(t);
    const auto residual = [&](const Observation& o) {
      return o.linearize(a.x, a.mean, layout).r.cwiseAbs().maxCoeff();
    };
    most.position = std::max(most.position, residual(GnssPosition(fix)));
    most.velocity = std::max(most.velocity, residual(GnssVelocity(fix)));
  }
  return most;
}

TEST(GnssObservations, OfATrueAntennaLeaveNoResidual) {
  const Antenna antenna;
  const Residuals most = along_the_way(antenna, antenna.p_b_a);
  // Radii of the IMU's place instead of the chord to the antenna: l^2 / R, and nanometres.
  EXPECT_LT(most.position, antenna.p_b_a.squaredNorm() / kEarthRadius + 2e-8);
  // The Earth's rate, left out, and 4 um/s of the differences.
  EXPECT_LT(most.velocity, 7.3e-5 * antenna.p_b_a.norm() + 1e-5);
}

/// By a degree about the vertical: 1.4 cm of 0.8 m, and 1.7 % of the swing at 0.4 rad/s.
TEST(GnssObservations, OfATurnedLeverArmLeaveResiduals) {
  const Antenna antenna;
  const Eigen::Vector3d turned = so3::exp({0, 0, kDegree}) * antenna.p_b_a;
  const Residuals most = along_the_way(antenna, turned);
  EXPECT_GT(most.position, 0.01);
  EXPECT_GT(most.velocity, 1e-3);
}

/// A scale of 3 % in a turn at 0.4 rad/s swings 1.2 m by 14 mm/s.
TEST(GnssVelocity, SeesTheScaleOfTheGyroscopes) {
  const Antenna antenna;
  const state::Layout layout = every_block();
  double most = 0;
  for (double t = 1; t < antenna.duration() - 1; t += 0.5) {
    AtAntenna a = at(antenna.imu(t), layout);
    GnssFix fix;
    fix.p_b_a = antenna.p_b_a;
    fix.velocity_n = antenna.velocity_n(t);
    a.x.slow.setZero();
    most = std::max(most, GnssVelocity(fix).linearize(a.x, a.mean, layout).r.norm());
  }
  EXPECT_GT(most, 5e-3);
}

}  // namespace
}  // namespace foucault::measurement
