#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/obs/gnss_messages_novatel.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/log_surgery.h"
#include "support/program.h"
#include "support/table.h"
#include "support/test_folder.h"

/// Consistency and timeline of the report, by the built program on simulated recordings.
namespace foucault::test {
namespace {

using mrpt::obs::CObservationGPS;
using mrpt::obs::CObservationIMU;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr int kDuration = 300;

class Report : public testing::Test {
 protected:
  Report() {
    const Outcome made =
        foucault({"simulate", "--imu", "ADIS16465", "--duration", std::to_string(kDuration),
                  "--seed", "7", "--set", "scenario.rest_s=15", "--set", "scenario.imu_rate_hz=100",
                  "--out", folder_ / "trip.rawlog"});
    EXPECT_EQ(made.exit_code, 0) << made.err;
  }

  /// metrics.json of a run.
  json run(const std::string& log, const std::string& name,
           const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"run", folder_ / log, "--method",
                                       "ekf", "--out",       folder_ / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = foucault(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(folder_.text(name + "/metrics.json"));
  }

  json section(const std::string& name, const std::string& title) const {
    const json report = json::parse(folder_.text(name + "/report/report.json"));
    for (const json& each : report["sections"]) {
      if (each["title"] == title) return each;
    }
    ADD_FAILURE() << "no section " << title;
    return {};
  }

  std::vector<std::string> lanes(const std::string& name) const {
    const json figure = json::parse(folder_.text(name + "/report/timeline.json"));
    return figure["panels"][0]["y"]["categories"];
  }

  std::set<std::string> series(const std::string& name, const std::string& figure) const {
    const json content = json::parse(folder_.text(name + "/report/" + figure + ".json"));
    std::set<std::string> labels;
    for (const json& each : content["panels"][0]["series"]) labels.insert(each["label"]);
    return labels;
  }

  TestFolder folder_;
};

TEST_F(Report, ShowsAidsAndCalibrationWhereThereAreAny) {
  const auto titles = [&](const std::string& name) {
    const json report = json::parse(folder_.text(name + "/report/report.json"));
    std::set<std::string> titles;
    for (const json& each : report["sections"]) titles.insert(each["title"]);
    return titles;
  };
  run("trip.rawlog", "bare", {"--set", "aids.mode=none", "--set", "calibrate.mode=none"});
  EXPECT_THAT(titles("bare"), Not(testing::Contains(testing::AnyOf("Aids", "Calibration"))));

  const json metrics = run("trip.rawlog", "aided",
                           {"--set", "aids.nonholonomic=on", "--set", "calibrate.mounting=on",
                            "--set", "calibrate.lever_arm=on"});
  const json aids = section("aided", "Aids");
  const json& first = aids["tables"][0]["rows"][0];
  EXPECT_EQ(first[0], "Nonholonomic");
  EXPECT_EQ(first[1], std::to_string(int(metrics["aids"]["nonholonomic"]["used"])));
  EXPECT_THAT(series("aided", "aid_innovations"), testing::Contains("used"));
  const std::string untold = section("aided", "Calibration")["paragraphs"][0];
  EXPECT_THAT(untold,
              testing::AllOf(HasSubstr("Antenna, down"), Not(HasSubstr("Mounting, heading")),
                             HasSubstr("tells hardly anything of it")));
  const Table arms(folder_ / "aided/report/calibration_arms.csv");
  EXPECT_NEAR(arms.column("antenna_down_m").back(),
              metrics["calibration"]["lever_arm"]["value"][2].get<double>(), 1e-5);
}

double mean_of(const json& squares) { return squares["mean"]; }

TEST_F(Report, OfACleanTripIsCalmAndConsistent) {
  const json consistency = run("trip.rawlog", "clean")["consistency"];
  EXPECT_NEAR(consistency["bound_high"], 9.348404, 1e-6);
  const json& nis = consistency["nis"];
  EXPECT_GT(nis["samples"], 200);
  EXPECT_LE(nis["effective_samples"], nis["samples"]);
  EXPECT_GT(mean_of(nis), nis["mean_low"]);
  EXPECT_LT(mean_of(nis), nis["mean_high"]);
  // Of 300 fixes 95 % are inside: sigma 1.3 %.
  EXPECT_NEAR(nis["inside_95"], 0.95, 0.05);
  for (const char* axis : {"north", "east", "down"}) {
    // Sigma of a sigma 1 / sqrt(2 n): 4 %.
    EXPECT_NEAR(consistency["whitened_innovation"][axis]["sigma"], 1, 0.16) << axis;
  }
  EXPECT_LT(consistency["autocorrelation"]["outside_share"], 0.15);
  for (const char* kind : {"position_nees", "velocity_nees", "attitude_nees"}) {
    // One trip has few independent errors; the band is for so many.
    EXPECT_LT(mean_of(consistency[kind]), 1.5 * consistency[kind]["mean_high"].get<double>());
    EXPECT_LT(consistency[kind]["effective_samples"], consistency[kind]["samples"]);
  }

  EXPECT_THAT(section("clean", "Timeline")["paragraphs"][0], HasSubstr("Nothing happened"));
  EXPECT_EQ(lanes("clean").size(), 3U) << "alignment, fixes used, IMU";
  const json figures = section("clean", "Consistency")["figures"];
  EXPECT_EQ(figures, (json{"nis", "innovation_whiteness", "nees"}));
  for (const json& figure : figures) {
    EXPECT_GT(folder_.text("clean/report/" + figure.get<std::string>() + ".png").size(), 10'000U);
  }
}

TEST_F(Report, MetricsSayWhenWhereFromAndWithWhat) {
  const json m = run("trip.rawlog", "clean", {"--no-report"});
  EXPECT_EQ(m["schema_version"], 1);
  EXPECT_THAT(m["command"], HasSubstr("--no-report"));
  EXPECT_THAT(m["start"]["utc"].get<std::string>(), testing::EndsWith("Z"));
  EXPECT_NEAR(m["end"]["gps_second"].get<double>() - m["start"]["gps_second"].get<double>(),
              m["duration_s"], 1e-6);
  EXPECT_GT(m["distance_m"], 100);
  EXPECT_EQ(m["notices"][0]["kind"], "aligned");
  for (const char* name : {"mrpt", "ceres", "eigen", "opencv"}) {
    EXPECT_THAT(m["libraries"][name].get<std::string>(), HasSubstr(".")) << name;
  }
}

TEST_F(Report, NoneOfAnEarlierRunStaysBesideNewMetrics) {
  run("trip.rawlog", "run");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run/report/index.html"));
  run("trip.rawlog", "run", {"--no-report"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run/report"));
}

TEST_F(Report, TheReferenceIsThereAsTheSolutionIs) {
  run("trip.rawlog", "run", {"--no-report", "--set", "calibrate.mode=none"});
  const std::vector<std::string> solution = folder_.lines("run/solution.tum");
  const std::vector<std::string> reference = folder_.lines("run/reference.tum");
  EXPECT_THAT(reference[0], testing::StartsWith("# East-North-Up of the first epoch"));
  const auto pose = [](const std::string& line) {
    std::istringstream words(line);
    std::vector<double> numbers(8);
    for (double& number : numbers) words >> number;
    return numbers;
  };
  const std::vector<double> last = pose(solution.back());
  const auto at = std::find_if(reference.begin() + 1, reference.end(), [&](const auto& line) {
    return std::abs(pose(line)[0] - last[0]) < 1e-3;
  });
  ASSERT_NE(at, reference.end());
  for (size_t i = 1; i < 4; ++i) EXPECT_NEAR(pose(*at)[i], last[i], 0.1);
  for (size_t i = 4; i < 8; ++i) EXPECT_NEAR(std::abs(pose(*at)[i]), std::abs(last[i]), 0.02);
}

TEST_F(Report, RunsAreShownTogether) {
  run("trip.rawlog", "a", {"--no-report"});
  run("trip.rawlog", "b", {"--no-report", "--set", "gnss.sigma_scale=2"});
  const Outcome both = foucault({"compare", folder_ / "a", folder_ / "b", "--out", folder_ / "c"});
  ASSERT_EQ(both.exit_code, 0) << both.err;
  const json overview = section("c", "Overview");
  EXPECT_EQ(overview["tables"][1]["rows"].size(), 6U) << "three axes of position and attitude";
  EXPECT_EQ(overview["figures"].size(), 4U);
  EXPECT_EQ(foucault({"compare", folder_ / "a", "--out", folder_ / "d"}).exit_code, 2);
  const Outcome none = foucault({"compare", folder_ / "a", folder_ / "x", "--out", folder_ / "d"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("x/solution.csv"));
}

/// Negative control: a filter that takes fixes for twice as good, or half as good, as they are.
TEST_F(Report, SigmasThatAreWrongByTwoAreSeen) {
  const json small =
      run("trip.rawlog", "small",
          {"--no-report", "--set", "gnss.sigma_scale=0.5", "--set", "calibrate.noise=off"});
  EXPECT_GT(mean_of(small["consistency"]["nis"]), small["consistency"]["nis"]["mean_high"]);
  EXPECT_LT(small["consistency"]["nis"]["inside_95"], 0.85);
  const json large =
      run("trip.rawlog", "large",
          {"--no-report", "--set", "gnss.sigma_scale=2", "--set", "calibrate.noise=off"});
  EXPECT_LT(mean_of(large["consistency"]["nis"]), large["consistency"]["nis"]["mean_low"]);
}

/// Every tenth fix 20 m off, none for 20 s, ten without sigmas, IMU holes of 0.5 and 20 s.
TEST_F(Report, OfATripWithFaultsShowsEachInItsLane) {
  int fixes = 0;
  int samples = 0;
  const auto damage_fix = [&fixes](CObservationGPS& gps) {
    ++fixes;
    auto& fix = gps.getMsgByClass<mrpt::obs::gnss::Message_NV_OEM6_BESTPOS>().fields;
    if (fixes > 60 && fixes % 10 == 5) fix.lat += 20 / 111e3;
    if (fixes > 100 && fixes <= 110) set_sigma(gps, 0);
    return fixes <= 130 || fixes > 150;
  };
  const auto damage_imu = [&samples](CObservationIMU&) {
    ++samples;
    return (samples < 18'000 || samples >= 18'050) && (samples < 23'000 || samples >= 25'000);
  };
  const Operation gnss = on_gnss(damage_fix);
  const Operation imu = on_imu(damage_imu);
  operate_on_log(folder_ / "trip.rawlog", folder_ / "faults.rawlog",
                 [&](mrpt::obs::CObservation& o) { return gnss(o) && imu(o); });
  const json metrics =
      run("faults.rawlog", "faults", {"--set", "aids.mode=none", "--set", "calibrate.mode=none"});
  EXPECT_GT(metrics["gnss"]["rejected"], 20);
  EXPECT_EQ(metrics["consistency"]["nis"]["samples"], metrics["gnss"]["samples"]);

  const std::string lane_names = json(lanes("faults")).dump();
  EXPECT_THAT(lane_names, HasSubstr("gated ("));
  EXPECT_THAT(lane_names, HasSubstr("bad sigma (10)"));
  EXPECT_THAT(lane_names, HasSubstr("notices"));
  const std::string summary = section("faults", "Timeline")["paragraphs"][0];
  EXPECT_THAT(summary, Not(HasSubstr("Nothing")));
  EXPECT_THAT(summary, HasSubstr("10 bad sigma"));
  EXPECT_THAT(summary, HasSubstr("without a usable fix"));
  EXPECT_THAT(summary, HasSubstr("without IMU in 2 holes"));
  EXPECT_FALSE(section("faults", "Timeline")["details"][0]["rows"].empty());
  EXPECT_EQ(series("faults", "nis").count("rejected"), 1U);

  // The bar of the IMU ends where its holes begin.
  const Table timeline(folder_ / "faults/report/timeline.csv");
  EXPECT_NE(std::find(timeline.names().begin(), timeline.names().end(), "imu_lower"),
            timeline.names().end());
}

}  // namespace
}  // namespace foucault::test
