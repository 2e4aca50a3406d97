#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "foucault/imu/imu_noise.h"
#include "foucault/laboratory/exact_interval.h"
#include "foucault/laboratory/lab_motion.h"

namespace foucault::laboratory {

/// What a study of preintegration goes through.
struct StudyPlan {
  std::vector<double> durations_s{0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60};
  std::vector<double> rates_hz{50, 100, 200, 500, 1000};  ///< divide 1000
  double rate_hz = 200;                                   ///< where only one rate is studied
  std::vector<double> fine_rates_hz{2000, 4000, 8000};    ///< besides, over fine_duration_s
  double fine_duration_s = 1;
  std::vector<double> origin_distances_km{0, 0.1, 0.3, 1, 3, 10, 30, 100, 300, 600};
  std::vector<std::string> grades = imu::imu_preset_names();
};

/// Errors against the truth at the end of an interval, 3-D.
struct MotionError {
  double position = 0;  ///< [m]
  double velocity = 0;  ///< [m/s]
  double attitude = 0;  ///< angle of the rotation between the two [rad]
};
MotionError error_of(const state::NodeState& estimate, const state::NodeState& truth);

/// Kinds of what is measured.
enum class LabGroup {
  model,     ///< Preintegrator and predict() of a method; see lab_models()
  ablation,  ///< `full` without one of its terms; see lab_ablations()
  distance,  ///< `refined` with the origin of w at a distance behind the vehicle
  noise      ///< 1 sigma by white noise and wandering biases of an IMU, from known biases on
};
const char* group_name(LabGroup group);

/// A row of the result: root mean square over the intervals of a motion.
struct LabRow {
  LabGroup group = LabGroup::model;
  std::string name;  ///< model, term that is left out, or IMU preset
  double rate_hz = 0;
  double duration_s = 0;
  double origin_distance_m = 0;  ///< of the intervals' starts from the origin of w, mean
  MotionError rms;
};

struct LabName {
  std::string key;
  std::string title;
};
/// `rough` and `refined` with the origin of w where the trip began, as in a run; `rough_local` and
/// `refined_local` with the origin where the interval begins: what is left of their error once an
/// estimator has turned its attitude by the error in gravity's direction; `full`; `discretization`:
/// AblatedIntegrator with the gravity of every place, where nothing is missing but the motion
/// within the samples.
const std::vector<LabName>& lab_models();
/// What is left out; first `none`, AblatedIntegrator with all that `full` has.
const std::vector<LabName>& lab_ablations();

struct MotionStudy {
  std::string name;
  std::string title;
  int intervals = 0;
  double nearest_m = 0, farthest_m = 0;  ///< intervals' starts from the start of the trip
  double slowest_m_s = 0, fastest_m_s = 0;
  std::vector<LabRow> rows;
};

/// The first row that fits; throws std::out_of_range if there is none.
const LabRow& find_row(const MotionStudy& study, LabGroup group, const std::string& name,
                       double rate_hz, double duration_s);

/// Integrates one motion. The intervals are independent of each other: measure() may be called from
/// several threads.
class PreintegrationStudy {
 public:
  /// Throws std::invalid_argument if a duration is no whole number of samples of every rate.
  PreintegrationStudy(LabMotion motion, StudyPlan plan);

  int intervals() const { return motion_.intervals; }

  /// All rows of one interval, in the same order for each; the errors are its own.
  struct Record {
    double distance_m = 0;
    double speed_m_s = 0;
    std::vector<LabRow> rows;
  };
  Record measure(int interval) const;

  /// Precondition: at least one record.
  MotionStudy summarize(const std::vector<Record>& records) const;

 private:
  LabMotion motion_;
  StudyPlan plan_;
  simulation::Trajectory trajectory_;
};

}  // namespace foucault::laboratory
