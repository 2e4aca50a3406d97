#pragma once

#include <optional>
#include <string>

#include "foucault/plot/figure.h"
#include "run_data.h"

/// The figures of a run; none where there are no data for it. `subtitle` names the run.
namespace foucault::content {

std::string quality_name(FixQuality quality);
plot::Ink quality_ink(FixQuality quality);

std::optional<plot::Figure> ground_track(const RunData& data, const std::string& subtitle);

std::optional<plot::Figure> position_figure(const RunData& data, const std::string& subtitle);
std::optional<plot::Figure> velocity_figure(const RunData& data, const std::string& subtitle);
std::optional<plot::Figure> attitude_figure(const RunData& data, const std::string& subtitle);
std::optional<plot::Figure> uncertainty_figure(const RunData& data, const std::string& subtitle);

std::optional<plot::Figure> position_error_figure(const RunData& data, const std::string& subtitle);
std::optional<plot::Figure> velocity_error_figure(const RunData& data, const std::string& subtitle);
std::optional<plot::Figure> attitude_error_figure(const RunData& data, const std::string& subtitle);

std::optional<plot::Figure> gyro_bias_figure(const RunData& data, const std::string& subtitle);
std::optional<plot::Figure> accel_bias_figure(const RunData& data, const std::string& subtitle);

std::optional<plot::Figure> innovation_figure(const RunData& data, const std::string& subtitle);
std::optional<plot::Figure> postfit_figure(const RunData& data, const std::string& subtitle);
std::optional<plot::Figure> data_health_figure(const RunData& data, const std::string& subtitle);

}  // namespace foucault::content
