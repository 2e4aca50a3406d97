#include "foucault/state/calibrate_options.h"

#include <gtest/gtest.h>

#include "foucault/core/error.h"

namespace foucault::state {
namespace {

TEST(CalibrateOptions, NothingIsOnByItself) { EXPECT_EQ(CalibrateOptions().layout().size(), 15); }

TEST(CalibrateOptions, BlocksAreThoseThatAreOn) {
  CalibrateOptions options;
  set_config("accel_scale=on", options);
  const Layout accel = options.layout();
  EXPECT_EQ(accel.size(), 18);
  EXPECT_TRUE(accel.find(block::accel_scale));
  EXPECT_FALSE(accel.find(block::gyro_scale));
  set_config("gyro_scale=on", options);
  EXPECT_EQ(options.layout().size(), 21);
  set_config("accel_scale=off", options);
  const Layout gyro = options.layout();
  EXPECT_EQ(gyro.size(), 18);
  EXPECT_TRUE(gyro.find(block::gyro_scale));
}

TEST(CalibrateOptions, ModeNoneTurnsAllOff) {
  CalibrateOptions options;
  set_config("accel_scale=on", options);
  set_config("gyro_scale=on", options);
  set_config("mode=none", options);
  EXPECT_EQ(options.layout().size(), 15);
}

TEST(CalibrateOptions, SigmasArePartsPerMillion) {
  CalibrateOptions options;
  for (const char* setting : {"accel_scale=on", "gyro_scale=on", "accel_scale_sigma_ppm=300",
                              "gyro_scale_sigma_ppm=70", "scale_tau_s=1800"})
    set_config(setting, options);
  const Layout layout = options.layout();
  EXPECT_DOUBLE_EQ(layout.find(block::accel_scale)->sigma, 3e-4);
  EXPECT_DOUBLE_EQ(layout.find(block::gyro_scale)->sigma, 7e-5);
  EXPECT_EQ(layout.find(block::accel_scale)->tau, 1800);
  EXPECT_EQ(layout.find(block::gyro_scale)->tau, 1800);
}

TEST(CalibrateOptions, AreWrittenAndReadAgain) {
  CalibrateOptions options;
  options.mode = "none";
  options.gyro_scale = "on";
  options.accel_scale = "on";
  options.gyro_scale_sigma_ppm = 11;
  options.accel_scale_sigma_ppm = 12;
  options.scale_tau_s = 13;
  CalibrateOptions again;
  load_config_text(dump_config(options), "dumped", again);
  EXPECT_EQ(again.mode, "none");
  EXPECT_EQ(again.gyro_scale, "on");
  EXPECT_EQ(again.accel_scale, "on");
  EXPECT_EQ(again.gyro_scale_sigma_ppm, 11);
  EXPECT_EQ(again.accel_scale_sigma_ppm, 12);
  EXPECT_EQ(again.scale_tau_s, 13);
}

TEST(CalibrateOptions, RefuseWhatTheyDoNotKnow) {
  for (const char* setting :
       {"mode=all", "gyro_scale=yes", "gyro_scale_sigma_ppm=0", "accel_scale_sigma_ppm=-1",
        "scale_tau_s=0", "wheel=on", "noise=maybe"}) {
    CalibrateOptions options;
    EXPECT_THROW(set_config(setting, options), UsageError) << setting;
  }
}

}  // namespace
}  // namespace foucault::state
