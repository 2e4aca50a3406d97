/// The Kalman filter over data of your own: `embed_ekf imu.csv gnss.csv` prints a line an epoch.
///   imu.csv   time [s UNIX], mean rates x, y, z [rad/s] and forces x, y, z [m/s^2] since the row
///             before, on axes that look forward, right, down
///   gnss.csv  time, latitude, longitude [deg], height [m], sigma north, east, down [m]

#include <cmath>
#include <cstdio>
#include <optional>

#include "foucault/core/constants.h"
#include "foucault/ekf/ekf.h"
#include "foucault/imu/increments.h"
#include "foucault/navigation/navigation_run.h"

using namespace foucault;

struct Printer : state::Sink {  // of warnings and of what became of each fix, too, if it wants
  void epoch(const state::Epoch& e) override {
    const Eigen::Vector3d sigma = e.sigma_of(state::block::position);
    std::printf("%.3f,%.9f,%.9f,%.4f,%.4f,%.4f,%.4f\n", 1e-9 * e.t_ns,
                e.position.latitude / kDegree, e.position.longitude / kDegree, e.position.height,
                sigma.x(), sigma.y(), sigma.z());
  }
};

struct Row {
  double v[7];
  int64_t t_ns() const { return std::llround(1e9 * v[0]); }
  Eigen::Vector3d first() const { return {v[1], v[2], v[3]}; }
  Eigen::Vector3d second() const { return {v[4], v[5], v[6]}; }
};

std::optional<Row> next(std::FILE* file) {
  Row r{};
  const int count = std::fscanf(file, "%lf,%lf,%lf,%lf,%lf,%lf,%lf", r.v, r.v + 1, r.v + 2, r.v + 3,
                                r.v + 4, r.v + 5, r.v + 6);
  return count == 7 ? std::optional(r) : std::nullopt;
}

GnssFix fix_of(const Row& row) {
  GnssFix fix;
  fix.t_ns = row.t_ns();
  fix.antenna = {row.v[1] * kDegree, row.v[2] * kDegree, row.v[3]};
  fix.position_covariance = row.second().cwiseAbs2().asDiagonal();
  fix.p_b_a = {0.1, -0.3, -0.8};  // the lever arm, IMU to antenna [m]
  return fix;
}

int main(int argc, char** argv) {
  std::FILE* imu_file = argc == 3 ? std::fopen(argv[1], "r") : nullptr;
  std::FILE* gnss_file = argc == 3 ? std::fopen(argv[2], "r") : nullptr;
  if (imu_file == nullptr || gnss_file == nullptr)
    return std::puts("embed_ekf IMU.csv GNSS.csv"), 2;

  navigation::NavigationRunOptions options;
  options.imu = imu::imu_preset("ADIS16465");
  Printer printer;
  navigation::NavigationRun run(  // finds the start by itself, gates fixes, bridges holes
      std::make_unique<ekf::EkfNavigator>(options.imu, state::Layout(), ekf::EkfOptions()),
      alignment::Aligner(alignment::AlignmentOptions(), options.imu, state::Mounting()), options,
      printer);
  imu::Incrementer incrementer(imu::SampleKind::interval_mean);
  std::optional<Row> fix = next(gnss_file);
  while (const std::optional<Row> sample = next(imu_file)) {
    const auto increment = incrementer.add({sample->t_ns(), sample->first(), sample->second()});
    if (!increment) continue;
    for (; fix && fix->t_ns() <= increment->t_end_ns; fix = next(gnss_file))
      run.process(fix_of(*fix));
    run.process(*increment);
  }
  run.finish();
}
