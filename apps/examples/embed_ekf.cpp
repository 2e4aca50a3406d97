/// The Kalman filter over imu.csv (time [s], mean rates [rad/s] and forces [m/s^2] since the row
/// before; forward, right, down) and gnss.csv (time, latitude, longitude [deg], height, sigmas).
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
int main() {
  std::ifstream imus("imu.csv"), fixes("gnss.csv");
  const navigation::NavigationRunOptions options(imu::imu_preset("ADIS16465"));
  state::EpochSink printer([](const state::Epoch& e) {  // a Sink of your own is told of fixes, too
    std::printf("%.3f,%.9f,%.9f,%.4f,%.4f\n", to_seconds(e.t_ns), e.position.latitude / kDegree,
                e.position.longitude / kDegree, e.position.height,
                e.sigma_of(state::block::position).norm());
  });
  navigation::NavigationRun run(std::make_unique<ekf::EkfNavigator>(options.imu), options, printer);
  imu::Incrementer incrementer(imu::SampleKind::interval_mean);
  Row row, fixed;
  if (!(fixes >> fixed && imus >> row)) return std::fputs("no imu.csv or gnss.csv\n", stderr), 1;
  do {
    for (; fixes && fixed[0] <= row[0]; fixes >> fixed) {
      GnssFix fix{nanoseconds(fixed[0]), {fixed[1] * kDegree, fixed[2] * kDegree, fixed[3]}};
      fix.position_covariance = fixed.tail<3>().cwiseAbs2().asDiagonal();
      fix.p_b_a = {0.1, -0.3, -0.8};  // the lever arm, IMU to antenna [m]
      run.process(fix);
    }
    const auto step = incrementer.add({nanoseconds(row[0]), row.segment<3>(1), row.tail<3>()});
    if (step) run.process(*step);
  } while (imus >> row);
  run.finish();
}
