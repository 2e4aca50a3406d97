#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <string>

#include "foucault/content/run_report.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"

/// A made-up drive with everything a report shows: standing still, turns, an outage, an IMU gap,
/// float fixes, rejected fixes, a reference. The numbers look like a car's; no physics is meant.
namespace foucault::content {

struct DemoRun {
  double duration = 600;  ///< [s]
  bool with_reference = true;
  bool with_outage = true;
  int64_t start_ns = 1'752'003'258'000'000'000;
};

class DemoDriver {
 public:
  explicit DemoDriver(const DemoRun& run) : run_(run) {}

  void drive(RunReport& report) {
    report.notice(
        {stamp(2), state::NoticeKind::aligned, "heading 61.3° ± 0.8° from the course over ground"});
    if (run_.with_outage) report.outage(stamp(kOutage), stamp(kOutage + 60));
    for (int i = 0; i * kStep < run_.duration; ++i) step(i, report);
    report.consistency(consistency());
  }

 private:
  static constexpr double kStep = 0.25;
  static constexpr double kOutage = 300;

  int64_t stamp(double t) const { return run_.start_ns + nanoseconds(t); }

  bool in_outage(double t) const { return run_.with_outage && t > kOutage && t < kOutage + 60; }

  /// 1-sigma of position [m]: settles, grows in the outage.
  double sigma(double t) const {
    const double settling = 0.012 + 0.5 * std::exp(-t / 6);
    return in_outage(t) ? settling + 6e-4 * std::pow(t - kOutage, 2) : settling;
  }

  Eigen::Vector3d noise(double scale) {
    return scale * Eigen::Vector3d(normal_(rng_), normal_(rng_), normal_(rng_));
  }

  void move(double t) {
    const double speed = t < 40 ? 0 : 11 + 4 * std::sin(t / 37);
    heading_ += kStep * (t < 40 ? 0 : 0.06 * std::sin(t / 21) + 0.05 * std::sin(t / 7.3));
    velocity_ = {speed * std::cos(heading_), speed * std::sin(heading_), 0.3 * std::sin(t / 30)};
    place_.latitude += kStep * velocity_.x() / 6.36e6;
    place_.longitude += kStep * velocity_.y() / (6.38e6 * std::cos(place_.latitude));
    place_.height -= kStep * velocity_.z();
    drift_ = 0.97 * drift_ + noise(0.25 * sigma(t));
    bias_walk_ += noise(0.02);
  }

  state::Epoch epoch(double t) const {
    state::Epoch e;
    e.t_ns = stamp(t);
    e.position = place_;
    e.velocity_n = velocity_;
    e.q_n_b = so3::from_euler({0.02 * std::sin(t / 5), 0.03 * std::sin(t / 17), heading_});
    e.bias.gyro = (Eigen::Vector3d(12, -30, 55) + bias_walk_) / 206264.8;
    e.bias.accel = 1e-5 * (Eigen::Vector3d(300, -120, 40) + 10 * bias_walk_);
    const double settled = std::exp(-t / 60);
    state::NodeVector s;
    s << Eigen::Vector3d::Constant(sigma(t)), Eigen::Vector3d::Constant(0.01 + sigma(t) / 8),
        Eigen::Vector3d(0.001, 0.001, 0.002 + 0.02 * settled),
        Eigen::Vector3d::Constant((4 + 60 * settled) / 206264.8),
        Eigen::Vector3d::Constant(1e-5 * (30 + 400 * settled));
    e.covariance = s.cwiseAbs2().asDiagonal();
    return e;
  }

  state::FixResult fix(double t) {
    state::FixResult f;
    f.t_ns = stamp(t);
    f.quality = t > 42 && t < 52 ? FixQuality::float_rtk : FixQuality::fixed_rtk;
    if (t > 480 && t < 490) f.quality = FixQuality::single;
    if (f.quality == FixQuality::single) f.verdict = state::FixVerdict::gated;
    f.antenna = place_;
    const double scale = f.quality == FixQuality::fixed_rtk   ? 0.014
                         : f.quality == FixQuality::float_rtk ? 0.15
                                                              : 2.5;
    f.innovation_n = noise(scale);
    f.innovation_covariance = Eigen::Vector3d::Constant(1.2 * scale * scale).asDiagonal();
    f.postfit_n = 0.4 * f.innovation_n;
    return f;
  }

  state::ReferenceError error(double t) {
    state::ReferenceError e;
    e.t_ns = stamp(t);
    e.position_n = drift_;
    e.velocity_n = drift_ / 8 + noise(0.004);
    e.euler = noise(4e-4) + Eigen::Vector3d(0, 0, 0.015 * std::exp(-t / 60));
    return e;
  }

  static NormalizedSquare square(NormalizedKind kind, int64_t t_ns, double value) {
    NormalizedSquare s;
    s.t_ns = t_ns;
    s.kind = kind;
    s.value = value;
    return s;
  }

  static void add_fix(const state::FixResult& fix, RunReport& report) {
    report.fix(fix);
    const double variance = fix.innovation_covariance(0, 0);
    NormalizedSquare nis =
        square(NormalizedKind::innovation, fix.t_ns, fix.innovation_n.squaredNorm() / variance);
    nis.used = fix.verdict == state::FixVerdict::used;
    if (nis.used) nis.running_mean = 2.7;
    report.normalized_square(nis);
  }

  /// What a perfect filter has.
  Consistency consistency() const {
    Consistency c;
    c.single_band = {0.2158, 9.3484};
    c.running_mean_band = {2.19, 3.94};
    c.nis = {2000, 1500, 3.02, {2.88, 3.12}, 0.951};
    for (ResidualStatistics& s : c.innovations) {
      s = {2000, 0, 1, 0.0, {0.683, 0.954, 0.997}, {}};
      for (std::size_t i = 0; i < ResidualHistogram::kBins; ++i) {
        const double z =
            (static_cast<double>(i) + 0.5) * ResidualHistogram::kWidth - ResidualHistogram::kLimit;
        s.histogram.counts[i] = std::lround(2000 * ResidualHistogram::kWidth *
                                            std::exp(-z * z / 2) / std::sqrt(2 * M_PI));
      }
    }
    c.autocorrelation = {2000, kStep, 0.044, {}, 0.05};
    for (int k = 0; k < 40; ++k)
      c.autocorrelation.lag.push_back({0.03, -0.02, k == 3 ? 0.06 : 0.01});
    c.predictions = {{5, 4, 3.1, {1.5, 5.0}}, {15, 4, 2.7, {1.5, 5.0}}, {30, 4, 3.4, {1.5, 5.0}}};
    if (run_.with_reference) c.position_nees = SquareConsistency{2400, 120, 3.2, {2.6, 3.5}, 0.93};
    return c;
  }

  void step(int i, RunReport& report) {
    const double t = i * kStep;
    move(t);
    for (int k = 0; k < 25; ++k) {
      const double imu_t = t + 0.01 * k + 4e-4 * normal_(rng_);
      if (imu_t < 430 || imu_t > 430.8) report.imu_stamp(stamp(imu_t));
    }
    if (!in_outage(t)) add_fix(fix(t), report);
    const state::Epoch now = epoch(t);
    report.epoch(now);
    if (!run_.with_reference) return;
    const state::ReferenceError now_error = error(t);
    report.reference_error(now, now_error);
    report.normalized_square(square(NormalizedKind::position, now_error.t_ns,
                                    now_error.position_n.squaredNorm() / std::pow(sigma(t), 2)));
  }

  DemoRun run_;
  std::mt19937 rng_{42};
  std::normal_distribution<double> normal_;
  Geodetic place_{0.6998, -1.8351, 1600};
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d drift_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d bias_walk_ = Eigen::Vector3d::Zero();
  double heading_ = 1.07;
};

inline void fill_demo(const DemoRun& run, RunReport& report) {
  DemoDriver(run).drive(report);
  report.key_number({"Horizontal RMS error", "2.1", "cm", "against the reference"});
  report.key_number({"Vertical RMS error", "1.4", "cm", ""});
  report.key_number({"Innovation RMS, horizontal", "1.9", "cm", "2160 fixes"});
  report.key_number({"Processing time", "4.3", "s", "140 times real time"});
}

inline const RunLabels kLabels{"trip.rawlog", "refined", "foucault 0.1.0",
                               "foucault run trip.rawlog --out trip",
                               "imu:\n  preset: ADIS16465\n"};

inline page::ReportPage demo_page(const DemoRun& run) {
  RunReport report(kLabels, state::Mounting{});
  fill_demo(run, report);
  return report.page();
}

inline const plot::Figure* find_figure(const page::ReportPage& page, const std::string& name) {
  for (const page::Section& section : page.sections) {
    for (const plot::Figure& figure : section.figures) {
      if (figure.name == name) return &figure;
    }
  }
  return nullptr;
}

inline const plot::Figure& figure_of(const page::ReportPage& page, const std::string& name) {
  const plot::Figure* const figure = find_figure(page, name);
  if (figure == nullptr) throw std::runtime_error("no figure " + name);
  return *figure;
}

inline const plot::Series& series_of(const plot::Panel& panel, const std::string& label) {
  for (const plot::Series& series : panel.series) {
    if (series.label == label) return series;
  }
  throw std::runtime_error("no series " + label);
}

inline const page::Section& section_of(const page::ReportPage& page, const std::string& title) {
  for (const page::Section& section : page.sections) {
    if (section.title == title) return section;
  }
  throw std::runtime_error("no section " + title);
}

}  // namespace foucault::content
