#pragma once

#include <memory>
#include <string>

#include "foucault/alignment/alignment.h"
#include "foucault/core/config.h"
#include "foucault/ekf/ekf.h"
#include "foucault/evaluation/outage.h"
#include "foucault/fgo/batch.h"
#include "foucault/fgo/fgo_options.h"
#include "foucault/imu/imu_noise.h"
#include "foucault/navigation/navigation_run.h"
#include "foucault/rawlog/rawlog_source.h"
#include "foucault/state/calibrate_options.h"

namespace foucault::app {

/// Section `output` of the configuration.
class OutputOptions : public Configurable {
 public:
  std::string rate = "epochs";   ///< epochs | imu
  double statistics_from_s = 0;  ///< after the first fix; metrics leave out what comes before

  void fields(ConfigFields& f) override;
  navigation::EpochRate epoch_rate() const;
};

/// Section `vehicle` of the configuration.
class VehicleOptions : public Configurable {
 public:
  std::string kind = "auto";  ///< auto: the recording shows it | car: on wheels | any

  void fields(ConfigFields& f) override;
};

/// The configuration of the methods; every key has a default that suits a car.
class Settings : public Configurable {
 public:
  imu::ImuOptions imu;
  alignment::AlignmentOptions alignment;
  diagnosis::GnssOptions gnss;
  navigation::GapOptions gaps;
  VehicleOptions vehicle;
  measurement::AidOptions aids;
  state::CalibrateOptions calibrate;
  fgo::FgoOptions fgo;
  fgo::BatchOptions batch;
  /// For a log of any length, if its smoothed epochs may be gone through twice; no key.
  std::shared_ptr<fgo::BatchPasses> passes;
  ekf::EkfOptions ekf;
  rawlog::RawlogOptions rawlog;
  evaluation::OutageOptions outages;  ///< for evaluate and tune
  OutputOptions output;

  /// What the recording carries is used (`auto`).
  Settings();
  /// As in the paper: position fixes alone, 15 states.
  static Settings of_paper();

  void fields(ConfigFields& f) override;
};

/// With what the notes of a log say, where the settings leave it to the log.
/// Throws DataError as rawlog::read_notes.
Settings settings_for(const std::string& log, const Settings& settings);

/// Every key of Settings, for --help-config.
std::string settings_help();

}  // namespace foucault::app
