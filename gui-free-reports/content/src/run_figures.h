#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foucault/plot/figure.h"
#include "run_data.h"

/// The figures of a run; none where there are no data for it. `subtitle` names the run.
namespace foucault::content {

/// Steps between samples; those over samples that were left out are steps, too.
struct StepFacts {
  size_t gaps = 0;
  double gap_duration = 0;  ///< [s]
  double longest = 0;       ///< [s]
};
StepFacts imu_step_facts(const RunData& data);

std::optional<plot::Figure> ground_track(const RunData& data, const std::string& subtitle);
/// Position, velocity, attitude, and how sure the estimator is of them.
std::vector<plot::Figure> solution_figures(const RunData& data, const std::string& subtitle);
/// Velocity along the axes of the vehicle.
std::vector<plot::Figure> vehicle_figures(const RunData& data, const std::string& subtitle);
/// Position, velocity and attitude less those of the reference.
std::vector<plot::Figure> error_figures(const RunData& data, const std::string& subtitle);
/// The same of a smoother less those of its forward run.
std::vector<plot::Figure> separation_figures(const RunData& data, const std::string& subtitle);
std::vector<plot::Figure> bias_figures(const RunData& data, const std::string& subtitle);
std::optional<plot::Figure> innovation_figure(const RunData& data, const std::string& subtitle);
std::optional<plot::Figure> postfit_figure(const RunData& data, const std::string& subtitle);
std::optional<plot::Figure> data_health_figure(const RunData& data, const std::string& subtitle);

}  // namespace foucault::content
