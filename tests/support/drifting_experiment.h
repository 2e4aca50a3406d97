#pragma once

#include <memory>
#include <string>
#include <vector>

#include "foucault/evaluation/experiment.h"
#include "support/drifting_estimator.h"

namespace foucault::test {

/// Drifts of `scale` times 9 m in outages of 30 s at 100 s, 150 s, ..., each shifted.
inline evaluation::ExperimentRun drifting_run(const std::string& recording,
                                              const std::string& method, double scale,
                                              double shift_s, double duration_s = 275,
                                              bool with_reference = true) {
  evaluation::OutageOptions outages;
  outages.first_s = 100;
  outages.length_s = 30;
  outages.period_s = 50;
  evaluation::ExperimentRun run;
  run.recording = recording;
  run.imu = "none";
  run.method = method;
  run.shift_s = shift_s;
  run.needs_outage = shift_s == 0;
  run.schedule = evaluation::OutageSchedule(outages, shift_s);
  run.open = [duration_s, with_reference] {
    return std::make_unique<RestSource>(duration_s, with_reference);
  };
  run.make_estimator = [scale](const state::Mounting&, state::Sink& sink) {
    return std::make_unique<DriftingEstimator>(sink, scale);
  };
  return run;
}

/// Two recordings, two methods, two shifts.
inline std::vector<evaluation::ExperimentRun> drifting_runs() {
  std::vector<evaluation::ExperimentRun> runs;
  for (const char* recording : {"b", "a"}) {
    for (const double shift_s : {0.0, 25.0}) {
      runs.push_back(drifting_run(recording, "good", 1, shift_s));
      runs.push_back(drifting_run(recording, "bad", 2, shift_s));
    }
  }
  return runs;
}

}  // namespace foucault::test
