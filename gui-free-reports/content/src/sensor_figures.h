#pragma once

#include <optional>
#include <string>

#include "foucault/plot/figure.h"
#include "run_data.h"

/// What the sensors told, as it was recorded; none where there are no data for it.
namespace foucault::content {

/// Rates and forces over time, drawn from the least and the largest of neighbouring samples.
std::optional<plot::Figure> raw_imu_figure(const RunData& data, const std::string& subtitle);
/// Their spectral densities.
std::optional<plot::Figure> imu_spectrum_figure(const RunData& data, const std::string& subtitle);
/// How often intervals between samples of the IMU occur.
std::optional<plot::Figure> imu_intervals_figure(const RunData& data, const std::string& subtitle);
/// Sigmas that the receiver gives, satellites, HDOP, age of corrections: what there is of them.
std::optional<plot::Figure> receiver_figure(const RunData& data, const std::string& subtitle);
/// Speed, and height above the ellipsoid.
std::optional<plot::Figure> speed_figure(const RunData& data, const std::string& subtitle);

}  // namespace foucault::content
