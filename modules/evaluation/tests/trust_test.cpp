#include "foucault/evaluation/trust.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "foucault/evaluation/run_metrics.h"

namespace foucault::evaluation {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A run of independent innovations.
class MadeUpRun {
 public:
  explicit MadeUpRun(unsigned seed = 42) : rng_(seed) {}

  /// `count` used fixes whose innovations are `size` times as large as their sigmas.
  MadeUpRun& fixes(int count, double size) {
    for (int i = 0; i < count; ++i)
      fix(size * Eigen::Vector3d(normal_(rng_), normal_(rng_), normal_(rng_)));
    return *this;
  }
  MadeUpRun& fix(const Eigen::Vector3d& innovation_n,
                 state::FixVerdict verdict = state::FixVerdict::used) {
    state::FixResult fix;
    fix.t_ns = nanoseconds(1.7e9 + t_);
    fix.verdict = verdict;
    fix.innovation_n = innovation_n;
    fix.innovation_covariance.setIdentity();
    collector_.fix(fix);
    state::Epoch epoch;
    epoch.t_ns = fix.t_ns;
    return state(epoch);
  }
  MadeUpRun& state(const state::Epoch& epoch) {
    collector_.epoch(epoch);
    t_ += 1;
    return *this;
  }
  Trust trust() const { return collector_.metrics().trust; }

 private:
  std::mt19937 rng_;
  std::normal_distribution<double> normal_;
  RunMetricsCollector collector_{state::Mounting()};
  double t_ = 0;
};

Trust trust_of(double position, double velocity, double attitude, int64_t samples = 100) {
  Trust trust{true, {"a remark"}};
  SeparationMetrics separation;
  separation.samples = samples;
  separation.position_size = position;
  separation.velocity_size = velocity;
  separation.attitude_size = attitude;
  judge_separation(trust, separation);
  return trust;
}

TEST(Trust, RunsThatTellDifferentMotionsAreNotBelieved) {
  EXPECT_TRUE(trust_of(2, 2, 2).trustworthy);
  EXPECT_THAT(trust_of(2, 2, 2).reasons, ElementsAre("a remark"));
  const Trust apart = trust_of(1, 1, 4.2);
  EXPECT_FALSE(apart.trustworthy);
  EXPECT_THAT(apart.reasons, ElementsAre(HasSubstr("attitude by 4.2 times"), "a remark"));
  EXPECT_THAT(trust_of(1, 8, 4).reasons[0],
              HasSubstr("velocity by 8.0 times, attitude by 4.0 times"));
  EXPECT_TRUE(trust_of(1, 8, 8, 9).trustworthy) << "too few";
}

/// Fixes hold it in both.
TEST(Trust, APositionThatSmoothingMovedIsNamed) {
  const Trust moved = trust_of(5, 1, 1);
  EXPECT_TRUE(moved.trustworthy);
  EXPECT_THAT(moved.reasons, ElementsAre("a remark", HasSubstr("by 5.0 times")));
}

/// A remedy that names a key names one that exists.
TEST(Trust, RemediesOfAidsAreKeysThatThereAre) {
  const auto reasons = [](std::string_view name) {
    RunMetricsCollector collector{state::Mounting()};
    for (int i = 0; i < 50; ++i) {
      state::ObservationResult result;
      result.t_ns = nanoseconds(1.7e9 + i);
      result.name = name;
      result.dimension = 3;
      result.normalized_square = 12;
      result.used = true;
      collector.observation(result);
    }
    std::string all;
    for (const std::string& reason : collector.metrics().trust.reasons) all += reason + "\n";
    return all;
  };
  EXPECT_THAT(reasons("zero_velocity"), HasSubstr("(aids.zero_velocity_sigma_m_s)"));
  EXPECT_THAT(reasons("zero_rate"), HasSubstr("imu.arw_deg_sqrt_h"));
  EXPECT_THAT(reasons("zero_rate"), Not(HasSubstr("aids.zero_rate")));
  EXPECT_THAT(reasons("barometer"), HasSubstr("innovations of barometer are 2.0 times"));
  EXPECT_THAT(reasons("barometer"), Not(HasSubstr("aids.")));
}

TEST(Trust, InnovationsOfTheirSizeAreBelieved) {
  const Trust trust = MadeUpRun().fixes(400, 1).trust();
  EXPECT_TRUE(trust.trustworthy);
  EXPECT_THAT(trust.reasons, IsEmpty());
}

TEST(Trust, OneAndAHalfIsNamedThreeCondemns) {
  const Trust usual = MadeUpRun().fixes(400, 1.3).trust();
  EXPECT_TRUE(usual.trustworthy);
  EXPECT_THAT(usual.reasons, IsEmpty());
  const Trust named = MadeUpRun().fixes(400, 2).trust();
  EXPECT_TRUE(named.trustworthy);
  EXPECT_THAT(named.reasons, ElementsAre(HasSubstr("times as large as their sigmas")));
  const Trust condemned = MadeUpRun().fixes(400, 4).trust();
  EXPECT_FALSE(condemned.trustworthy);
  EXPECT_THAT(condemned.reasons[0], HasSubstr("times as large as their sigmas"));
}

TEST(Trust, AHalfIsNamedThreeTenthsCondemn) {
  const Trust usual = MadeUpRun().fixes(400, 0.6).trust();
  EXPECT_TRUE(usual.trustworthy);
  EXPECT_THAT(usual.reasons, IsEmpty());
  const Trust named = MadeUpRun().fixes(400, 0.4).trust();
  EXPECT_TRUE(named.trustworthy);
  EXPECT_THAT(named.reasons, ElementsAre(HasSubstr("of their sigmas")));
  const Trust condemned = MadeUpRun().fixes(400, 0.2).trust();
  EXPECT_FALSE(condemned.trustworthy);
  EXPECT_THAT(condemned.reasons, ElementsAre(HasSubstr("of their sigmas")));
}

/// From ten fixes on, and chance alone condemns none of a thousand.
TEST(Trust, ShortRunsAreJudgedButNotByChance) {
  for (unsigned seed = 1; seed <= 1000; ++seed) {
    EXPECT_TRUE(MadeUpRun(seed).fixes(10, 1).trust().trustworthy) << seed;
    EXPECT_FALSE(MadeUpRun(seed).fixes(10, 10).trust().trustworthy) << seed;
  }
  const Trust few = MadeUpRun().fixes(9, 1).trust();
  EXPECT_FALSE(few.trustworthy);
  EXPECT_THAT(few.reasons, ElementsAre(HasSubstr("only 9 fixes")));
  EXPECT_FALSE(RunMetricsCollector(state::Mounting()).metrics().trust.trustworthy);
}

/// Innovations that stay small for long, as those of a receiver's lasting errors may by chance.
TEST(Trust, ASmallSizeOfFewEffectiveInnovationsIsChance) {
  Consistency consistency;
  consistency.nis.samples = 200;
  consistency.nis.mean = 3 * 0.25 * 0.25;
  consistency.nis.effective_samples = 1.5;
  EXPECT_TRUE(trust_in(consistency, {}).trustworthy);
  consistency.nis.effective_samples = 20;
  EXPECT_FALSE(trust_in(consistency, {}).trustworthy);
}

Consistency sound() {
  Consistency consistency;
  consistency.nis.samples = 200;
  consistency.nis.effective_samples = 200;
  consistency.nis.mean = 3;
  return consistency;
}

TEST(Trust, TooManyRejectedFixesCondemn) {
  EXPECT_TRUE(trust_in(sound(), {}, {}, {200, 60}).trustworthy);
  const Trust trust = trust_in(sound(), {}, {}, {200, 70});
  EXPECT_FALSE(trust.trustworthy);
  EXPECT_THAT(trust.reasons, ElementsAre(HasSubstr("70 of 270 fixes")));
}

TEST(Trust, ACourseFarFromTheHeadingIsNamed) {
  const auto moves = [](double angle_deg, double scatter_deg, double speed) {
    CourseOffset course;
    for (int i = 0; i < 100; ++i) {
      const double heading = 0.1 * i;
      const double azimuth = heading + (angle_deg + (i % 2 ? 1 : -1) * scatter_deg) * kDegree;
      course.add({speed * std::cos(azimuth), speed * std::sin(azimuth), 0}, heading, 2 * kDegree);
    }
    return trust_in(sound(), {}, {}, {}, course);
  };
  EXPECT_THAT(moves(175, 10, 10).reasons, ElementsAre(HasSubstr("175 deg to the right")));
  EXPECT_THAT(moves(-90, 10, 10).reasons, ElementsAre(HasSubstr("90 deg to the left")));
  EXPECT_TRUE(moves(175, 10, 10).trustworthy) << "a train may be driven from its end";
  EXPECT_THAT(moves(20, 10, 10).reasons, IsEmpty()) << "leeway";
  EXPECT_THAT(moves(175, 10, 1).reasons, IsEmpty()) << "too slow for a course";
  EXPECT_THAT(moves(175, 80, 10).reasons, IsEmpty()) << "in all directions";
}

TEST(Trust, AWrongStretchIsNamedAWrongPartCondemns) {
  const Trust stretch = MadeUpRun().fixes(600, 1).fixes(30, 4).fixes(600, 1).trust();
  EXPECT_TRUE(stretch.trustworthy);
  EXPECT_THAT(stretch.reasons, ElementsAre(HasSubstr("from 600 to 629 s after the start")));
  EXPECT_FALSE(MadeUpRun().fixes(600, 1).fixes(300, 6).trust().trustworthy);
  EXPECT_FALSE(MadeUpRun().fixes(2970, 1).fixes(30, 40).trust().trustworthy);
}

/// As clocks apart make them.
TEST(Trust, AVerticalThatFitsDoesNotHideTheHorizontal) {
  MadeUpRun run;
  for (int i = 0; i < 200; ++i) run.fix({3.4, 0, 1}).fix({0, -3.4, 1}).fix({-3.4, 3.4, 1});
  const Trust hardly = run.trust();  // horizontal 2.78, all 2.34
  EXPECT_TRUE(hardly.trustworthy);
  for (int i = 0; i < 600; ++i) run.fix({-3.6, 3.6, 1});
  const Trust trust = run.trust();  // horizontal 3.22, all 2.69
  EXPECT_FALSE(trust.trustworthy);
  EXPECT_THAT(trust.reasons[0], HasSubstr("innovations are 3.2 times as large"));
}

/// A jump that was believed: noise is not what is wrong.
TEST(Trust, OneLargeInnovationIsNamedForItself) {
  const Trust trust = MadeUpRun().fixes(200, 1).fix({500, 0, 0}).fixes(200, 1).trust();
  EXPECT_FALSE(trust.trustworthy);
  EXPECT_THAT(trust.reasons,
              ElementsAre(HasSubstr("one innovation, 200 s after the start, is 289 times")));
}

TEST(Trust, SomeRejectedFixesDoNotCondemn) {
  MadeUpRun run;
  for (int i = 0; i < 60; ++i) run.fixes(5, 1).fix({100, 0, 0}, state::FixVerdict::gated);
  EXPECT_TRUE(run.trust().trustworthy);
}

TEST(Trust, AStateThatIsNotFiniteCondemns) {
  state::Epoch broken;
  broken.t_ns = nanoseconds(1.7e9 + 500);
  broken.covariance(14, 0) = kNaN;
  EXPECT_FALSE(is_finite(broken));
  const Trust trust = MadeUpRun().fixes(400, 1).state(broken).trust();
  EXPECT_FALSE(trust.trustworthy);
  EXPECT_THAT(
      trust.reasons,
      ElementsAre(HasSubstr("1 of 401 states are not finite, the first 500.0 s after the start")));
}

}  // namespace
}  // namespace foucault::evaluation
