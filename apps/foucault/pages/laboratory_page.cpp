#include "pages/laboratory_page.h"

#include <fmt/format.h>

#include "pages/evaluation_page.h"

namespace foucault::app {
namespace {

using content::LabCurve;
using content::LabMotionCurves;
using namespace laboratory;

/// IMUs that are so much better than the others that they have a line of their own.
bool is_high_grade(const std::string& grade) {
  return grade == "tactical" || grade == "navigation";
}

bool is_local(const std::string& key) { return key.find("_local") != std::string::npos; }

std::string without_suffix(const std::string& key) { return key.substr(0, key.find("_local")); }

LabCurve curve(const std::string& key, const std::string& title) {
  LabCurve result;
  result.key = without_suffix(key);
  result.title = title;
  result.local = is_local(key);
  return result;
}

void add_point(double x, const laboratory::MotionError& error, LabCurve& curve) {
  curve.x.push_back(x);
  curve.position_m.push_back(error.position);
  curve.velocity_m_s.push_back(error.velocity);
  curve.attitude_rad.push_back(error.attitude);
}

LabCurve over_durations(const laboratory::MotionStudy& motion, const laboratory::StudyPlan& plan,
                        laboratory::LabGroup group, const std::string& key,
                        const std::string& title) {
  LabCurve result = curve(key, title);
  for (const double T : plan.durations_s) {
    add_point(T, laboratory::find_row(motion, group, key, plan.rate_hz, T).rms, result);
  }
  return result;
}

LabCurve over_rates(const laboratory::MotionStudy& motion, const laboratory::StudyPlan& plan,
                    laboratory::LabGroup group, const std::string& key, const std::string& title) {
  LabCurve result = curve(key, title);
  for (const auto* rates : {&plan.rates_hz, &plan.fine_rates_hz}) {
    for (const double rate : *rates) {
      add_point(rate, laboratory::find_row(motion, group, key, rate, plan.fine_duration_s).rms,
                result);
    }
  }
  return result;
}

/// Without the origin at the vehicle itself, which a logarithmic axis does not hold.
LabCurve over_distances(const laboratory::MotionStudy& motion, double duration_s) {
  LabCurve result = curve("refined", fmt::format("{:g} s", duration_s));
  for (const laboratory::LabRow& row : motion.rows) {
    if (row.group != laboratory::LabGroup::distance || row.duration_s != duration_s) continue;
    if (row.origin_distance_m > 0) add_point(row.origin_distance_m / 1000, row.rms, result);
  }
  return result;
}

/// "29–32", or one number if they are the same.
std::string range_text(const std::string& low, const std::string& high) {
  return low == high ? low : low + "–" + high;
}

std::string place_text(const laboratory::MotionStudy& motion) {
  const auto whole = [](double value) { return fmt::format("{:.0f}", value); };
  const auto kilometres = [&](double metres) {
    return metres < 1e4 ? fmt::format("{:.2g}", metres / 1000) : whole(metres / 1000);
  };
  return fmt::format("{} m/s · {} km",
                     range_text(whole(motion.slowest_m_s), whole(motion.fastest_m_s)),
                     range_text(kilometres(motion.nearest_m), kilometres(motion.farthest_m)));
}

LabMotionCurves motion_curves(const laboratory::MotionStudy& motion,
                              const laboratory::StudyPlan& plan) {
  LabMotionCurves curves;
  curves.title = motion.title;
  curves.note = place_text(motion);
  for (const laboratory::LabName& model : laboratory::lab_models()) {
    curves.models.push_back(
        over_durations(motion, plan, laboratory::LabGroup::model, model.key, model.title));
  }
  for (const laboratory::LabName& term : laboratory::lab_ablations()) {
    curves.ablations.push_back(
        over_durations(motion, plan, laboratory::LabGroup::ablation, term.key, term.title));
  }
  for (const std::string& grade : plan.grades) {
    (is_high_grade(grade) ? curves.small_noise : curves.band_noise)
        .push_back(over_durations(motion, plan, laboratory::LabGroup::noise, grade, grade));
  }
  curves.rates.push_back(
      over_rates(motion, plan, laboratory::LabGroup::model, "full", motion.title));
  if (motion.name == "vibration") {
    curves.rates.push_back(over_rates(motion, plan, laboratory::LabGroup::ablation, "coning",
                                      motion.title + ", no coning term"));
    curves.rates.push_back(over_rates(motion, plan, laboratory::LabGroup::ablation, "sculling",
                                      motion.title + ", no sculling term"));
  }
  for (const double T : laboratory::shown_durations_s())
    curves.distances.push_back(over_distances(motion, T));
  return curves;
}

std::string with_prefix(double metres) {
  if (metres >= 1) return fmt::format("{:.3g} m", metres);
  if (metres >= 1e-3) return fmt::format("{:.3g} mm", metres * 1e3);
  return fmt::format("{:.3g} µm", metres * 1e6);
}

std::vector<page::KeyNumber> key_numbers(const laboratory::StudyResult& result) {
  constexpr double kSecond = 1;
  std::vector<page::KeyNumber> numbers;
  for (const laboratory::MotionStudy& motion : result.motions) {
    const auto position = [&](const char* model) {
      const double rate = result.plan.rate_hz;
      return laboratory::find_row(motion, laboratory::LabGroup::model, model, rate, kSecond)
          .rms.position;
    };
    numbers.push_back(
        {motion.title + ", full after 1 s", fmt::format("{:.2g}", position("full") * 1e6), "µm",
         fmt::format("increments {:.2g} µm, refined {}, rough {}", position("discretization") * 1e6,
                     with_prefix(position("refined")), with_prefix(position("rough")))});
  }
  return numbers;
}

std::vector<std::string> remarks(const laboratory::StudyResult& result) {
  return {
      fmt::format(
          "Exact motion is integrated from exact increments: no noise, no bias, the true state at "
          "the beginning. What is left at the end is the model's own error, a root mean square "
          "over "
          "{} intervals along a simulated trip. The truth is good to 1 nm.",
          result.motions.front().intervals),
      "discretization is the least that increments of a rate allow: an integration that leaves "
      "nothing out and takes gravity at every sample's own place. full adds what it neglects of "
      "gravity's change along an interval: nothing that shows over 1 s, centimetres over 60 s in "
      "an "
      "airliner.",
      "refined and rough take gravity as that of the origin of w. With the origin where the trip "
      "began its direction is off by 0.157 mrad a km, and this outweighs everything else; an "
      "estimator absorbs it as a tilt. The lines 'origin here' show what remains then."};
}

}  // namespace

content::LaboratoryReport laboratory_report(const laboratory::StudyResult& result) {
  content::LaboratoryReport report;
  report.subtitle = fmt::format("exact motion, {:g} to {:g} s, {:g} to {:g} Hz",
                                result.plan.durations_s.front(), result.plan.durations_s.back(),
                                result.plan.rates_hz.front(), result.plan.rates_hz.back());
  report.remarks = remarks(result);
  report.key_numbers = key_numbers(result);
  report.tables = {
      report_table(laboratory::model_table(result), "Root mean square over the intervals."),
      report_table(laboratory::discretization_table(result),
                   "Position, velocity and attitude. Velocities below 3e-8 m/s and positions below "
                   "7e-9 m are the turning of gravity's gradient with the Earth, which full leaves "
                   "out.")};
  for (const laboratory::MotionStudy& motion : result.motions) {
    report.term_tables.push_back(report_table(
        laboratory::term_table(result, motion),
        "Position error against 1 sigma by white noise and wandering biases: above 1 what "
        "is left out costs more than the sensor's noise. In brackets: the models."));
    report.motions.push_back(motion_curves(motion, result.plan));
  }
  report.settings = {result.plan.rate_hz, result.plan.fine_duration_s,
                     laboratory::shown_durations_s(), "noise of four MEMS IMUs"};
  report.listings.push_back({"Command", result.command_line});
  report.footer = fmt::format("foucault {}", result.version);
  return report;
}

}  // namespace foucault::app
