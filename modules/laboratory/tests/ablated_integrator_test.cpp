#include "foucault/laboratory/ablated_integrator.h"

#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>

#include "foucault/laboratory/exact_interval.h"
#include "foucault/laboratory/lab_motion.h"
#include "foucault/laboratory/preintegration_study.h"
#include "foucault/preintegration/preintegrator.h"

namespace foucault::laboratory {
namespace {

using Eigen::Vector3d;

/// One interval of a motion in the frame of its trip.
class Trial {
 public:
  Trial(const std::string& motion, double length, double rate_hz)
      : motion_(lab_motion(motion)),
        trajectory_(simulation::make_trajectory(motion_.scenario)),
        frame_(trajectory_.at(0).position),
        x0_(true_state(trajectory_, frame_, begin())),
        truth_(true_state(trajectory_, frame_, begin() + length)),
        increments_(ExactIncrements(trajectory_, begin(), length, 1000, 50).at(rate_hz)) {}

  const geodesy::LocalFrame& frame() const { return frame_; }
  const state::NodeState& x0() const { return x0_; }
  const state::NodeState& truth() const { return truth_; }

  state::NodeState reckon(const MotionTerms& terms) const {
    AblatedIntegrator integrator(x0_, frame_, terms, increments_.front());
    for (std::size_t i = 1; i < increments_.size(); ++i) integrator.add(increments_[i]);
    return integrator.state();
  }
  state::NodeState predict_with(const preintegration::EarthModel& earth) const {
    preintegration::Preintegrator integrator({}, {}, increments_[1].t_begin_ns,
                                             increments_.front());
    for (std::size_t i = 1; i < increments_.size(); ++i) integrator.add(increments_[i]);
    return predict(x0_, integrator.result(), earth);
  }
  preintegration::EarthModel full_earth() const {
    return preintegration::earth_model(preintegration::PreintegrationModel::full, frame_,
                                       x0_.p_w_b);
  }
  MotionError error(const MotionTerms& terms) const { return error_of(reckon(terms), truth_); }

 private:
  double begin() const { return motion_.start_s(3); }

  LabMotion motion_;
  simulation::Trajectory trajectory_;
  geodesy::LocalFrame frame_;
  state::NodeState x0_, truth_;
  std::vector<ImuIncrement> increments_;
};

constexpr double kShort = 1, kLong = 60;  // [s]

class AblatedIntegratorOf : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Motions, AblatedIntegratorOf,
                         ::testing::Values("city", "vibration", "motorway", "airliner"),
                         [](const auto& test) { return std::string(test.param); });

// Two routes, one answer: with constant gravity both solve the equations of motion exactly, but
// for (omega T)^4 / 24 of the way, 2e-7 m for the airliner over 60 s. Coordinates of 3e5 m are
// good to 6e-11 m; 12 000 samples round to some 1e-8 m over 60 s.
TEST_P(AblatedIntegratorOf, IsPreintegratorAndPredictToRounding) {
  MotionTerms terms;
  terms.gravity = GravityAlong::start;
  for (const double T : {kShort, kLong}) {
    const Trial trial(GetParam(), T, 200);
    preintegration::EarthModel earth = trial.full_earth();
    earth.gravity_gradient.setZero();
    const MotionError e = error_of(trial.reckon(terms), trial.predict_with(earth));
    EXPECT_LT(e.position, T == kShort ? 2e-10 : 5e-7);
    EXPECT_LT(e.velocity, T == kShort ? 1e-11 : 2e-8);
    EXPECT_LT(e.attitude, 2e-12);
  }
}

// With the gradient predict() leaves out that it turns with the Earth: omega (3 g/R) v T^3 / 3 in
// velocity, at most 28 nm/s over 1 s at 250 m/s, and T/4 of that in position.
TEST_P(AblatedIntegratorOf, IsFullWithDefaultTerms) {
  const Trial trial(GetParam(), kShort, 200);
  const MotionError e = error_of(trial.reckon({}), trial.predict_with(trial.full_earth()));
  EXPECT_LT(e.position, 7e-9);
  EXPECT_LT(e.velocity, 2.8e-8);
  EXPECT_LT(e.attitude, 2e-12);
}

TEST_P(AblatedIntegratorOf, IsRoughWithoutTheEarthsRotation) {
  const Trial trial(GetParam(), kShort, 200);
  MotionTerms terms;
  terms.gravity = GravityAlong::start;
  terms.earth_rotation = terms.coriolis = false;
  preintegration::EarthModel earth = trial.full_earth();
  earth.gravity_gradient.setZero();
  earth.omega_ie_w.setZero();
  const MotionError e = error_of(trial.reckon(terms), trial.predict_with(earth));
  EXPECT_LT(e.position, 2e-10);
  EXPECT_LT(e.velocity, 1e-11);
  EXPECT_LT(e.attitude, 2e-12);
}

// With nothing left out only the motion within the samples is missing. The position in a sample
// follows the mean velocity, an error of second order: a 16th at four times the rate. Of a
// vibration's error parts of opposite sign cancel at the lower rate. First order would give 4.
TEST_P(AblatedIntegratorOf, ConvergesWithGravityOfThePlace) {
  MotionTerms terms;
  terms.gravity = GravityAlong::place;
  const double coarse = Trial(GetParam(), kShort, 250).error(terms).position;
  const double fine = Trial(GetParam(), kShort, 1000).error(terms).position;
  EXPECT_GT(coarse / fine, 10);
  EXPECT_LT(fine, 2e-7);
}

TEST(AblatedTerms, CoriolisIsTwiceTheRateTimesVelocity) {
  const Trial trial("airliner", kShort, 200);
  MotionTerms terms;
  terms.coriolis = false;
  const Vector3d lost = trial.reckon(terms).p_w_b - trial.truth().p_w_b;
  const Vector3d mean_v = (trial.truth().p_w_b - trial.x0().p_w_b) / kShort;
  const Vector3d expected = trial.frame().earth_rate_w().cross(mean_v) * kShort * kShort;
  EXPECT_LT((lost - expected).norm(), 0.01 * expected.norm());  // turns change v by less
}

TEST(AblatedTerms, EarthRotationTiltsGravity) {
  const Trial trial("motorway", 10, 200);
  MotionTerms terms;
  terms.earth_rotation = false;
  const MotionError e = trial.error(terms);
  const Vector3d omega = trial.frame().earth_rate_w();
  EXPECT_NEAR(e.attitude, 10 * omega.norm(), 1e-9);
  const double expected = omega.cross(trial.frame().gravity_w()).norm() * 1000 / 6;
  EXPECT_NEAR(e.position, expected, 0.05 * expected);  // the car's own accelerations
}

TEST(AblatedTerms, GravityChangesByTheWay) {
  const Trial trial("airliner", 10, 200);
  MotionTerms terms;
  terms.gravity = GravityAlong::start;
  const double turn_rate = trial.x0().v_w_b.norm() / 6.38e6;  // [rad/s]; radius with height
  const double expected = 9.77 * turn_rate * 1000 / 6;
  EXPECT_NEAR(trial.error(terms).position, expected, 0.02 * expected);
}

TEST(AblatedTerms, ConingAndScullingCountOnAVibratingCar) {
  const Trial vibrating("vibration", 10, 200);
  MotionTerms coning, sculling, rotation, again;
  coning.coning = false;
  sculling.sculling = false;
  rotation.rotation = rotation.rotation_again = false;
  again.rotation_again = false;
  const MotionError all = vibrating.error({});
  EXPECT_GT(vibrating.error(coning).attitude, 5 * all.attitude);
  EXPECT_GT(vibrating.error(coning).position, 3 * all.position);
  EXPECT_GT(vibrating.error(sculling).velocity, 1.5 * all.velocity);
  EXPECT_EQ(vibrating.error(sculling).attitude, all.attitude);
  EXPECT_GT(vibrating.error(rotation).position, 3 * all.position);
  const Trial turning("city", kShort, 50);
  EXPECT_GT(turning.error(rotation).velocity, 100 * turning.error(again).velocity);
}

TEST(ExactIncrements, OfEveryRateHaveOneSum) {
  const simulation::Trajectory city = simulation::make_trajectory(lab_motion("city").scenario);
  const ExactIncrements exact(city, 100.013, 0.2, 1000, 50);
  const auto sum_of = [](const std::vector<ImuIncrement>& all) {
    return std::accumulate(
        all.begin() + 1, all.end(), Vector3d(Vector3d::Zero()),
        [](const Vector3d& sum, const ImuIncrement& i) -> Vector3d { return sum + i.dvel_b; });
  };
  const Vector3d sum = sum_of(exact.at(1000));
  for (const double rate : {50.0, 100.0, 200.0, 500.0}) {
    const std::vector<ImuIncrement> increments = exact.at(rate);
    EXPECT_EQ(increments.size(), static_cast<std::size_t>(0.2 * rate + 1.5));
    EXPECT_EQ(increments.front().t_end_ns, 100'013'000'000);
    EXPECT_EQ(increments.back().t_end_ns, 100'213'000'000);
    EXPECT_LT((sum_of(increments) - sum).norm(), 1e-14);
  }
  EXPECT_THROW(exact.at(300), std::invalid_argument);
  EXPECT_THROW(exact.at(25), std::invalid_argument);
}

}  // namespace
}  // namespace foucault::laboratory
