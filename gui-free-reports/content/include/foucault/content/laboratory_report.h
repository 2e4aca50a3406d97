#pragma once

#include <string>
#include <vector>

#include "foucault/page/report_page.h"

/// Figures and page of the preintegration laboratory, from plain results.
namespace foucault::content {

enum class LabQuantity { position, velocity, attitude };

/// Errors of one model (or of one model without one of its terms, or of an IMU's noise) over x: a
/// duration [s], a rate [Hz] or a distance [km].
struct LabCurve {
  std::string key;     ///< "rough", "refined", "full" and "discretization" have their own look
  std::string title;   ///< for readers
  bool local = false;  ///< the origin of w is where the interval begins: drawn dashed
  std::vector<double> x;
  std::vector<double> position_m;
  std::vector<double> velocity_m_s;
  std::vector<double> attitude_rad;
};

/// What was measured of one motion.
struct LabMotionCurves {
  std::string title;
  std::string note;                   ///< speeds and distances
  std::vector<LabCurve> models;       ///< over the duration
  std::vector<LabCurve> ablations;    ///< over the duration; the first one: nothing left out
  std::vector<LabCurve> small_noise;  ///< 1 sigma over the duration, IMUs with a line each
  std::vector<LabCurve> band_noise;   ///< of IMUs that are drawn as one band
  std::vector<LabCurve> rates;        ///< over the rate, for one duration
  std::vector<LabCurve> distances;    ///< of `refined` over the distance, a curve a duration
};

struct LabSettings {
  double rate_hz = 0;                   ///< of everything but `rates`
  double rates_duration_s = 0;          ///< of `rates`
  std::vector<double> dot_durations_s;  ///< shown by ablation_dots and distance_lines
  std::string band_title;               ///< of the IMUs in band_noise
};

/// Error against duration, a panel a motion, both axes logarithmic, noise of IMUs behind.
plot::Figure model_errors(const std::vector<LabMotionCurves>& motions, const LabSettings& settings,
                          LabQuantity quantity);
/// Error without each of the terms: a row a term, a mark a motion, a panel a duration.
plot::Figure ablation_dots(const std::vector<LabMotionCurves>& motions, const LabSettings& settings,
                           LabQuantity quantity);
/// Error against the IMU's rate.
plot::Figure rate_lines(const std::vector<LabMotionCurves>& motions, const LabSettings& settings);
/// Error of `refined` against the distance from the origin of w, a panel a duration.
plot::Figure distance_lines(const std::vector<LabMotionCurves>& motions,
                            const LabSettings& settings);

struct LaboratoryReport {
  std::string subtitle;
  std::vector<std::string> remarks;
  std::vector<page::KeyNumber> key_numbers;
  std::vector<page::Table> tables;
  std::vector<page::Table> term_tables;
  LabSettings settings;
  std::vector<LabMotionCurves> motions;
  std::vector<page::Listing> listings;
  std::string footer;
};

page::ReportPage laboratory_page(const LaboratoryReport& report);

}  // namespace foucault::content
