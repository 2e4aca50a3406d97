#include "foucault/tuning/tune_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "foucault/core/error.h"
#include "support/test_folder.h"

namespace foucault::tuning {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A configuration with what the grid has.
class Base : public Configurable {
 public:
  struct Imu : Configurable {
    std::string preset;
    std::optional<double> arw, bias;
    void fields(ConfigFields& f) override {
      f.text("preset", preset, {}, "");
      f.optional_number("arw_deg_sqrt_h", arw, kNotNegative, "");
      f.optional_number("gyro_bias_deg_h", bias, kNotNegative, "");
    }
  } imu;
  struct Outages : Configurable {
    double first_s = 500, length_s = 60, period_s = 150;
    std::vector<double> shifts_s{0, 75};
    void fields(ConfigFields& f) override {
      f.number("first_s", first_s, {}, "");
      f.number("length_s", length_s, {}, "");
      f.number("period_s", period_s, {}, "");
      f.numbers("shifts_s", shifts_s, {}, "");
    }
  } outages;
  void fields(ConfigFields& f) override {
    f.section("imu", imu, "");
    f.section("outages", outages, "");
  }
};

Tunable tunable(Base& base) {
  return {base,
          [&base](const std::string& assignment) {
            Base copy = base;
            set_config(assignment, copy);
          },
          [](const std::string& method) {
            if (method != "ekf") throw UsageError("unknown method");
          },
          "ekf"};
}

constexpr const char* kGrid = R"(# A comment with an umlaut: Gitter für rough
base:
  imu: {preset: ADIS16465}
  outages:
    first_s: 100
    length_s: 20
    period_s: 40
    shifts_s: [0]
grid:
  imu.arw_deg_sqrt_h: [0.6, 0.15]
  imu.gyro_bias_deg_h: {from: 2, to: 200, steps: 3, scale: log}
method: ekf
)";

std::string with(std::string from, const std::string& to) {
  std::string yaml = kGrid;
  return yaml.replace(yaml.find(from), from.size(), to);
}

std::string refusal(const std::string& yaml, const std::vector<std::string>& set = {}) {
  Base base;
  try {
    load_tune_config_text(yaml, "grid.yaml", set, tunable(base));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(TuneConfig, ReadsBaseGridAndOptions) {
  Base base;
  const TuneConfig config =
      load_tune_config_text(kGrid, "grid.yaml", {"outages.length_s=15"}, tunable(base));
  EXPECT_EQ(base.outages.first_s, 100);
  EXPECT_EQ(base.outages.length_s, 15);
  ASSERT_EQ(config.grid.axes.size(), 2u);
  EXPECT_EQ(config.grid.axes[0].key, "imu.arw_deg_sqrt_h");
  EXPECT_THAT(config.grid.axes[0].values, ElementsAre("0.15", "0.6"));
  EXPECT_THAT(config.grid.axes[1].values, ElementsAre("2", "20", "200"));
  EXPECT_THAT(config.methods, ElementsAre("ekf"));
  EXPECT_THAT(config.values({1, 2}), ElementsAre("0.6", "200"));
  EXPECT_THAT(config.assignments({1, 2}),
              ElementsAre("imu.arw_deg_sqrt_h=0.6", "imu.gyro_bias_deg_h=200"));
}

TEST(TuneConfig, ErrorsNameTheLine) {
  EXPECT_THAT(refusal(with("first_s: 100", "first: 100")),
              HasSubstr("grid.yaml:5: outages.first: is not a key; did you mean outages.first_s"));
  EXPECT_THAT(refusal(with("imu.arw_deg_sqrt_h:", "imu.arw:")), HasSubstr("grid.yaml:10: grid: "));
  EXPECT_THAT(refusal(with("[0.6, 0.15]", "[0.6, -1]")),
              HasSubstr("grid.yaml:10: grid: imu.arw_deg_sqrt_h: must be at least 0"));
  EXPECT_THAT(refusal(with("[0.6, 0.15]", "[0.6, 0.6]")), HasSubstr("grid.yaml:10: "));
  EXPECT_THAT(refusal(with("steps: 3", "step: 3")), HasSubstr("grid.yaml:11: grid: 'step'"));
  EXPECT_THAT(refusal(with("from: 2", "from: -2")), HasSubstr("scale log needs"));
  EXPECT_THAT(refusal(with("steps: 3", "steps: 1")), HasSubstr("steps is a whole number"));
  EXPECT_THAT(refusal(with("method: ekf", "objectiv: vertical")),
              HasSubstr("grid.yaml:12: objectiv: is not a key; did you mean objective"));
  EXPECT_THAT(refusal(with("method: ekf", "method: kalman")), HasSubstr("unknown method"));
  EXPECT_THAT(refusal(with("method: ekf", "")), HasSubstr("names no method"));
  EXPECT_THAT(refusal("base: {}\nmethod: ekf\n"), HasSubstr("has no grid"));
  EXPECT_THAT(refusal("{base: {}}"), HasSubstr("expects lines"));
  EXPECT_THAT(refusal("grid: [\n"), HasSubstr("is not YAML"));
  EXPECT_THAT(refusal(std::string(kGrid) + "base: {}\n"),
              HasSubstr("grid.yaml:13: base: is given twice, first in line "));
  EXPECT_THAT(refusal(with("imu.arw_deg_sqrt_h:", "outages.length_s:")),
              HasSubstr("outages are the same for all points"));
  EXPECT_THAT(refusal(with("method: ekf", "methods: [ekf, ekf]")), HasSubstr("given twice"));
  EXPECT_THAT(refusal(with("[0.6, 0.15]", "0.6")), HasSubstr("expects a list of values"));
  EXPECT_THAT(refusal(with("[0.6, 0.15]", "[{a: 1}]")), HasSubstr("expects values"));
  EXPECT_THAT(refusal(with("scale: log", "scale: cubic")), HasSubstr("linear or log"));
  EXPECT_THAT(refusal(with("steps: 3, ", "")), HasSubstr("give all of from, to, steps"));
  EXPECT_THAT(refusal(with("from: 2", "from: two")), HasSubstr("are numbers"));
  const std::string many = with("[0.6, 0.15]", "{from: 0, to: 1, steps: 9999}");
  EXPECT_EQ(refusal(many), "");
  EXPECT_THAT(refusal(std::string(many).replace(many.find("steps: 3"), 8, "steps: 999")),
              HasSubstr("more than 1000000 points"));
  EXPECT_EQ(refusal(kGrid), "");
}

TEST(TuneOptions, Objectives) {
  TuneOptions options;
  EXPECT_EQ(options.objective_of(3, 2), 3);
  EXPECT_EQ(options.objective_name(), "RMS horizontal drift");
  options.objective = "vertical";
  EXPECT_EQ(options.objective_of(3, 2), 2);
  options.objective = "weighted";
  options.vertical_weight = 0.5;
  EXPECT_EQ(options.objective_of(3, 2), 4);
  EXPECT_EQ(options.objective_name(), "RMS drift, horizontal + 0.5 vertical");
}

TEST(TuneConfig, FilesThatCannotBeRead) {
  const test::TestFolder folder;
  Base base;
  EXPECT_THROW(load_tune_config(folder / "none.yaml", {}, tunable(base)), DataError);
  EXPECT_THROW(load_tune_config(folder.path().string(), {}, tunable(base)), DataError);
  folder.write("grid.yaml", std::string("\xef\xbb\xbf") + kGrid);
  EXPECT_EQ(load_tune_config(folder / "grid.yaml", {}, tunable(base)).grid.size(), 6u);
}

}  // namespace
}  // namespace foucault::tuning
