#include "settings.h"

#include <gtest/gtest.h>

#include "foucault/core/error.h"
#include "jobs/simulation_job.h"
#include "methods.h"

namespace foucault::app {
namespace {

TEST(Settings, EveryKeyHasADefaultThatReadsBack) {
  Settings settings;
  const std::string written = dump_config(settings);
  Settings again;
  load_config_text(written, "defaults", again);
  EXPECT_EQ(dump_config(again), written);
}

TEST(Settings, HelpKnowsEverySection) {
  Settings settings;
  const std::string help = describe_config(settings);
  for (const char* key : {"imu.preset", "alignment.mode", "fgo.window_s", "output.rate"}) {
    EXPECT_NE(help.find(key), std::string::npos) << key;
  }
}

TEST(Settings, KeysThatWereReplacedNameTheNewOnes) {
  const std::pair<const char*, const char*> replaced[] = {
      {"ekf.scale_factors=true", "calibrate.gyro_scale"},
      {"ekf.use_velocity=true", "aids.gnss_velocity"},
      {"rawlog.gnss_velocity=false", "aids.gnss_velocity"}};
  for (const auto& [old, now] : replaced) {
    Settings settings;
    try {
      set_config(old, settings);
      ADD_FAILURE() << old;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find(now), std::string::npos) << error.what();
    }
  }
}

TEST(Settings, SimulationReadsBackToo) {
  SimulationSettings settings;
  settings.scenario.seed = 99;
  SimulationSettings again;
  load_config_text(dump_config(settings), "defaults", again);
  EXPECT_EQ(again.scenario.seed, 99);
}

TEST(Methods, AllOfThemCanBeMade) {
  const methods::MethodOptions options = method_options(Settings(), {});
  state::Sink sink;
  for (const methods::Method& method : methods::all()) {
    EXPECT_NE(method.make(options, sink), nullptr) << method.name;
  }
}

TEST(Methods, AnUnknownOneIsToldTheKnownOnes) {
  try {
    methods::find("kalman");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("refined"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace foucault::app
