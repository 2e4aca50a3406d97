#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/measurement.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/measurement/navigator.h"
#include "foucault/state/interfaces.h"

/// A navigator that records what it is asked, a sink that keeps what it is given, and measurements
/// by milliseconds after a start.
namespace foucault::testing {

using Eigen::Vector3d;
using geodesy::LocalFrame;
using measurement::Navigator;
using measurement::Observation;
using measurement::ObservationPtr;
using namespace state;  // NOLINT: its interfaces

constexpr int64_t kStart = 1'700'000'000'000'000'000;
constexpr int64_t kMs = 1'000'000;
inline const Geodetic kPlace{48 * kDegree, 9 * kDegree, 300};

inline int64_t at(double ms) { return kStart + static_cast<int64_t>(ms * kMs); }
inline double ms_of(int64_t t_ns) { return static_cast<double>(t_ns - kStart) / kMs; }

/// What a run asked of its navigator, in order; times in ms after the start.
struct Log {
  std::vector<std::string> calls;
  std::vector<ImuIncrement> propagated;
  std::vector<state::Epoch> starts;
  std::vector<std::pair<int64_t, state::Linearized>> updates;  ///< by stamp
  std::function<void(state::Epoch&)> spoil;                    ///< the state from now on, if any

  void add(const char* what, double ms) {
    calls.push_back(std::string(what) + "@" + std::to_string(static_cast<int>(std::lround(ms))));
  }
};

/// Stands at kPlace whatever its velocity; records what it is asked.
class FakeNavigator : public Navigator {
 public:
  FakeNavigator(Log& log, const Vector3d& velocity_n) : log_(log), velocity_n_(velocity_n) {}

  void start(const state::Epoch& initial) override {
    log_.starts.push_back(initial);
    now_ns_ = initial.t_ns;
    log_.add("start", ms_of(now_ns_));
  }
  void propagate(const ImuIncrement& increment) override {
    EXPECT_EQ(increment.t_begin_ns, now_ns_) << "a propagation must begin where the last ended";
    log_.propagated.push_back(increment);
    now_ns_ = increment.t_end_ns;
  }
  state::Innovation innovation(const Observation& observation) const override {
    const state::Linearized z = linearize(observation);
    return {z.r, z.R};
  }
  void update(const ObservationPtr& observation) override {
    log_.updates.emplace_back(now_ns_, linearize(*observation));
    log_.add("update", ms_of(now_ns_));
  }
  void loosen(const state::NodeMatrix&) override { log_.add("loosen", ms_of(now_ns_)); }
  std::unique_ptr<Navigator> ahead(double) const override {
    static Log unseen;
    auto copy = std::make_unique<FakeNavigator>(unseen, velocity_n_);
    copy->now_ns_ = now_ns_;
    return copy;
  }
  void hold() override { log_.add("hold", ms_of(now_ns_)); }
  state::Epoch epoch() const override {
    state::Epoch epoch;
    epoch.t_ns = now_ns_;
    epoch.position = kPlace;
    epoch.velocity_n = velocity_n_;
    if (log_.spoil) log_.spoil(epoch);
    return epoch;
  }

 private:
  state::Linearized linearize(const Observation& observation) const {
    return observation.linearize(epoch(), {}, state::Layout{});
  }

  Log& log_;
  Vector3d velocity_n_;
  int64_t now_ns_ = 0;
};

struct RecordingSink : state::Sink {
  std::vector<double> epochs_ms;
  std::vector<state::FixResult> fixes;
  std::vector<state::Notice> notices;
  std::vector<state::PredictionResult> predictions;
  bool predict = false;
  std::size_t stop_catching_up_at = 0;  ///< measurements left
  std::function<void()> stop;
  void catching_up(std::size_t left) override {
    if (stop && left == stop_catching_up_at) stop();
  }
  bool wants_predictions() const override { return predict; }
  void prediction(const state::PredictionResult& p) override { predictions.push_back(p); }
  void epoch(const state::Epoch& e) override { epochs_ms.push_back(ms_of(e.t_ns)); }
  void fix(const state::FixResult& f) override { fixes.push_back(f); }
  void observation(const state::ObservationResult& o) override { observations.push_back(o); }
  std::vector<state::ObservationResult> observations;
  void notice(const state::Notice& n) override { notices.push_back(n); }
};

inline GnssFix fix_at(double ms, const Vector3d& offset_n = Vector3d::Zero(), double sigma = 0.1) {
  GnssFix fix;
  fix.t_ns = at(ms);
  fix.antenna = LocalFrame(kPlace).to_geodetic(offset_n);
  fix.position_covariance = sigma * sigma * Eigen::Matrix3d::Identity();
  fix.velocity_n = Vector3d::Zero();
  fix.velocity_covariance = 0.01 * Eigen::Matrix3d::Identity();
  fix.quality = FixQuality::fixed_rtk;
  return fix;
}

inline ImuIncrement increment_between(double begin_ms, double end_ms) {
  ImuIncrement increment;
  increment.t_begin_ns = at(begin_ms);
  increment.t_end_ns = at(end_ms);
  increment.dtheta_b = Vector3d(0.1, 0, 0) * increment.dt();
  increment.dvel_b = Vector3d(0, 0, -9.8) * increment.dt();
  return increment;
}

}  // namespace foucault::testing
