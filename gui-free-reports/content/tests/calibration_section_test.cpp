#include "calibration_section.h"

#include <gtest/gtest.h>

#include "demo_run.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

state::Told told(bool mounting = false) {
  state::Told told;
  told.layout.add(state::block::lever_arm, 0.05);
  if (mounting) told.layout.add(state::block::mounting, 0.2);
  told.layout.add(state::block::time_offset, 0.3);
  told.time_offset_s = 0.2;
  told.lever_arm_b = {0.1, 0.2, -0.8};
  return told;
}

/// All shrinks to a tenth of its prior, but the vertical lever arm.
ReportPage page_of(const state::Told& told, int epochs = 100) {
  RunReport report(kLabels, state::Mounting{}, told);
  for (int i = 0; i < epochs; ++i) {
    state::Epoch epoch = state::with_slow_blocks({}, told.layout);
    epoch.t_ns = nanoseconds(i);
    state::slow_part(epoch.covariance) *= i == 0 ? 1 : 0.01;
    if (const state::SlowBlock* arm = told.layout.find(state::block::lever_arm)) {
      state::part(epoch.covariance, *arm, *arm)(2, 2) = 0.048 * 0.048;
    }
    if (i > 0) epoch.slow.setConstant(0.01);
    report.epoch(epoch);
  }
  return report.page();
}

TEST(CalibrationSection, EstimatesAreWholeAndInUnitsOfUsers) {
  const ReportPage page = page_of(told(true));
  const Figure& arms = figure_of(page, "calibration_arms");
  ASSERT_EQ(arms.panels.size(), 3U);
  EXPECT_EQ(arms.panels[2].title, "down");
  EXPECT_EQ(arms.panels[2].y.label, "Antenna");
  EXPECT_EQ(arms.panels[2].y.unit, "m");
  const Eigen::Vector3d arm_v =
      Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitZ()) *
      (Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()) * Eigen::Vector3d(0.11, 0.21, -0.79));
  EXPECT_NEAR(series_of(arms.panels[2], "estimate").y.back(), arm_v.z(), 1e-9)
      << "along the vehicle as its mounting was found";
  const Figure& vehicle = figure_of(page, "calibration_vehicle");
  ASSERT_EQ(vehicle.panels.size(), 3U);
  EXPECT_NEAR(series_of(vehicle.panels[0], "estimate").y.back(), 0.01 * 180 / M_PI, 1e-9);
  EXPECT_EQ(vehicle.panels[2].title, "Time offset") << "alone in its block, and maybe long";
  EXPECT_NEAR(series_of(vehicle.panels[2], "estimate").y.back(), 210, 1e-9);
  EXPECT_EQ(vehicle.panels[2].note, "210 ± 30 ms");
}

TEST(CalibrationSection, BoundsOfTheEstimateAndOfThePrior) {
  const Figure arms = figure_of(page_of(told()), "calibration_arms");
  const Series& band = series_of(arms.panels.at(0), "±3σ");
  EXPECT_NEAR(band.upper.back() - band.lower.back(), 6 * 0.005, 1e-9);
  EXPECT_THROW(series_of(arms.panels.at(0), "prior ±3σ"), std::runtime_error) << "far outside";
  const Panel& down = arms.panels.at(2);
  std::vector<double> prior;
  for (const Series& series : down.series) {
    if (series.label != "prior ±3σ") continue;
    EXPECT_EQ(series.dash, plot::Dash::dashes);
    prior.push_back(series.y.at(0));
  }
  ASSERT_EQ(prior.size(), 2U);
  EXPECT_NEAR(prior[0], -0.80 - 0.15, 1e-9);
  EXPECT_NEAR(prior[1], -0.80 + 0.15, 1e-9);
}

TEST(CalibrationSection, NamesWhatTheRecordingDoesNotTell) {
  const Section section = section_of(page_of(told()), "Calibration");
  ASSERT_EQ(section.paragraphs.size(), 1U);
  EXPECT_EQ(
      section.paragraphs[0],
      "Antenna, down: the recording tells hardly anything of it; its sigma stays near that of "
      "the prior.");
  ASSERT_EQ(section.tables.at(0).rows.size(), 4U);
  EXPECT_EQ(section.tables[0].rows[2],
            (std::vector<std::string>{"Antenna, down", "m", "−0.790", "0.048", "0.0500", "96 %"}));

  state::Told seen;
  seen.layout.add(state::block::wheel_scale, 0.05);
  EXPECT_TRUE(section_of(page_of(seen), "Calibration").paragraphs.empty());
  EXPECT_NE(section_of(page_of(seen, 1), "Calibration").paragraphs.at(0).find("Wheel scale: "),
            std::string::npos)
      << "nothing but the prior yet";
}

TEST(CalibrationSection, WarnsOfWhatWentAstray) {
  state::Told told;
  told.layout.add(state::block::gyro_scale, 1e-3);
  RunReport report(kLabels, state::Mounting{}, told);
  state::Epoch epoch = state::with_slow_blocks({}, told.layout);
  epoch.slow << 0, 0.0066, 0;
  state::slow_part(epoch.covariance)(2, 2) *= 0.01;
  report.epoch(epoch);
  const std::vector<std::string> words = section_of(report.page(), "Calibration").paragraphs;
  ASSERT_EQ(words.size(), 2U);
  EXPECT_EQ(words[0].find("Gyro scale, x: "), 0U);
  EXPECT_EQ(words[1].find("Gyro scale, y: "), 0U);
  EXPECT_NE(words[1].find("Do not believe"), std::string::npos);
}

/// A smoother has one value for the whole recording: what became known when, its run forward tells.
TEST(CalibrationSection, ASmoothedRunShowsTheForwardOneAndItsOwnValue) {
  state::Told told;
  told.layout.add(state::block::wheel_scale, 0.05);
  RunReport report(kLabels, state::Mounting{}, told);
  for (int i = 0; i < 100; ++i) {
    state::Epoch forward = state::with_slow_blocks({}, told.layout);
    forward.t_ns = nanoseconds(i);
    forward.slow.setConstant(0.02);
    state::slow_part(forward.covariance) /= 1 + i;
    report.forward_epoch(forward);
    state::Epoch smoothed = forward;
    smoothed.slow.setConstant(0.01);
    state::slow_part(smoothed.covariance).setConstant(0.001 * 0.001);
    report.epoch(smoothed);
  }
  const Figure figure = figure_of(report.page(), "calibration_vehicle");
  const Panel& panel = figure.panels.at(0);
  EXPECT_NEAR(series_of(panel, "run forward").y.at(50), 2, 1e-9);
  const Series& band = series_of(panel, "±3σ");
  EXPECT_GT(band.upper.front() - band.lower.front(), 9 * (band.upper.back() - band.lower.back()));
  const Series& smoothed = series_of(panel, "smoothed");
  EXPECT_NEAR(smoothed.y.at(0), 1, 1e-9);
  EXPECT_EQ(smoothed.x, (std::vector<double>{0, 99}));
  EXPECT_EQ(panel.note, "1.00 ± 0.10 %");
  EXPECT_LT(*panel.y.min, 0.7) << "its bounds are on the axis";
  EXPECT_NE(figure.caption.find("run forward"), std::string::npos);
}

TEST(CalibrationSection, EveryBlockHasItsPanels) {
  state::Told all;
  for (const state::Block& block :
       {state::block::gyro_scale, state::block::accel_scale, state::block::gyro_cross_axis,
        state::block::accel_cross_axis, state::block::lever_arm, state::block::time_offset,
        state::block::time_drift, state::block::mounting, state::block::wheel_scale}) {
    all.layout.add(block, 0.1);
  }
  all.layout.add({"lag", 2, "s"}, 0.1);
  const ReportPage page = page_of(all);
  std::size_t panels = 0;
  for (const Figure& figure : section_of(page, "Calibration").figures) {
    panels += figure.panels.size();
    for (const Panel& panel : figure.panels) {
      EXPECT_FALSE(series_of(panel, "estimate").y.empty()) << panel.title;
    }
  }
  EXPECT_EQ(panels, static_cast<std::size_t>(all.layout.slow_size()));
  EXPECT_EQ(figure_of(page, "calibration_other").panels.at(1).title, "2");
}

TEST(CalibrationSection, LongRunsTakeBoundedRoom) {
  const Panel panel = figure_of(page_of(told(), 30000), "calibration_arms").panels.at(0);
  EXPECT_LE(series_of(panel, "estimate").y.size(), 6000U);
}

TEST(CalibrationSection, NoneWithoutBlocks) {
  EXPECT_THROW(section_of(page_of({}), "Calibration"), std::runtime_error);
}

}  // namespace
}  // namespace foucault::content
