#include "foucault/laboratory/start_study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/imu/increments.h"
#include "foucault/measurement/gnss_position.h"
#include "foucault/measurement/gnss_velocity.h"
#include "foucault/simulation/simulated_source.h"
#include "foucault/state/vehicle_attitude.h"

namespace foucault::laboratory {
namespace {

using simulation::SimulatedSource;

constexpr double kDetermined = 10 * kDegree;
constexpr double kWell = 1 * kDegree;      // of the bound after 60 s ...
constexpr double kWithin = 3 * kDegree;    // ... and what is asked of the run then
constexpr double kWorstSigmas = 4;         // one in 16000
constexpr double kFirst = 60, kStep = 30;  // [s]

std::string describe(const simulation::RandomStart& start) {
  const simulation::ScenarioOptions& s = start.scenario;
  const char* const gnss = s.gnss_sigma_m.x() < 0.5        ? "RTK"
                           : s.gnss_velocity_sigma_m_s > 0 ? "single with velocity"
                                                           : "single";
  return fmt::format("{}, {} at {:.2g} Hz, {}, {}", s.name, gnss, s.gnss_rate_hz,
                     s.skip_s > 0 ? "in motion" : "at rest", start.imu);
}

double heading_of(const state::Epoch& epoch) {
  return state::vehicle_attitude(epoch, state::Mounting{}).euler.heading;
}
double heading_sigma_of(const state::Epoch& epoch) {
  return state::vehicle_attitude(epoch, state::Mounting{}).sigma.z();
}

/// A state that is true and of which nothing is known but where the first fix is.
state::Epoch told_the_truth(const SimulatedSource& source, const GnssFix& fix,
                            const imu::ImuNoise& noise) {
  using namespace state::block;
  constexpr double kSpeed = 10, kTilt = 10 * kDegree, kAnyHeading = 104 * kDegree;
  state::Epoch epoch = source.truth(fix.t_ns);
  state::NodeMatrix P = state::NodeMatrix::Zero();
  state::part(P, position, position) = fix.position_covariance;
  state::part(P.diagonal(), velocity).setConstant(kSpeed * kSpeed);
  const Eigen::Vector3d down_b = epoch.q_n_b.conjugate() * Eigen::Vector3d::UnitZ();
  state::part(P, attitude, attitude) =
      kTilt * kTilt * Eigen::Matrix3d::Identity() +
      (kAnyHeading * kAnyHeading - kTilt * kTilt) * down_b * down_b.transpose();
  const double gyro = std::hypot(noise.gyro_turn_on_sigma, noise.gyro_bias_sigma);
  const double accel = std::hypot(noise.accel_turn_on_sigma, noise.accel_bias_sigma);
  state::part(P.diagonal(), gyro_bias).setConstant(gyro * gyro);
  state::part(P.diagonal(), accel_bias).setConstant(accel * accel);
  epoch.covariance = P;
  return epoch;
}

/// Drives over the exact recording, so that the state stays true and every Jacobian is exact.
class Bound {
 public:
  Bound(const simulation::RandomStart& start, const StartProgram& program)
      : noise_(imu::imu_preset(start.imu)), source_(exact(start), imu::ImuNoise()) {
    navigator_ = program.filter(noise_);
  }

  void sigmas(StartOutcome& outcome) {
    while (const std::optional<Measurement> m = source_.next()) {
      if (const auto* fix = std::get_if<GnssFix>(&*m)) due_ = *fix;
      if (const auto* increment = std::get_if<ImuIncrement>(&*m)) pass(*increment);
      if (!begin_ns_) continue;
      const double age = seconds_between(*begin_ns_, stamp(*m));
      if (age <= 60) outcome.bound_60_s = heading_sigma_of(navigator_->epoch());
      if (age > 120) break;
    }
    outcome.bound_120_s = heading_sigma_of(navigator_->epoch());
  }

 private:
  static simulation::ScenarioOptions exact(const simulation::RandomStart& start) {
    simulation::ScenarioOptions options = start.scenario;
    options.gnss_noise = false;
    return options;
  }

  void pass(const ImuIncrement& increment) {
    ImuIncrement rest = increment;
    if (due_ && due_->t_ns > rest.t_begin_ns && due_->t_ns < rest.t_end_ns) {
      const auto [until, after] = imu::split(rest, due_->t_ns);
      if (begin_ns_) navigator_->propagate(until);
      use(*due_);
      rest = after;
    } else if (due_ && due_->t_ns == rest.t_begin_ns) {
      use(*due_);
    }
    if (begin_ns_) navigator_->propagate(rest);
    if (due_ && due_->t_ns == rest.t_end_ns) use(*due_);
  }

  void use(const GnssFix& fix) {
    if (!begin_ns_) {
      begin_ns_ = fix.t_ns;
      navigator_->start(told_the_truth(source_, fix, noise_));
    } else {
      navigator_->update(measurement::gnss_position(fix));
    }
    if (fix.velocity_n) navigator_->update(measurement::gnss_velocity(fix));
    due_.reset();
  }

  imu::ImuNoise noise_;
  SimulatedSource source_;
  std::unique_ptr<measurement::Navigator> navigator_;
  std::optional<GnssFix> due_;
  std::optional<int64_t> begin_ns_;
};

/// Compares the headings of a run with the truth.
class HeadingMeter : public state::Sink {
 public:
  HeadingMeter(const SimulatedSource& source, StartOutcome& outcome)
      : source_(source), outcome_(outcome) {}
  void epoch(const state::Epoch& epoch) override {
    if (!first_ns_) first_ns_ = epoch.t_ns;
    const double age = seconds_between(*first_ns_, epoch.t_ns);
    if (age < next_) return;
    next_ += kStep;
    const double error = so3::wrap(heading_of(epoch) - heading_of(source_.truth(epoch.t_ns)));
    outcome_.headings.push_back({age, error, heading_sigma_of(epoch)});
  }

  void warning(const state::Notice& notice) override { outcome_.warnings.push_back(notice.text); }

 private:
  const SimulatedSource& source_;
  StartOutcome& outcome_;
  std::optional<int64_t> first_ns_;
  double next_ = kFirst;
};

}  // namespace

bool StartOutcome::determined() const { return bound_120_s <= kDetermined; }

double StartOutcome::worst_normalized() const {
  double worst = 0;
  for (const Heading& h : headings) worst = std::max(worst, std::abs(h.error) / h.sigma);
  return worst;
}

bool StartOutcome::is_right() const {
  if (!started()) return !determined();
  if (headings.empty()) return false;
  const bool well = bound_60_s > kWell || std::abs(headings.front().error) < kWithin;
  return well && worst_normalized() < kWorstSigmas;
}

StartOutcome study_start(int64_t seed, const StartProgram& program) {
  const simulation::RandomStart start = simulation::random_start(seed);
  const imu::ImuNoise noise = imu::imu_preset(start.imu);
  StartOutcome outcome;
  outcome.seed = seed;
  outcome.what = describe(start);
  Bound(start, program).sigmas(outcome);
  SimulatedSource source(start.scenario, noise);
  HeadingMeter meter(source, outcome);
  try {
    const std::unique_ptr<state::Estimator> run = program.run(start.imu, source.mounting(), meter);
    while (const std::optional<Measurement> m = source.next()) run->process(*m);
    run->finish();
  } catch (const DataError& error) {
    outcome.refusal = error.what();
  }
  return outcome;
}

evaluation::TextTable start_table(const std::vector<StartOutcome>& outcomes) {
  evaluation::TextTable table;
  table.title = "Starts";
  table.header = {"seed",         "start",        "bound_60_deg", "bound_120_deg", "right",
                  "error_60_deg", "sigma_60_deg", "worst_sigmas", "refusal",       "warnings"};
  for (const StartOutcome& o : outcomes) {
    const bool known = !o.headings.empty();
    const auto degrees = [&](double angle) {
      return known ? fmt::format("{:.3f}", angle / kDegree) : std::string();
    };
    table.rows.push_back(
        {fmt::format("{}", o.seed), o.what, fmt::format("{:.3f}", o.bound_60_s / kDegree),
         fmt::format("{:.3f}", o.bound_120_s / kDegree), o.is_right() ? "yes" : "no",
         known ? degrees(o.headings.front().error) : "",
         known ? degrees(o.headings.front().sigma) : "",
         known ? fmt::format("{:.2f}", o.worst_normalized()) : "", o.refusal,
         fmt::format("{}", fmt::join(o.warnings, "; "))});
  }
  return table;
}

evaluation::TextTable start_summary(const std::vector<StartOutcome>& outcomes) {
  struct Sum {
    int all = 0, determined = 0, started = 0, right = 0, within = 0, compared = 0, warned = 0;
    double squares = 0, worst = 0;
  };
  std::map<std::string, Sum> sums;
  for (const StartOutcome& o : outcomes) {
    for (const std::string& kind : {o.what.substr(0, o.what.find(',')), std::string("~ all")}) {
      Sum& s = sums[kind];
      ++s.all;
      s.determined += o.determined() ? 1 : 0;
      s.started += o.started() ? 1 : 0;
      s.right += o.is_right() ? 1 : 0;
      s.warned += o.warnings.empty() ? 0 : 1;
      s.worst = std::max(s.worst, o.worst_normalized());
      for (const StartOutcome::Heading& h : o.headings) {
        const double square = std::pow(h.error / h.sigma, 2);
        s.squares += square;
        s.within += square < kWorstSigmas * kWorstSigmas ? 1 : 0;
        ++s.compared;
      }
    }
  }
  evaluation::TextTable table;
  table.title = "Random starts";
  table.header = {"vehicle",      "starts",         "determined", "begun",         "right",
                  "heading NEES", "within 4 sigma", "worst",      "false warnings"};
  for (const auto& [kind, s] : sums) {
    table.rows.push_back({kind, fmt::format("{}", s.all), fmt::format("{}", s.determined),
                          fmt::format("{}", s.started), fmt::format("{}", s.right),
                          fmt::format("{:.2f}", s.squares / std::max(1, s.compared)),
                          fmt::format("{:.1f} %", 100.0 * s.within / std::max(1, s.compared)),
                          fmt::format("{:.1f}", s.worst), fmt::format("{}", s.warned)});
  }
  return table;
}

}  // namespace foucault::laboratory
