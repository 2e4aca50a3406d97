#include "foucault/laboratory/preintegration_output.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foucault/export/json_object.h"
#include "foucault/export/text_file.h"

namespace foucault::laboratory {
namespace {

using exports::Json;
using exports::Object;

std::string metres(double value) { return fmt::format("{:.3g}", value); }

std::string csv_text(const StudyResult& result) {
  std::string text =
      "motion,group,name,imu_rate_hz,duration_s,origin_distance_km,intervals,"
      "position_rms_m,velocity_rms_m_s,attitude_rms_rad\n";
  for (const MotionStudy& motion : result.motions) {
    for (const LabRow& row : motion.rows) {
      text += fmt::format("{},{},{},{:g},{:g},{:.6g},{},{:.6e},{:.6e},{:.6e}\n", motion.name,
                          group_name(row.group), row.name, row.rate_hz, row.duration_s,
                          row.origin_distance_m / 1000, motion.intervals, row.rms.position,
                          row.rms.velocity, row.rms.attitude);
    }
  }
  return text;
}

Json error_json(const MotionError& error) {
  return Object()
      .with("position_rms_m", error.position)
      .with("velocity_rms_m_s", error.velocity)
      .with("attitude_rms_rad", error.attitude);
}

/// At the plan's rate, by duration.
Json by_duration_json(const MotionStudy& motion, LabGroup group, const std::string& name,
                      const StudyPlan& plan) {
  Json json = Json::object();
  for (const double T : plan.durations_s) {
    json[fmt::format("{:g}", T)] = error_json(find_row(motion, group, name, plan.rate_hz, T).rms);
  }
  return json;
}

Json motion_json(const MotionStudy& motion, const StudyPlan& plan) {
  Json json;
  json["title"] = motion.title;
  json["intervals"] = motion.intervals;
  json["distance_from_trip_start_m"] = {motion.nearest_m, motion.farthest_m};
  json["speed_m_s"] = {motion.slowest_m_s, motion.fastest_m_s};
  for (const LabName& model : lab_models()) {
    json["models"][model.key] = by_duration_json(motion, LabGroup::model, model.key, plan);
  }
  for (const LabName& term : lab_ablations()) {
    json["without"][term.key] = by_duration_json(motion, LabGroup::ablation, term.key, plan);
  }
  for (const std::string& grade : plan.grades) {
    json["noise"][grade] = by_duration_json(motion, LabGroup::noise, grade, plan);
  }
  return json;
}

std::string metrics_text(const StudyResult& result) {
  Json json;
  json["imu_rate_hz"] = result.plan.rate_hz;
  json["truth_floor_m"] = 1e-9;
  for (const MotionStudy& motion : result.motions) {
    json["motions"][motion.name] = motion_json(motion, result.plan);
  }
  json["command"] = result.command_line;
  json["version"] = result.version;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ratio_text(double ratio) {
  if (ratio < 0.01) return "<0.01";
  return fmt::format(ratio < 10 ? "{:.2g}" : "{:.0f}", ratio);
}

std::vector<std::string> term_row(const std::string& title, LabGroup group, const std::string& key,
                                  const MotionStudy& motion, const StudyPlan& plan) {
  std::vector<std::string> row{title};
  for (const std::string& grade : plan.grades) {
    std::vector<std::string> ratios;
    for (const double T : shown_durations_s()) {
      const auto position = [&](LabGroup g, const std::string& name) {
        return find_row(motion, g, name, plan.rate_hz, T).rms.position;
      };
      ratios.push_back(ratio_text(position(group, key) / position(LabGroup::noise, grade)));
    }
    row.push_back(fmt::format("{}", fmt::join(ratios, " / ")));
  }
  return row;
}

}  // namespace

std::vector<double> shown_durations_s() { return {1, 60}; }

evaluation::TextTable model_table(const StudyResult& result) {
  evaluation::TextTable table;
  table.title = fmt::format("Position error [m], {:g} Hz", result.plan.rate_hz);
  table.header = {"motion", "duration [s]"};
  for (const LabName& model : lab_models()) table.header.push_back(model.title);
  for (const MotionStudy& motion : result.motions) {
    for (const double T : shown_durations_s()) {
      std::vector<std::string> row{motion.title, fmt::format("{:g}", T)};
      for (const LabName& model : lab_models()) {
        const double rate = result.plan.rate_hz;
        row.push_back(metres(find_row(motion, LabGroup::model, model.key, rate, T).rms.position));
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

evaluation::TextTable discretization_table(const StudyResult& result) {
  const StudyPlan& plan = result.plan;
  evaluation::TextTable table;
  table.title = fmt::format("full and the discretization of its increments over {:g} s",
                            plan.fine_duration_s);
  table.header = {"motion",     "IMU rate [Hz]", "full [m]",   "discr. [m]",
                  "full [m/s]", "discr. [m/s]",  "full [rad]", "discr. [rad]"};
  for (const MotionStudy& motion : result.motions) {
    for (const auto* rates : {&plan.rates_hz, &plan.fine_rates_hz}) {
      for (const double rate : *rates) {
        const auto rms = [&](const char* name) {
          return find_row(motion, LabGroup::model, name, rate, plan.fine_duration_s).rms;
        };
        const MotionError full = rms("full"), least = rms("discretization");
        table.rows.push_back({motion.title, fmt::format("{:g}", rate), metres(full.position),
                              metres(least.position), metres(full.velocity), metres(least.velocity),
                              metres(full.attitude), metres(least.attitude)});
      }
    }
  }
  return table;
}

evaluation::TextTable term_table(const StudyResult& result, const MotionStudy& motion) {
  const StudyPlan& plan = result.plan;
  evaluation::TextTable table;
  table.title = fmt::format("{}: error after {:g} s in sigmas of the IMU's noise", motion.title,
                            fmt::join(shown_durations_s(), " / "));
  table.header = {"left out"};
  table.header.insert(table.header.end(), plan.grades.begin(), plan.grades.end());
  const auto add = [&](const std::string& title, LabGroup group, const std::string& key) {
    table.rows.push_back(term_row(title, group, key, motion, plan));
  };
  for (const LabName& term : lab_ablations()) add(term.title, LabGroup::ablation, term.key);
  for (const LabName& model : lab_models()) {
    if (model.key != "discretization") add("(" + model.title + ")", LabGroup::model, model.key);
  }
  return table;
}

void write_laboratory(const StudyResult& result, const std::filesystem::path& folder) {
  exports::write_text_file(folder / "preintegration.csv", csv_text(result));
  exports::write_text_file(folder / "metrics.json", metrics_text(result));
}

std::vector<std::string> laboratory_lines(const StudyResult& result) {
  return evaluation::text_lines(evaluation::to_plain_text(model_table(result)));
}

}  // namespace foucault::laboratory
