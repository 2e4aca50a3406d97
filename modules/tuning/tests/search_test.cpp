#include "foucault/tuning/search.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "foucault/core/error.h"
#include "foucault/tuning/tuning_output.h"
#include "support/drifting_estimator.h"
#include "support/test_folder.h"

namespace foucault::tuning {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Two parameters whose best is (2, 20): drifts grow with the distance from there. Outages of 30 s
/// at 100 s and 150 s of a recording at rest, and both 25 s later.
class SearchTest : public testing::Test {
 protected:
  SearchTest() {
    plan_.config.options.objective = "horizontal";
    plan_.config.methods = {"ekf"};
    plan_.config.grid.axes = {{"a", {"1", "2", "3"}, true}, {"b", {"10", "20"}, true}};
    plan_.logs = {folder_ / "log"};
    plan_.shifts = 2;
    plan_.runs = [this](const std::string&, const std::string& method, const GridPoint& point) {
      return std::vector<evaluation::ExperimentRun>{run(method, point, 25), run(method, point, 0)};
    };
    plan_.progress_of = [](const std::string&) { return std::function<void(double)>(); };
    folder_.write("log", "content");
  }

  evaluation::ExperimentRun run(const std::string& method, const GridPoint& point,
                                double shift_s) const {
    evaluation::OutageOptions outages;
    outages.first_s = 100;
    outages.length_s = 30;
    outages.period_s = 50;
    evaluation::ExperimentRun run;
    run.recording = "log";
    run.method = method;
    run.shift_s = shift_s;
    run.needs_outage = shift_s == 0;
    run.depends_on = fmt::format("{} {} {} {}", method, point[0], point[1], shift_s);
    run.schedule = evaluation::OutageSchedule(outages, shift_s);
    run.open = [this] { return std::make_unique<test::RestSource>(duration_s_, true); };
    const double scale = 1 + std::abs(static_cast<int>(point[0]) - 1) + 2.0 * (point[1] == 0);
    run.make_estimator = [this, scale](const state::Mounting&, state::Sink& sink) {
      if (fails_above_ < scale) throw evaluation::EstimatorFailure("scale\ntoo large");
      return std::make_unique<test::DriftingEstimator>(sink, scale);
    };
    return run;
  }
  MethodTuning found(const evaluation::Executor::Options& options = {2, std::nullopt, true}) {
    evaluation::Executor executor(records_, options);
    const MethodTuning tuning = search(plan_, "ekf", executor);
    computed_ = executor.computed();
    return tuning;
  }

  test::TestFolder folder_;
  SearchPlan plan_;
  double duration_s_ = 275;
  double fails_above_ = 1e9;
  store::MemoryRecords records_;
  std::size_t computed_ = 0;
};

TEST_F(SearchTest, FindsTheBestPoint) {
  const MethodTuning tuning = found();
  EXPECT_THAT(tuning.search.best, ElementsAre(1, 1));
  EXPECT_EQ(tuning.scores.size(), 6u);
  EXPECT_EQ(tuning.best().outages, 6);
  EXPECT_NEAR(tuning.best().horizontal_rms, 9, 0.5);
  EXPECT_EQ(tuning.search.value, tuning.best().horizontal_rms);
  plan_.config.options.search = "coarse_to_fine";
  EXPECT_EQ(found().search.best, tuning.search.best);
}

TEST_F(SearchTest, FinishedRunsAreNotComputedAgain) {
  const MethodTuning first = found();
  EXPECT_EQ(computed_, 6u * 2);
  const MethodTuning again = found();
  EXPECT_EQ(computed_, 0u);
  EXPECT_EQ(again.best().horizontal_rms, first.best().horizontal_rms);
  EXPECT_EQ(again.best().cpu_s, first.best().cpu_s) << "what it took when it was computed";
}

TEST_F(SearchTest, WhoHasAShareComesToTheSameEnd) {
  plan_.config.options.search = "coarse_to_fine";
  const MethodTuning tuning = found({1, store::Shard{1, 3}, true});
  EXPECT_GT(computed_, 0u) << "nobody else was there, so it did all of it";
  EXPECT_EQ(tuning.search.best, found().search.best);
  EXPECT_EQ(computed_, 0u);
  EXPECT_NO_THROW(found({1, std::nullopt, false}));
}

TEST_F(SearchTest, SaysHowManyRunsAreMissing) {
  try {
    found({1, std::nullopt, false});
    FAIL();
  } catch (const store::StoreError& error) {
    EXPECT_THAT(error.what(), HasSubstr("12 of 12 runs are missing"));
  }
}

TEST_F(SearchTest, APointThatFailsSaysWhy) {
  fails_above_ = 2;
  const MethodTuning tuning = found();
  EXPECT_EQ(tuning.scores.size(), 6u);
  EXPECT_EQ(tuning.scores.at({0, 0}).note, "scale too large");
  EXPECT_TRUE(std::isinf(tuning.scores.at({0, 0}).horizontal_rms));
  EXPECT_THAT(tuning.search.best, ElementsAre(1, 1));
}

TEST_F(SearchTest, NoPointAtAllIsAnError) {
  fails_above_ = 0;
  try {
    found();
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("ekf: no point of the grid gave a drift"));
  }
}

TEST_F(SearchTest, ALogWithoutOutagesIsAnError) {
  duration_s_ = 90;
  EXPECT_THROW(found(), DataError);
}

TEST_F(SearchTest, WritesAndSaysWhatItFound) {
  fails_above_ = 3;
  TuningResult result{plan_.config, {found()}, "base: {}\n", "1"};
  result.config.options.objective = "weighted";
  const auto config_at = [](const GridPoint& point) { return std::to_string(point[0]); };
  write_tuning(result, config_at, folder_.path());
  const auto json = nlohmann::json::parse(folder_.text("metrics.json"));
  EXPECT_EQ(json["methods"]["ekf"]["parameters"]["b"], "20");
  EXPECT_EQ(json["methods"]["ekf"]["grid_points"], 6);
  EXPECT_EQ(json["vertical_weight"], 1);
  EXPECT_EQ(folder_.text("best.yaml"), "1");
  EXPECT_EQ(folder_.lines("results.csv").size(), 7u);
  EXPECT_EQ(folder_.lines("points.csv").size(), 7u);
  EXPECT_THAT(folder_.text("results.csv"), HasSubstr("ekf,1,10,0,,,,0,scale too large"));
  EXPECT_EQ(folder_.lines("heatmaps/ekf_a_b.csv").size(), 7u);
  EXPECT_THAT(tuning_lines(result, "out").back(), HasSubstr("--config out/best.yaml --method ekf"));
  EXPECT_TRUE(edge_lines(result).empty());

  result.config.methods = {"ekf", "full"};
  result.tunings[0].search.best = {0, 1};
  write_tuning(result, config_at, folder_.path());
  EXPECT_EQ(folder_.text("best-ekf.yaml"), "0");
  EXPECT_THAT(edge_lines(result), ElementsAre(HasSubstr("a = 1 is at the edge")));
}

}  // namespace
}  // namespace foucault::tuning
