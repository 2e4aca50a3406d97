#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// The paper's experiment on simulated recordings: four IMUs on the same trips, each trip with
/// outages of 60 s every 150 s after 500 s and again with shifted starts. Plain lists: whoever runs
/// them knows recordings and estimators.
namespace foucault::laboratory {

struct PaperExperiment {
  std::vector<double> trips_s;  ///< lengths of the trips; the paper's are 2325, 1617 and 2333 s
};

/// The IMUs of Table I, by their presets.
const std::vector<std::string>& paper_imus();

/// IMU-LENGTHs
std::string recording_name(const std::string& imu, double length_s);

struct PaperRecording {
  std::string name;
  std::string imu;
  double length_s = 0;
  int64_t seed = 0;  ///< of the trip and its noise
};
std::vector<PaperRecording> recordings(const PaperExperiment& experiment);

struct TunedNoise {
  double gyro_bias_deg_h = 0;
  double arw_deg_sqrt_h = 0;
};

/// A method on a recording; without `noise` configured by what was simulated.
struct PaperCase {
  std::string recording;
  std::string imu;
  std::string method;
  std::optional<TunedNoise> noise;
};

/// ekf, refined, rough and full on every recording with the noise that was simulated.
std::vector<PaperCase> cases_as_simulated(const PaperExperiment& experiment);

/// The paper's three with the noise parameters tuned for each IMU and method, as it did.
std::vector<PaperCase> cases_tuned(const PaperExperiment& experiment);

/// What the reports say of the data.
std::vector<std::string> remarks_as_simulated();
std::vector<std::string> remarks_tuned();

}  // namespace foucault::laboratory
