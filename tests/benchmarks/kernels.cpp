#include "kernels.h"

#include <benchmark/benchmark.h>

#include <array>
#include <vector>

#include "best_times.h"
#include "closed_form_motion.h"
#include "dense_preintegrator.h"
#include "foucault/fgo/imu_interval.h"
#include "foucault/fgo/preintegration_factor.h"
#include "foucault/imu/imu_noise.h"

namespace foucault::benchmarks {
namespace {

using testing::ClosedFormMotion;
using testing::DensePreintegrator;
using testing::wuhan_earth;

const state::ImuBias kBias{{1e-4, -2e-4, 1.5e-4}, {0.01, 0.005, -0.02}};

/// A second at 200 Hz, and the increment before it.
std::vector<ImuIncrement> a_second() {
  return ClosedFormMotion(wuhan_earth()).increments(3, 4, 200);
}

void structured(benchmark::State& state, preintegration::PreintegrationModel model) {
  const imu::ImuNoise noise = imu::imu_preset("ADIS16465");
  const std::vector<ImuIncrement> increments = a_second();
  for ([[maybe_unused]] const auto _ : state) {
    preintegration::Preintegrator integrator(noise, kBias, increments[1].t_begin_ns,
                                             increments.front());
    for (std::size_t i = 1; i < increments.size(); ++i) integrator.add(increments[i]);
    benchmark::DoNotOptimize(fgo::measured(integrator, model));
  }
  state.counters[kThings] = static_cast<double>(increments.size() - 1);
}

void dense(benchmark::State& state) {
  const imu::ImuNoise noise = imu::imu_preset("ADIS16465");
  const std::vector<ImuIncrement> increments = a_second();
  for ([[maybe_unused]] const auto _ : state) {
    DensePreintegrator integrator(noise, kBias, increments.front());
    for (std::size_t i = 1; i < increments.size(); ++i) integrator.add(increments[i]);
    benchmark::DoNotOptimize(integrator.result());
  }
  state.counters[kThings] = static_cast<double>(increments.size() - 1);
}

void factor(benchmark::State& state, bool with_jacobians) {
  const preintegration::Preintegration pre =
      testing::preintegrate(a_second(), imu::imu_preset("ADIS16465"), kBias);
  const ClosedFormMotion motion(wuhan_earth());
  const fgo::PreintegrationFactor factor(pre, wuhan_earth());
  fgo::StateBlock x0, x1;
  fgo::write_block(motion.state(3), x0.data());
  fgo::write_block(motion.state(4), x1.data());
  const std::array<const double*, 2> blocks{x0.data(), x1.data()};
  std::array<double, 15> residual;
  std::array<double, 15 * fgo::kStateBlockSize> J0, J1;
  std::array<double*, 2> jacobians{J0.data(), J1.data()};
  for ([[maybe_unused]] const auto _ : state) {
    benchmark::DoNotOptimize(factor.Evaluate(blocks.data(), residual.data(),
                                             with_jacobians ? jacobians.data() : nullptr));
    benchmark::ClobberMemory();
  }
  state.counters[kThings] = 1;
}

}  // namespace

void register_kernels() {
  add("preintegration/refined", structured, preintegration::PreintegrationModel::refined);
  add("preintegration/rough", structured, preintegration::PreintegrationModel::rough);
  add("preintegration/full", structured, preintegration::PreintegrationModel::full);
  add("preintegration/dense", dense);
  add("factor/residual", factor, false);
  add("factor/residual and Jacobians", factor, true);
}

}  // namespace foucault::benchmarks
