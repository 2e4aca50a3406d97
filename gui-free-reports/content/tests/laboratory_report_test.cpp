#include "foucault/content/laboratory_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "foucault/plot/renderer.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

const std::vector<double> kDurations{0.1, 1, 10, 60};

/// Errors that grow as scale * x^power, in velocity and attitude a tenth and a hundredth of them.
LabCurve power_law(const std::string& key, double scale, double power,
                   const std::vector<double>& x) {
  LabCurve curve;
  curve.key = curve.title = key;
  curve.x = x;
  for (const double at : x) {
    curve.position_m.push_back(scale * std::pow(at, power));
    curve.velocity_m_s.push_back(0.1 * curve.position_m.back());
    curve.attitude_rad.push_back(0.01 * curve.position_m.back());
  }
  return curve;
}

LabMotionCurves made_up_motion(const std::string& title, double scale) {
  LabMotionCurves motion;
  motion.title = title;
  motion.models = {power_law("rough", 1e-2 * scale, 3, kDurations),
                   power_law("refined", 1e-4 * scale, 3, kDurations),
                   power_law("full", 1e-6 * scale, 1, kDurations)};
  motion.ablations = {power_law("none", 1e-6 * scale, 1, kDurations),
                      power_law("coriolis", 1e-3 * scale, 2, kDurations)};
  motion.small_noise = {power_law("tactical", 1e-4, 1.5, kDurations),
                        power_law("navigation", 1e-5, 1.5, kDurations)};
  motion.band_noise = {power_law("a", 1e-3, 1.5, kDurations),
                       power_law("b", 2e-3, 1.5, kDurations)};
  motion.rates = {power_law("full", 1e-3 * scale, -2, {50, 200, 1000})};
  motion.distances = {power_law("1 s", scale, 1, {0.1, 10, 600}),
                      power_law("60 s", 100 * scale, 1, {0.1, 10, 600})};
  return motion;
}

LabSettings settings() { return {200, 1, {1, 60}, "noise of the others"}; }

std::vector<LabMotionCurves> made_up_motions() {
  return {made_up_motion("Car", 1), made_up_motion("Airliner", 20)};
}

TEST(LaboratoryFigures, ModelsShareTheirRangeInPowersOfTen) {
  const Figure figure = model_errors(made_up_motions(), settings(), LabQuantity::velocity);
  ASSERT_EQ(figure.panels.size(), 2u);
  const Axis& y = figure.panels[0].y;
  EXPECT_EQ(*y.min, *figure.panels[1].y.min);
  EXPECT_EQ(*y.max, *figure.panels[1].y.max);
  EXPECT_NEAR(*y.min, 1e-8, 1e-20);
  EXPECT_NEAR(*y.max, 1e4, 1e-8);
  EXPECT_EQ(y.unit, "m/s");
}

TEST(LaboratoryFigures, BandHoldsAllItsImus) {
  const Figure figure = model_errors(made_up_motions(), settings(), LabQuantity::position);
  const Series& band = figure.panels[0].series[0];
  EXPECT_EQ(band.label, "noise of the others");
  EXPECT_NEAR(band.lower[1], 1e-3, 1e-12);
  EXPECT_NEAR(band.upper[1], 2e-3, 1e-12);
}

TEST(LaboratoryFigures, DotsAreTheErrorsOfTheirDuration) {
  const Figure figure = ablation_dots(made_up_motions(), settings(), LabQuantity::position);
  ASSERT_EQ(figure.panels.size(), 2u);
  const Panel& minute = figure.panels[1];
  EXPECT_EQ(minute.y.categories, (std::vector<std::string>{"coriolis", "none"}));
  EXPECT_NEAR(minute.series[1].x[1], 20 * 1e-3 * 3600, 1e-9) << "second motion, second term";
  EXPECT_NEAR(minute.series[1].y[0], 1, 0.3) << "the first term is on top";
  EXPECT_NEAR(minute.lines[0].at, 1e-4 * std::pow(60, 1.5), 1e-12);
}

TEST(LaboratoryFigures, DistancesHaveAPanelADuration) {
  const Figure figure = distance_lines(made_up_motions(), settings());
  ASSERT_EQ(figure.panels.size(), 2u);
  const Series& airliner = figure.panels[1].series.back();
  EXPECT_EQ(airliner.label, "Airliner");
  EXPECT_NEAR(airliner.y.back(), 20 * 100 * 600, 1e-6);
}

TEST(LaboratoryReportPage, IsDrawn) {
  LaboratoryReport report;
  report.settings = settings();
  report.motions = made_up_motions();
  const ReportPage page = laboratory_page(report);
  Renderer renderer;
  std::size_t figures = 0;
  for (const Section& section : page.sections) {
    for (const Figure& figure : section.figures) {
      EXPECT_GT(renderer.png(figure).size(), 10000u) << figure.name;
      ++figures;
    }
  }
  EXPECT_EQ(figures, 7u);
}

}  // namespace
}  // namespace foucault::content
