#pragma once

#include <optional>
#include <string>

#include "foucault/reports/figure.h"
#include "run_data.h"

/// The figures of a run; none where there are no data for it. `subtitle` names the run.
namespace foucault::reports {

std::string quality_name(FixQuality quality);
Ink quality_ink(FixQuality quality);

std::optional<Figure> ground_track(const RunData& data, const std::string& subtitle);

std::optional<Figure> position_figure(const RunData& data, const std::string& subtitle);
std::optional<Figure> velocity_figure(const RunData& data, const std::string& subtitle);
std::optional<Figure> attitude_figure(const RunData& data, const std::string& subtitle);
std::optional<Figure> uncertainty_figure(const RunData& data, const std::string& subtitle);

std::optional<Figure> position_error_figure(const RunData& data, const std::string& subtitle);
std::optional<Figure> velocity_error_figure(const RunData& data, const std::string& subtitle);
std::optional<Figure> attitude_error_figure(const RunData& data, const std::string& subtitle);

std::optional<Figure> gyro_bias_figure(const RunData& data, const std::string& subtitle);
std::optional<Figure> accel_bias_figure(const RunData& data, const std::string& subtitle);

std::optional<Figure> innovation_figure(const RunData& data, const std::string& subtitle);
std::optional<Figure> postfit_figure(const RunData& data, const std::string& subtitle);
std::optional<Figure> data_health_figure(const RunData& data, const std::string& subtitle);

}  // namespace foucault::reports
