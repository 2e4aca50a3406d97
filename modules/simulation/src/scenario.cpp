#include "foucault/simulation/scenario.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "airliner.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"
#include "road_vehicle.h"
#include "rollout.h"
#include "vehicle_styles.h"

namespace foucault::simulation {
namespace {

using simulation::Rollout;
using simulation::RolloutPose;

constexpr double kRolloutStep = 0.01;  ///< [s]

/// Stands where it is, a little tilted.
class Standing : public Rollout {
 public:
  explicit Standing(const ScenarioOptions& options) {
    pose_.position = options.start_position();
    pose_.euler = {1.0 * kDegree, -0.5 * kDegree, simulation::start_heading(options)};
  }
  RolloutPose pose() const override { return pose_; }
  void advance(double) override {}

 private:
  RolloutPose pose_;
};

using MakeRollout = std::function<std::unique_ptr<Rollout>(const ScenarioOptions&)>;

/// A kind of motion: its name, the knots of its splines, and what to step through time.
struct Scenario {
  const char* name;
  double knot_interval;  ///< [s]
  MakeRollout rollout;
  bool slips = false;  ///< follows the slip_* options
};

MakeRollout road(RoadStyle style) {
  return [style](const ScenarioOptions& o) { return std::make_unique<RoadVehicle>(style, o); };
}

MakeRollout vehicle(VehicleStyle (*style)(Draws&)) {
  return [style](const ScenarioOptions& o) {
    Draws draws(o.seed, RandomStream::surface);
    return std::make_unique<Vehicle>(style(draws), o);
  };
}

const std::vector<Scenario>& scenarios() {
  static const std::vector<Scenario> kScenarios{
      {"city", 0.5, road(city_style()), true},
      {"motorway", 0.5, road(motorway_style()), true},
      {"airliner", 1.0, [](const ScenarioOptions& o) { return std::make_unique<Airliner>(o); }},
      {"static", 10.0, [](const ScenarioOptions& o) { return std::make_unique<Standing>(o); }},
      {"walk", 0.05, vehicle(walk_style)},
      {"robot", 0.1, vehicle(robot_style)},
      {"rows", 0.25, vehicle(rows_style)},
      {"boat", 0.25, vehicle(boat_style)},
      {"copter", 0.2, vehicle(copter_style)},
      {"fixed_wing", 0.25, vehicle(fixed_wing_style)},
      {"train", 0.5, vehicle(train_style)},
      {"reversing", 0.25, vehicle(reversing_style)}};
  return kScenarios;
}

const Scenario& find_scenario(const std::string& name) {
  std::string known;
  for (const Scenario& scenario : scenarios()) {
    if (name == scenario.name) return scenario;
    known += std::string(known.empty() ? "" : ", ") + scenario.name;
  }
  throw UsageError("scenario '" + name + "' is unknown; choose one of " + known);
}

/// Growth per m/s times the speed at the knots, taken from their neighbours.
QuinticSpline growth_by_speed(const std::vector<Eigen::Vector3d>& positions, double knot_interval,
                              double per_speed) {
  const std::size_t last = positions.size() - 1;
  std::vector<Eigen::Vector3d> growth;
  growth.reserve(positions.size());
  for (std::size_t k = 0; k <= last; ++k) {
    const std::size_t before = k == 0 ? 0 : k - 1, after = std::min(k + 1, last);
    const double seconds = static_cast<double>(after - before) * knot_interval;
    const double speed = (positions[after] - positions[before]).norm() / seconds;
    growth.emplace_back(per_speed * speed, 0, 0);
  }
  return QuinticSpline(knot_interval, std::move(growth));
}

Vibration vibration_of(const ScenarioOptions& options,
                       const std::vector<Eigen::Vector3d>& positions, double knot_interval) {
  const double w = 2 * kPi * options.vibration_hz;
  Vibration vibration;
  vibration.frequency_hz = options.vibration_hz;
  vibration.position_amplitude = options.vibration_m_s2 / (w * w);
  vibration.angle_amplitude = options.vibration_deg * kDegree;
  if (options.vibration_growth != 0) {
    vibration.growth =
        growth_by_speed(positions, knot_interval, options.vibration_growth / kVibrationSpeed);
  }
  return vibration;
}

/// The IMU in w [m]; the roll-out's position is of the point at wheel_lever_arm_m.
Eigen::Vector3d imu_position_w(const RolloutPose& pose, const geodesy::LocalFrame& frame,
                               const ScenarioOptions& options) {
  const so3::Euler euler{pose.euler.x(), pose.euler.y(), pose.euler.z()};
  const Eigen::Vector3d arm_n = so3::from_euler(euler) * options.wheel_lever_arm_m;
  return frame.to_local(pose.position) - frame.R_w_n(pose.position) * arm_n;
}

/// The poses of a roll-out at the knots; before the trip it stands.
Trajectory follow(Rollout& rollout, const ScenarioOptions& options, double knot_interval) {
  const std::size_t count = QuinticSpline::controls_for(options.duration_s, knot_interval);
  const int64_t steps = std::lround(knot_interval / kRolloutStep);
  const geodesy::LocalFrame frame(options.start_position());
  std::vector<Eigen::Vector3d> positions, angles;
  positions.reserve(count);
  angles.reserve(count);
  int64_t due = std::lround(options.skip_s / kRolloutStep) - QuinticSpline::kControlsBefore * steps;
  int64_t done = 0;
  for (std::size_t k = 0; k < count; ++k, due += steps) {
    for (; done < due; ++done) rollout.advance(kRolloutStep);
    const RolloutPose pose = rollout.pose();
    positions.push_back(imu_position_w(pose, frame, options));
    angles.push_back(pose.euler);
  }
  Vibration vibration = vibration_of(options, positions, knot_interval);
  return Trajectory(options.start_position(), QuinticSpline(knot_interval, std::move(positions)),
                    QuinticSpline(knot_interval, std::move(angles)), std::move(vibration));
}

/// Of roll, pitch, heading [deg].
Eigen::Quaterniond rotation_of_degrees(const Eigen::Vector3d& angles_deg) {
  const Eigen::Vector3d angles = angles_deg * kDegree;
  return so3::from_euler({angles.x(), angles.y(), angles.z()});
}

std::vector<std::string> qualities() {
  std::vector<std::string> names;
  for (const FixQuality quality : {FixQuality::single, FixQuality::differential, FixQuality::ppp,
                                   FixQuality::float_rtk, FixQuality::fixed_rtk}) {
    names.emplace_back(name_of(quality));
  }
  return names;
}

}  // namespace

void ScenarioOptions::fields(ConfigFields& f) {
  f.text("name", name, scenario_names(), "kind of trip");
  f.number("duration_s", duration_s, {1, 1e6}, "length of the recording");
  f.integer("seed", seed, {}, "the same seed gives the same recording");
  f.number("latitude_deg", latitude_deg, {-89, 89}, "where the trip starts");
  f.number("longitude_deg", longitude_deg, {-180, 180}, "where the trip starts");
  f.number("height_m", height_m, {-1000, 20000}, "start height above the ellipsoid");
  f.optional_number("heading_deg", heading_deg, {-360, 360}, "at the start; none: by the seed");
  f.number("rest_s", rest_s, kNotNegative, "standing still before the trip");
  f.number("skip_s", skip_s, kNotNegative, "the recording begins so long after rest and trip do");
  f.integer("gps_week", gps_week, {0, 10000}, "start, GPS week");
  f.number("gps_sow_s", gps_sow_s, {0, kSecondsPerWeek}, "start, second of the GPS week");
  f.number("imu_rate_hz", imu_rate_hz, {10, 10000}, "samples per second");
  f.vector3("mounting_deg", mounting_deg, "roll, pitch, heading of the IMU in the vehicle");
  f.vector3("mounting_error_deg", mounting_error_deg, "true mounting minus mounting_deg");
  f.number("scale_factor_sigma_ppm", scale_factor_sigma_ppm, kNotNegative,
           "of each gyroscope and accelerometer axis");
  f.number("cross_axis_sigma_ppm", cross_axis_sigma_ppm, kNotNegative,
           "of what each gyroscope and accelerometer feels of the other axes");
  f.number("vibration_hz", vibration_hz, {1, 1000}, "frequency of the vibration");
  f.number("vibration_m_s2", vibration_m_s2, kNotNegative, "acceleration amplitude, 0: none");
  f.number("vibration_deg", vibration_deg, kNotNegative, "angle amplitude, 0: none");
  f.number("vibration_growth", vibration_growth, kNotNegative,
           "amplitudes are 1 + this * speed / 15 m/s times as large");
  f.number("vibration_rectification_m_s2", vibration_rectification_m_s2, kNotNegative,
           "accelerometer bias at 15 m/s, by the speed's square");
  f.numbers("imu_gap_start_s", imu_gap_start_s, kNotNegative, "IMU gaps, seconds after start");
  f.number("imu_gap_length_s", imu_gap_length_s, kNotNegative, "length of each IMU gap");
  f.number("gnss_rate_hz", gnss_rate_hz, {0.001, 1000}, "fixes per second");
  f.number("gnss_phase_s", gnss_phase_s, kNotNegative, "first fix, seconds after start");
  f.vector3("gnss_sigma_m", gnss_sigma_m, "position noise north, east, down");
  f.number("gnss_white_sigma", gnss_white_sigma, kNotNegative,
           "white position noise, in units of gnss_sigma_m");
  f.number("gnss_coloured_sigma", gnss_coloured_sigma, kNotNegative,
           "Gauss-Markov position noise, in units of gnss_sigma_m");
  f.number("gnss_coloured_tau_s", gnss_coloured_tau_s, kPositive, "its correlation time");
  f.number("gnss_velocity_sigma_m_s", gnss_velocity_sigma_m_s, kNotNegative,
           "velocity noise; 0: fixes without velocity");
  f.text("gnss_quality", gnss_quality, qualities(), "of the fixes where they are not degraded");
  f.flag("gnss_noise", gnss_noise, "false: exact fixes that report the sigmas all the same");
  f.number("gnss_degraded_start_s", gnss_degraded_start_s, kNotNegative,
           "poor GNSS, seconds after start");
  f.number("gnss_degraded_length_s", gnss_degraded_length_s, kNotNegative, "0: never poor");
  f.number("gnss_degraded_factor", gnss_degraded_factor, kPositive, "poor GNSS: sigmas times this");
  f.number("gnss_time_offset_s", gnss_time_offset_s, {-10, 10},
           "fixes are of so much before their stamps");
  f.number("gnss_time_drift_ppm", gnss_time_drift_ppm, {-1e4, 1e4},
           "change of that offset since the start");
  f.vector3("lever_arm_m", lever_arm_m, "IMU to antenna, forward, right, down");
  f.vector3("lever_arm_error_m", lever_arm_error_m, "true lever arm minus lever_arm_m");
  f.number("heading_sigma_deg", heading_sigma_deg, kNotNegative,
           "heading of two antennas in the fixes, as reported; 0: none");
  f.number("heading_noise_factor", heading_noise_factor, kNotNegative,
           "its true noise, by the reported sigma");
  f.number("heading_baseline_error_deg", heading_baseline_error_deg, {-180, 180},
           "true direction of the baseline, from forward to the right; forward is told");
  f.number("heading_outlier_percent", heading_outlier_percent, {0, 100},
           "of these headings, of any direction");
  wheel_fields(f);
  f.number("reference_rate_hz", reference_rate_hz, {0, 1000}, "true poses per second; 0: none");
}

void ScenarioOptions::wheel_fields(ConfigFields& f) {
  f.number("wheel_rate_hz", wheel_rate_hz, {0, 1000}, "wheel speeds per second; 0: none");
  f.number("wheel_scale_percent", wheel_scale_percent, {-50, 50},
           "wheel speeds are so much larger");
  f.number("wheel_sigma_m_s", wheel_sigma_m_s, kNotNegative, "noise of wheels that turn");
  f.number("wheel_step_m_s", wheel_step_m_s, kNotNegative, "wheel speeds are rounded to it");
  f.vector3("wheel_lever_arm_m", wheel_lever_arm_m,
            "IMU to the point that follows the road, forward, right, down");
  f.number("slip_sigma_m_s", slip_sigma_m_s, kNotNegative, "of that point, sideways");
  f.number("slip_tau_s", slip_tau_s, kPositive, "correlation time of the slip");
  f.number("slip_rad_per_m_s2", slip_rad_per_m_s2, {-0.1, 0.1},
           "course less heading of that point, per acceleration to the right");
}

Geodetic ScenarioOptions::start_position() const {
  return {latitude_deg * kDegree, longitude_deg * kDegree, height_m};
}

int64_t ScenarioOptions::start_ns() const {
  return gps_to_unix_ns(static_cast<int>(gps_week), gps_sow_s);
}

Eigen::Quaterniond ScenarioOptions::q_v_b() const { return rotation_of_degrees(mounting_deg); }

Eigen::Quaterniond ScenarioOptions::true_q_v_b() const {
  return rotation_of_degrees(mounting_deg + mounting_error_deg);
}

std::vector<std::string> scenario_names() {
  std::vector<std::string> names;
  for (const Scenario& scenario : scenarios()) names.emplace_back(scenario.name);
  return names;
}

Trajectory make_trajectory(const ScenarioOptions& options) {
  const Scenario& scenario = find_scenario(options.name);
  if (!scenario.slips && (options.slip_sigma_m_s != 0 || options.slip_rad_per_m_s2 != 0)) {
    throw UsageError("scenario: '" + options.name +
                     "' does not follow slip_*; city and motorway do");
  }
  const std::unique_ptr<Rollout> rollout = scenario.rollout(options);
  return follow(*rollout, options, scenario.knot_interval);
}

}  // namespace foucault::simulation
