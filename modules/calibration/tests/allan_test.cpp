#include "foucault/calibration/allan.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "foucault/core/time.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/simulation/imu_simulator.h"

namespace foucault::calibration {
namespace {

constexpr double kTwoHours = 7200;
constexpr double kInterval = 0.1;
const std::vector<int> kGyros{0, 1, 2}, kAccels{3, 4, 5};

/// Samples of an IMU at rest, as the simulation has them.
AllanCurve at_rest(const imu::ImuNoise& noise, double seconds, int64_t seed) {
  simulation::ImuErrors errors(noise, {}, seed);
  AllanDeviation allan(kInterval);
  ImuIncrement still;
  still.t_end_ns = nanoseconds(kInterval);
  for (int64_t k = 0; k < std::llround(seconds / kInterval); ++k) {
    const ImuIncrement felt = errors.apply(still);
    SixAxes sample;
    sample << felt.dtheta_b, felt.dvel_b;
    allan.add(sample / kInterval);
  }
  return allan.curve();
}

/// Samples of anything, each axis drawn by itself.
AllanCurve curve_of(int samples, const std::function<double()>& draw) {
  AllanDeviation allan(kInterval);
  for (int k = 0; k < samples; ++k) {
    SixAxes sample;
    for (int axis = 0; axis < 6; ++axis) sample[axis] = draw();
    allan.add(sample);
  }
  return allan.curve();
}

double walk_of(double sigma, double tau) { return sigma * std::sqrt(2 / tau); }

/// When a slope begins: white noise and walk are equal there.
double crossing(double white, double walk) { return std::sqrt(3.0) * white / walk; }

/// White noise within 10 %; the walk within 10 % or three of its sigmas where two hours show it, no
/// number where they cannot, and no instability, which is not in the model.
void expect_found(const AllanFit& found, double white, double walk, const std::string& what) {
  ASSERT_TRUE(found.white) << what;
  EXPECT_NEAR(found.white->value / white, 1, 0.1) << what;
  EXPECT_FALSE(found.flicker) << what;
  const double begins = crossing(white, walk);
  EXPECT_TRUE(found.walk || begins > kTwoHours / 16) << what;
  EXPECT_TRUE(!found.walk || begins < kTwoHours / 4) << what;
  if (!found.walk) return;
  EXPECT_NEAR(std::log(found.walk->value / walk), 0, std::max(0.1, 3 * found.walk->log_sigma))
      << what;
}

TEST(Allan, FindsTheNoiseOfEachPreset) {
  for (const std::string& name : imu::imu_preset_names()) {
    const imu::ImuNoise n = imu::imu_preset(name);
    const AllanCurve curve = at_rest(n, kTwoHours, 5);
    expect_found(fit(curve, kGyros, n.bias_tau), n.gyro_noise_density,
                 walk_of(n.gyro_bias_sigma, n.bias_tau), name + ", gyroscope");
    expect_found(fit(curve, kAccels, n.bias_tau), n.accel_noise_density,
                 walk_of(n.accel_bias_sigma, n.bias_tau), name + ", accelerometer");
  }
}

/// Over forty recordings, errors are what their sigmas say, and their mean is nothing: three sigmas
/// of a mean of forty at 0.05 each are 0.024.
TEST(Allan, SaysHowSureItIs) {
  const imu::ImuNoise n = imu::imu_preset("ICM20602");
  double squares = 0, sum = 0;
  int count = 0;
  for (int64_t seed = 1; seed <= 40; ++seed) {
    const AllanFit found = fit(at_rest(n, kTwoHours / 2, seed), kAccels, n.bias_tau);
    ASSERT_TRUE(found.walk) << seed;
    const double error = std::log(found.walk->value / walk_of(n.accel_bias_sigma, n.bias_tau));
    squares += std::pow(error / found.walk->log_sigma, 2);
    sum += error;
    ++count;
  }
  EXPECT_NEAR(sum / count, 0, 0.03);
  EXPECT_NEAR(squares / count, 1, 0.5);  // chi-square of forty: 0.22, and sigmas of sigmas
}

/// Processes an octave apart make a density of 1 / f over all of them.
TEST(Allan, FindsBiasInstability) {
  constexpr double kWhite = 1, kInstability = 0.2;
  constexpr int kProcesses = 24;
  std::mt19937_64 rng{3};
  std::normal_distribution<double> normal;
  const double sigma = kInstability * std::sqrt(std::log(2.0) / kPi);
  std::array<SixAxes, kProcesses> states;
  for (SixAxes& state : states)
    for (int axis = 0; axis < 6; ++axis) state[axis] = sigma * normal(rng);
  AllanDeviation allan(kInterval);
  for (int k = 0; k < kTwoHours / kInterval; ++k) {
    SixAxes sample = SixAxes::Zero();
    double tau = kInterval / 3;
    for (SixAxes& state : states) {
      const double kept = std::exp(-kInterval / tau);
      for (int axis = 0; axis < 6; ++axis)
        state[axis] = kept * state[axis] + sigma * std::sqrt(1 - kept * kept) * normal(rng);
      sample += state;
      tau *= 2;
    }
    for (int axis = 0; axis < 6; ++axis)
      sample[axis] += kWhite / std::sqrt(kInterval) * normal(rng);
    allan.add(sample);
  }
  for (const std::vector<int>& axes : {kGyros, kAccels}) {
    const AllanFit found = fit(allan.curve(), axes, 3600);
    ASSERT_TRUE(found.white && found.flicker);
    EXPECT_NEAR(found.white->value, kWhite, 0.02);
    EXPECT_NEAR(found.flicker->value, kInstability, 0.15 * kInstability);  // three sigmas
    EXPECT_FALSE(found.walk);
  }
}

TEST(Allan, HalfAMinuteTellsWhiteNoiseOnly) {
  const imu::ImuNoise n = imu::imu_preset("ADIS16465");
  const AllanFit found = fit(at_rest(n, 33, 2), kGyros, n.bias_tau);
  ASSERT_TRUE(found.white);
  EXPECT_NEAR(found.white->value / n.gyro_noise_density, 1, 0.2);  // 990 samples, three axes
  EXPECT_FALSE(found.flicker);
  EXPECT_FALSE(found.walk);
  EXPECT_LT(found.to_s, 11);
}

/// The definition, on what is short enough for it.
TEST(Allan, IsTheOverlappingEstimator) {
  std::mt19937_64 rng{1};
  std::normal_distribution<double> normal;
  std::vector<double> x{0}, drawn;
  for (int k = 0; k < 200; ++k) {
    drawn.push_back(9.8 + normal(rng));
    x.push_back(x.back() + drawn.back() * kInterval);
  }
  AllanDeviation allan(kInterval);
  for (const double one : drawn) allan.add(SixAxes::Constant(one));
  int compared = 0;
  for (const AllanPoint& point : allan.curve().points) {
    const auto m = static_cast<std::size_t>(point.samples);
    if (m > 27) continue;
    double sum = 0;
    for (std::size_t k = 0; k + 2 * m < x.size(); ++k)
      sum += std::pow(x[k + 2 * m] - 2 * x[k + m] + x[k], 2);
    const auto count = static_cast<double>(x.size() - 2 * m);
    const double expected = sum / (2 * point.tau_s * point.tau_s * count);
    EXPECT_NEAR(point.variance[0], expected, 1e-9 * expected) << m;
    ++compared;
  }
  EXPECT_EQ(compared, 15);
}

/// Between rests the vehicle is turned: nothing of that is noise, unless holes are overlooked.
TEST(Allan, RestsArePooledAndNotJoined) {
  std::mt19937_64 rng{4};
  std::normal_distribution<double> normal;
  AllanDeviation apart(kInterval), joined(kInterval);
  for (int rest = 0; rest < 20; ++rest) {
    const double level = 100 * normal(rng);
    for (int k = 0; k < 300; ++k) {
      const SixAxes sample = SixAxes::Constant(level + normal(rng));
      apart.add(sample);
      joined.add(sample);
    }
    apart.interrupt();
  }
  EXPECT_EQ(apart.curve().pieces.size(), 20u);
  EXPECT_NEAR(apart.curve().length_s(), 600, 1e-6);
  EXPECT_NEAR(apart.curve().longest_s(), 30, 1e-6);
  const double white = std::sqrt(kInterval);
  const AllanFit found = fit(apart.curve(), {0}, 3600);
  ASSERT_TRUE(found.white);
  EXPECT_NEAR(found.white->value, white, 0.05 * white);
  EXPECT_FALSE(found.walk);
  const AllanFit wrong = fit(joined.curve(), {0}, 3600);
  EXPECT_TRUE(!wrong.white || wrong.white->value > 3 * white || wrong.walk);
}

/// Estimates of many recordings scatter as their degrees of freedom say.
TEST(Allan, DegreesOfFreedomAreThoseOfTheEstimator) {
  constexpr int kRecordings = 400, kSamples = 512;
  std::mt19937_64 rng{9};
  std::normal_distribution<double> normal;
  std::map<int64_t, std::pair<double, double>> sums;
  AllanCurve last;
  for (int i = 0; i < kRecordings; ++i) {
    last = curve_of(kSamples, [&] { return normal(rng); });
    for (const AllanPoint& point : last.points) {
      const double mean = variance_of(point, kGyros);
      sums[point.samples].first += mean / kRecordings;
      sums[point.samples].second += mean * mean / kRecordings;
    }
  }
  AllanFit white;
  white.white = {1, 0.01};
  white.bias_tau_s = 3600;
  for (const int64_t samples : {1, 2, 8, 32, 64, 128}) {
    const auto& [mean, square] = sums.at(samples);
    const double scattered = 2 * mean * mean / (square - mean * mean);
    EXPECT_NEAR(degrees_of_freedom(last, samples, 3, white) / scattered, 1, 0.3) << samples;
  }
}

/// What a filter takes away at short averaging times is left out, and the noise is what it is.
TEST(Allan, AFilteredSensorHasItsNoiseBeyondItsFilter) {
  std::mt19937_64 rng{6};
  std::normal_distribution<double> normal;
  std::vector<SixAxes> last;
  AllanDeviation allan(kInterval);
  for (int k = 0; k < 40000; ++k) {
    SixAxes fresh;
    for (int axis = 0; axis < 6; ++axis) fresh[axis] = normal(rng);
    last.push_back(fresh);
    if (last.size() < 6) continue;
    SixAxes mean = SixAxes::Zero();
    for (const SixAxes& one : last) mean += one / 6;
    allan.add(mean);
    last.erase(last.begin());
  }
  const AllanFit found = fit(allan.curve(), kGyros, 3600);
  ASSERT_TRUE(found.white);
  EXPECT_NEAR(found.white->value, std::sqrt(kInterval), 0.1 * std::sqrt(kInterval));
  EXPECT_GT(found.from_s, 4 * kInterval);
}

TEST(Allan, OfNothingNothingIsTold) {
  AllanDeviation allan(kInterval);
  EXPECT_TRUE(allan.curve().points.empty());
  const AllanFit nothing = fit(allan.curve(), kGyros, 3600);
  EXPECT_FALSE(nothing.white || nothing.flicker || nothing.walk);
  const AllanFit still = fit(curve_of(1000, [] { return 0.0; }), kGyros, 3600);
  EXPECT_FALSE(still.white || still.flicker || still.walk);
}

/// As the header has it: a top of 0.618 sigma at 1.89 T, a walk of sigma sqrt(2 / T) far below T.
TEST(Allan, AMarkovProcessHasItsTop) {
  constexpr double kSigma = 2, kTau = 500;
  const auto at = [](double tau) { return model_deviation(0, kSigma, kTau, tau); };
  EXPECT_NEAR(at(1.89 * kTau), 0.618 * kSigma, 1e-3 * kSigma);
  EXPECT_LT(at(1.5 * kTau), at(1.89 * kTau));
  EXPECT_LT(at(2.3 * kTau), at(1.89 * kTau));
  EXPECT_NEAR(at(1e-3 * kTau), walk_of(kSigma, kTau) * std::sqrt(1e-3 * kTau / 3), 1e-3 * kSigma);
  EXPECT_NEAR(at(0.00999 * kTau) / at(0.01001 * kTau), std::sqrt(0.00999 / 0.01001), 1e-4);
}

}  // namespace
}  // namespace foucault::calibration
