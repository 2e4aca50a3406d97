/// The Kalman filter over data of your own: `embed_ekf imu.csv gnss.csv` prints a line an epoch.
///   imu.csv   time [s UNIX], mean rates x, y, z [rad/s] and forces x, y, z [m/s^2] since the row
///             before, on axes that look forward, right, down
///   gnss.csv  time, latitude, longitude [deg], height [m], sigma north, east, down [m]

#include <cstdio>
#include <fstream>

#include "foucault/core/time.h"
#include "foucault/ekf/ekf.h"
#include "foucault/imu/increments.h"
#include "foucault/navigation/navigation_run.h"
#include "foucault/state/epoch_sink.h"
using namespace foucault;

using Row = Eigen::Matrix<double, 7, 1>;
std::istream& operator>>(std::istream& in, Row& row) {
  for (double& value : row) (in >> value).ignore();
  return in;
}

int main(int argc, char** argv) {
  std::ifstream imu_file(argc == 3 ? argv[1] : ""), gnss_file(argc == 3 ? argv[2] : "");
  if (!imu_file || !gnss_file) return std::puts("embed_ekf IMU.csv GNSS.csv"), 2;
  navigation::NavigationRunOptions options;
  options.imu = imu::imu_preset("ADIS16465");
  state::EpochSink printer([](const state::Epoch& e) {  // a Sink of your own is told of fixes, too
    const Eigen::Vector3d sigma = e.sigma_of(state::block::position);
    std::printf("%.3f,%.9f,%.9f,%.4f,%.4f,%.4f,%.4f\n", to_seconds(e.t_ns),
                e.position.latitude / kDegree, e.position.longitude / kDegree, e.position.height,
                sigma.x(), sigma.y(), sigma.z());
  });
  // Finds the start by itself, gates fixes, bridges holes.
  navigation::NavigationRun run(std::make_unique<ekf::EkfNavigator>(options.imu), options, printer);
  imu::Incrementer incrementer(imu::SampleKind::interval_mean);
  Row row, fixed;
  for (gnss_file >> fixed; imu_file >> row;) {
    for (; gnss_file && fixed[0] <= row[0]; gnss_file >> fixed) {
      GnssFix fix{nanoseconds(fixed[0]), {fixed[1] * kDegree, fixed[2] * kDegree, fixed[3]}};
      fix.position_covariance = fixed.tail<3>().cwiseAbs2().asDiagonal();
      fix.p_b_a = {0.1, -0.3, -0.8};  // the lever arm, IMU to antenna [m]
      run.process(fix);
    }
    const auto increment = incrementer.add({nanoseconds(row[0]), row.segment<3>(1), row.tail<3>()});
    if (increment) run.process(*increment);
  }
  run.finish();
}
