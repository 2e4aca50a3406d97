#include "foucault/export/run_metrics_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "foucault/core/units.h"
#include "foucault/export/text_file.h"
#include "foucault/state/blocks.h"

namespace foucault::exports {
namespace {

using Json = nlohmann::ordered_json;

TEST(RunMetricsJson, WhatDoesNotExistIsNull) {
  const Json json = run_metrics_json({}, {});
  EXPECT_TRUE(json["gnss"]["mean_nis"].is_null());
  EXPECT_TRUE(json["gnss"]["rejected_share"].is_null());
  EXPECT_TRUE(json["gnss"]["innovation_rms_m"]["north"].is_null());
  EXPECT_TRUE(json["consistency"]["nis"]["mean"].is_null());
  EXPECT_TRUE(json["consistency"]["whitened_innovation"]["north"].is_null());
  EXPECT_TRUE(json["consistency"]["autocorrelation"].is_null());
  EXPECT_FALSE(json.contains("reference"));
  EXPECT_TRUE(json["aids"].is_object());
}

TEST(RunMetricsJson, NumbersInTheUnitsOfTheirNames) {
  evaluation::RunMetrics metrics;
  metrics.gnss.used = 3;
  metrics.gnss.rejected = 1;
  metrics.gnss.samples = 3;
  metrics.gnss.rejected_samples = 1;
  metrics.gnss.innovation_rms_n = {1, 2, 3};
  metrics.aids["wheel_speed"] = {1, 2, 0, 3.0};
  metrics.aids["unused"] = {};
  evaluation::ReferenceMetrics reference;
  reference.roll_rmse = 0.1;
  reference.position_inside.samples = 1;
  reference.position_inside.fraction.setConstant(0.5);
  metrics.reference = reference;
  Consistency& c = metrics.consistency;
  c.nis.samples = 3;
  c.nis.mean = 3;
  c.stretches.stretches = 1;
  c.predictions.push_back({});
  c.innovations[0].samples = 3;
  c.autocorrelation.lag.push_back({0.1, 0.2, 0.3});
  c.position_nees = c.velocity_nees = c.attitude_nees = c.nis;
  const Json json = run_metrics_json(metrics, {{state::block::gyro_bias, {1, 2, 3}, {4, 5, 6}}});

  EXPECT_EQ(json["gnss"]["rejected_share"], 0.25);
  EXPECT_EQ(json["gnss"]["innovation_rms_m"]["down"], 3);
  EXPECT_EQ(json["aids"]["wheel_speed"]["mean_nis"], 1.5);
  EXPECT_TRUE(json["aids"]["unused"]["mean_nis"].is_null());
  EXPECT_EQ(json["reference"]["roll_rmse_deg"], 0.1 * units::kDegrees);
  EXPECT_TRUE(json["reference"]["heading_rmse_deg"].is_null());
  EXPECT_EQ(json["reference"]["position_inside"]["3_sigma"], 0.5);
  EXPECT_TRUE(json["reference"]["velocity_inside"].is_null());
  EXPECT_EQ(json["consistency"]["horizons"].size(), 1u);
  EXPECT_EQ(json["consistency"]["autocorrelation"]["lag_1"]["east"], 0.2);
  EXPECT_EQ(json["consistency"]["position_nees"]["mean"], 3);
  EXPECT_EQ(json["calibration"].size(), 1u);
}

TEST(TextFile, AFullDiskIsAnError) {
  EXPECT_THROW(write_text_file("/dev/full", std::string(100'000, 'x')), WriteError);
  EXPECT_THROW(write_text_file("/dev/full", "x"), WriteError);
  EXPECT_THROW(write_text_file("/no/such/folder/file", "x"), WriteError);
}

}  // namespace
}  // namespace foucault::exports
