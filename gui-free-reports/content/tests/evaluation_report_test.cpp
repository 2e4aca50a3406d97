#include "foucault/content/evaluation_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <random>

#include "foucault/plot/renderer.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

const MethodOrder kMethods{"ekf", "refined", "rough"};

/// Outages whose drift is scale * t^2, with a scale of their own.
DriftCase made_up_case(const std::string& name, double scale) {
  DriftCase result{name, {}};
  for (size_t m = 0; m < kMethods.size(); ++m) {
    std::mt19937 rng{42};
    std::lognormal_distribution<double> spread(0, 0.5);
    MethodCurves curves{kMethods[m], {}};
    for (int i = 0; i < 20; ++i) {
      OutageCurve curve;
      const double a = scale * spread(rng) * (m == 2 ? 4 : 1 + 0.01 * double(m));
      for (int t = 0; t <= 60; ++t) {
        curve.since_begin_s.push_back(t);
        curve.horizontal_m.push_back(0.01 + a * t * t);
        curve.vertical_m.push_back(0.01 + 0.03 * a * t * t);
        curve.north_m.push_back(0.6 * curve.horizontal_m.back());
        curve.east_m.push_back(-0.8 * curve.horizontal_m.back());
      }
      curve.max_horizontal_m = curve.horizontal_m.back();
      curve.max_vertical_m = curve.vertical_m.back();
      curves.outages.push_back(curve);
    }
    result.methods.push_back(curves);
  }
  return result;
}

ErrorTimeline made_up_timeline() {
  ErrorTimeline timeline{"trip.rawlog", {}, {}};
  for (double begin = 510; begin < 1600; begin += 150) {
    timeline.outages.push_back({begin, begin + 60});
  }
  std::mt19937 rng{7};
  std::normal_distribution<double> normal;
  for (const std::string& method : kMethods) {
    ErrorTimeline::Curve curve{method, {}, {}};
    for (double t = 0; t < 1617; t += 1) {
      const double in_outage = t < 510 ? -1 : std::fmod(t - 510, 150);
      const bool out = in_outage > 0 && in_outage <= 60;
      const double drift = out ? (method == "rough" ? 6e-3 : 1.5e-3) * in_outage * in_outage : 0;
      curve.t_s.push_back(t);
      curve.horizontal_m.push_back(drift + 0.012 * std::exp(0.3 * normal(rng)));
    }
    timeline.curves.push_back(curve);
  }
  return timeline;
}

OutageMap made_up_map() {
  OutageMap map{"trip.rawlog", {}, {}, {{"ekf", {}}, {"refined", {}}, {"rough", {}}}};
  for (int t = 0; t < 1600; ++t) {
    const double a = 2 * M_PI * t / 1600;
    const double north = 1500 * std::sin(a) + 300 * std::sin(5 * a);
    const double east = 2200 * std::cos(a) + 250 * std::cos(7 * a);
    map.truth.north_m.push_back(north);
    map.truth.east_m.push_back(east);
    const int in_outage = t < 500 ? -1 : (t - 500) % 150;
    const double hole =
        in_outage >= 0 && in_outage <= 60 ? 0 : std::numeric_limits<double>::quiet_NaN();
    map.truth_in_outages.north_m.push_back(north + hole);
    map.truth_in_outages.east_m.push_back(east + hole);
    for (OutageMap::Estimate& estimate : map.estimates) {
      const double drift = (estimate.method == "rough" ? 0.03 : 0.01) * in_outage * in_outage;
      estimate.path.north_m.push_back(north + drift + hole);
      estimate.path.east_m.push_back(east + 0.4 * drift + hole);
    }
  }
  return map;
}

DistanceDrift made_up_distances() {
  DistanceDrift drift{"X", {}};
  for (const std::string& method : kMethods) {
    DistanceDrift::Method of_method;
    of_method.method = method;
    const double scale = method == "rough" ? 10 : 1;
    for (int i = 0; i < 40; ++i) {
      of_method.distance_km.push_back(1.5 * i);
      of_method.horizontal_m.push_back(scale * (1 + i % 5));
      of_method.vertical_m.push_back(0.1 * scale * (1 + i % 3));
    }
    for (const double km : {10.0, 30.0, 50.0}) {
      of_method.bins.push_back({km, {3 * scale, 2 * scale, 4 * scale}, {scale, 0.5, 2 * scale}});
    }
    drift.methods.push_back(of_method);
  }
  return drift;
}

NormalizedErrors made_up_normalized() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  NormalizedErrors errors{"X", {"5 s", "15 s", "30 s", "60 s", "middle"}, {}};
  for (size_t m = 0; m < kMethods.size(); ++m) {
    NormalizedErrors::Method method{kMethods[m], {}, {}};
    for (size_t i = 0; i < errors.times.size(); ++i) {
      const double grown = m == 2 ? std::pow(2, double(i)) : 1 + 0.1 * double(m);
      method.horizontal.push_back({grown, 0.6, 1.5});
      method.vertical.push_back(i == 3 ? Bounded{nan, nan, nan} : Bounded{0.9, 0.45, 1.8});
    }
    errors.methods.push_back(method);
  }
  return errors;
}

ParameterMap made_up_parameters() {
  ParameterMap map;
  map.name = "tune_arw_vrw";
  map.title = "Horizontal RMS drift";
  map.subtitle = "refined · ADIS16465";
  map.x_label = "arw_deg_sqrt_h";
  map.y_label = "vrw_m_s_sqrt_h";
  map.x = {0.05, 0.1, 0.2, 0.5, 1};
  map.y = {0.01, 0.02, 0.05, 0.1};
  for (size_t i = 0; i < 20; ++i) {
    const double dx = double(i % 5) - 2;
    const double dy = double(i / 5) - 1;
    map.values.push_back(i == 19 ? std::nan("") : 5.2 + dx * dx + 0.7 * dy * dy);
  }
  map.value_label = "RMS drift";
  map.value_unit = "m";
  map.chosen = {2, 1};
  return map;
}

EvaluationReport made_up_report() {
  EvaluationReport report;
  report.subtitle = "simulated, 4 IMUs, 60 s outages";
  report.methods = kMethods;
  report.remarks = {"Simulated recordings; no scale factor, temperature or mounting errors."};
  for (const auto& [name, scale] : {std::pair{"ICM20602", 4e-3}, std::pair{"ADIS16465", 1.4e-3}}) {
    report.cases.push_back(made_up_case(name, scale));
    for (const std::string& method : kMethods) {
      const double rms = (method == "rough" ? 4 : 1) * scale * 3600;
      report.rms.push_back(
          {name, method, {rms, 0.8 * rms, 1.25 * rms}, {0.03 * rms, 0.02 * rms, 0.04 * rms}});
    }
  }
  report.timelines = {made_up_timeline()};
  report.maps = {made_up_map()};
  report.distances = {made_up_distances()};
  report.normalized = {made_up_normalized()};
  report.consistency_tables = {{"Errors over their sigmas", "", false, {"Method"}, {{"ekf"}}}};
  report.footer = "foucault";
  return report;
}

TEST(EvaluationFigures, CurvesHaveAColumnAMethodAndARowAComponent) {
  const DriftCase drift_case = made_up_case("X", 1e-3);
  const Figure figure = drift_curves(drift_case, kMethods);
  ASSERT_EQ(figure.panels.size(), 6U);
  EXPECT_EQ(figure.columns, 3);
  EXPECT_EQ(figure.panels[0].y.max, figure.panels[2].y.max) << "equal axes";
  const Series& rms = figure.panels[0].series[1];
  double sum = 0;
  for (const OutageCurve& curve : drift_case.methods[0].outages) {
    sum += std::pow(curve.horizontal_m[60], 2);
  }
  EXPECT_NEAR(rms.y.back(), std::sqrt(sum / 20), 1e-9);
  EXPECT_EQ(rms.x.back(), 60);
}

TEST(EvaluationFigures, OfVeryManyOutagesCurvesAreASelection) {
  DriftCase many = made_up_case("a day", 1e-3);
  for (MethodCurves& curves : many.methods) {
    const std::vector<OutageCurve> twenty = curves.outages;
    for (int i = 0; i < 49; ++i) {
      curves.outages.insert(curves.outages.end(), twenty.begin(), twenty.end());
    }
  }
  const Figure few = drift_curves(made_up_case("a day", 1e-3), kMethods);
  const Figure figure = drift_curves(many, kMethods);
  for (size_t p = 0; p < figure.panels.size(); ++p) {
    const std::vector<double>& all = few.panels[p].series[0].y;
    const std::vector<double>& shown = figure.panels[p].series[0].y;
    EXPECT_EQ(shown.size(), 120 * 62u);  // 61 samples and a gap each
    const auto less = [](double a, double b) { return std::isnan(a) ? !std::isnan(b) : a < b; };
    EXPECT_EQ(*std::max_element(shown.begin(), shown.end(), less),
              *std::max_element(all.begin(), all.end(), less));
    const std::vector<double>& rms = figure.panels[p].series[1].y;  // of all
    ASSERT_EQ(rms.size(), few.panels[p].series[1].y.size());
    for (size_t i = 0; i < rms.size(); ++i) {
      EXPECT_NEAR(rms[i], few.panels[p].series[1].y[i], 1e-9 * rms[i]);  // summed in another order
    }
  }
  EXPECT_NE(figure.caption, few.caption);
}

TEST(EvaluationFigures, GrowthHasTheSlopeOfTheDrift) {
  const Figure figure = drift_growth(made_up_case("X", 1), kMethods);
  const Series& series = figure.panels[0].series[0];
  const size_t last = series.x.size() - 1;
  const double slope =
      std::log(series.y[last] / series.y[last / 2]) / std::log(series.x[last] / series.x[last / 2]);
  EXPECT_NEAR(slope, 2, 0.02) << "drift grows with t^2; linear interpolation adds a little";
}

TEST(EvaluationFigures, DistributionEndsAtAll) {
  const Figure figure = drift_distribution(made_up_case("X", 1e-3), kMethods);
  const Series& series = figure.panels[0].series[0];
  EXPECT_EQ(series.y.front(), 0);
  EXPECT_EQ(series.y.back(), 100);
  EXPECT_TRUE(std::is_sorted(series.x.begin(), series.x.end()));
  EXPECT_EQ(figure.panels[0].lines.size(), 3U);
}

TEST(EvaluationFigures, AMethodHasOneColourEverywhere) {
  DriftCase only_rough = made_up_case("X", 1e-3);
  only_rough.methods.erase(only_rough.methods.begin(), only_rough.methods.begin() + 2);
  const Ink ink = drift_growth(only_rough, kMethods).panels[0].series[0].ink;
  EXPECT_EQ(ink, drift_growth(made_up_case("X", 1e-3), kMethods).panels[0].series[2].ink);
  EXPECT_EQ(ink, error_timeline(made_up_timeline(), kMethods).panels[0].series[2].ink);
}

TEST(EvaluationFigures, AMethodLooksTheSameWhateverStandsBesideIt) {
  const DriftCase all = made_up_case("X", 1e-3);
  DriftCase one = all;
  one.methods = {all.methods[1]};
  const Series beside = maximum_drifts(all, kMethods).panels[0].series[1];
  const Series alone = maximum_drifts(one, {"refined"}).panels[0].series[0];
  EXPECT_EQ(beside.ink, alone.ink);
  EXPECT_EQ(beside.shape, alone.shape);
  EXPECT_EQ(beside.dash, alone.dash);
}

TEST(EvaluationFigures, TruthOfTheOutagesAloneIsNamedOnce) {
  OutageMap map = made_up_map();
  EXPECT_EQ(outage_map(map, kMethods).panels[0].series[0].label, "truth");
  map.truth = map.truth_in_outages;
  EXPECT_EQ(outage_map(map, kMethods).panels[0].series[0].label, "truth in outages");
}

TEST(EvaluationFigures, MaximaOfMethodsThatDriftAlikeAreAllSeen) {
  const std::vector<Series> series =
      maximum_drifts(made_up_case("X", 1e-3), kMethods).panels.at(0).series;
  ASSERT_GE(series.size(), 2U);
  for (size_t i = 1; i < series.size(); ++i) {
    EXPECT_LT(series[i].size, series[i - 1].size - 1) << "drawn over a larger one";
  }
}

TEST(EvaluationFigures, ErrorsInOutagesFillTheirPanels) {
  const Figure figure = outage_errors(made_up_case("X", 1e-3), kMethods);
  EXPECT_EQ(figure.panels.size(), 12U) << "of twenty";
  for (const Panel& panel : figure.panels) {
    EXPECT_EQ(*panel.x.min, -*panel.x.max);
    EXPECT_EQ(panel.y.max, panel.x.max);
    double farthest = 0;
    for (const Series& series : panel.series) {
      for (const double x : series.x) farthest = std::max(farthest, std::abs(x));
      for (const double y : series.y) farthest = std::max(farthest, std::abs(y));
    }
    // Round numbers are 5 / 3 apart at most.
    EXPECT_GE(*panel.x.max, farthest);
    EXPECT_LE(*panel.x.max, 1.08 * 5 / 3 * farthest);
  }
}

TEST(EvaluationFigures, SmallErrorsAtTheEndAreNotDrawnAtTheScaleOfLargeOnes) {
  DriftCase two{"X", {{"ekf", {}}, {"batch", {}}}};
  for (const double sign : {-1.0, 0.5, 1.0}) {
    OutageCurve large, small;
    large.east_m = large.north_m = {20 * sign};
    small.east_m = small.north_m = {0.02 * sign};
    two.methods[0].outages.push_back(large);
    two.methods[1].outages.push_back(small);
  }
  const Figure figure = end_errors(two, {"ekf", "batch"});
  EXPECT_GT(*figure.panels[0].x.max, 20);
  EXPECT_LT(*figure.panels[1].x.max, 0.2);
}

TEST(EvaluationFigures, TheEllipseHoldsNineteenOfTwenty) {
  std::mt19937 rng{42};
  std::normal_distribution<double> normal;
  DriftCase many{"X", {{"ekf", {}}}};
  for (int i = 0; i < 4000; ++i) {
    OutageCurve curve;
    curve.east_m = {3 + 2 * normal(rng)};
    curve.north_m = {0.5 * normal(rng)};
    many.methods[0].outages.push_back(curve);
  }
  const Figure figure = end_errors(many, {"ekf"});
  const Series& ellipse = figure.panels[0].series[0];
  const double half = std::sqrt(-2 * std::log(0.05));  // chi-square of 2 degrees
  const auto [west, east] = std::minmax_element(ellipse.x.begin(), ellipse.x.end());
  EXPECT_NEAR(*east, 3 + 2 * half, 0.2);
  EXPECT_NEAR(*west, 3 - 2 * half, 0.2);
}

TEST(EvaluationFigures, AblationHasABarAPart) {
  const Figure figure = ablation_bars(
      {{"ekf", "", 1, 2}, {"ekf", "wheel_speed", 3, 4}, {"batch", "", 5, 6}}, kMethods);
  EXPECT_EQ(figure.panels[0].x.categories, (std::vector<std::string>{"nothing", "wheel speed"}));
  EXPECT_EQ(figure.panels[0].x.label, "Left out");
  EXPECT_EQ(figure.panels[1].series[1].y, (std::vector<double>{2, 4})) << "ekf after batch";
}

TEST(EvaluationFigures, DistancesShowEveryOutageAndTheBinsOnTop) {
  const Figure figure = drift_by_distance(made_up_distances(), kMethods);
  ASSERT_EQ(figure.panels.size(), 2U);
  const std::vector<Series>& series = figure.panels[0].series;
  ASSERT_EQ(series.size(), 9U);
  for (size_t m = 0; m < 3; ++m) {
    EXPECT_EQ(series[m].x.size(), 40U);
    const Series& line = series[3 + 2 * m];
    const Series& bins = series[4 + 2 * m];
    EXPECT_EQ(line.label, kMethods[m]);
    EXPECT_EQ(line.y, bins.y);
    EXPECT_EQ(bins.upper.size(), 3U);
    // Set aside a little, so that methods that agree are all seen.
    EXPECT_NEAR(bins.x[1], 30, 1);
    EXPECT_TRUE(m == 0 || bins.x[1] > series[2 + 2 * m].x[1]);
  }
}

TEST(EvaluationFigures, NormalizedDriftIsSeenBesideItsBand) {
  const Figure figure = normalized_drift(made_up_normalized(), kMethods);
  ASSERT_EQ(figure.panels.size(), 2U);
  const Panel& panel = figure.panels[0];
  ASSERT_EQ(panel.series.size(), 4U);
  EXPECT_EQ(panel.series[0].mark, Mark::band);
  EXPECT_EQ(panel.series[0].upper[0], 1.5);
  EXPECT_EQ(panel.x.categories.size(), 5U);
  for (size_t m = 1; m < 4; ++m) {
    EXPECT_EQ(panel.series[m].label, kMethods[m - 1]);
    EXPECT_NEAR(panel.series[m].x[2], 2, 0.42) << "within the band's width";
  }
  EXPECT_EQ(panel.series[3].y[4], 16);
  // Where there is no number there is no band.
  EXPECT_EQ(figure.panels[1].series[0].x.size(), 4 * 3U);
}

TEST(EvaluationFigures, MapsThatReachFarAreInKilometres) {
  EXPECT_EQ(outage_map(made_up_map(), kMethods).panels[0].x.shown_unit, "");
  OutageMap far = made_up_map();
  far.truth.north_m.back() = 21e3;
  const Panel panel = outage_map(far, kMethods).panels[0];
  EXPECT_EQ(panel.x.shown_unit, "km");
  EXPECT_EQ(panel.y.shown_factor, 1e-3);
}

TEST(EvaluationFigures, SurviveEmptyResults) {
  const DriftCase empty{"none", {{"ekf", {}}}};
  for (const Figure& figure :
       {drift_curves(empty, kMethods), maximum_drifts(empty, kMethods),
        drift_distribution(empty, kMethods), drift_growth(empty, kMethods), drift_bars({}, {}),
        error_timeline({}, {}), outage_map({}, {}), parameter_map({}), drift_by_distance({}, {}),
        normalized_drift({}, {})}) {
    EXPECT_NO_THROW(Renderer().png(figure)) << figure.name;
  }
}

TEST(EvaluationReportPage, IsWrittenWhole) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / "foucault_evaluation_report";
  ReportPage page = evaluation_page(made_up_report());
  page.sections.push_back({"Tuning", {}, {}, {parameter_map(made_up_parameters())}});
  write_report(page, folder);
  for (const char* name : {"drift_rms", "drift_curves_icm20602", "drift_growth_adis16465",
                           "error_timeline_trip_rawlog", "outage_map_trip_rawlog",
                           "drift_by_distance_x", "normalized_drift_x", "tune_arw_vrw"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / (std::string(name) + ".png"))) << name;
  }
  if (std::getenv("FOUCAULT_KEEP_REPORT") == nullptr) std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace foucault::content
