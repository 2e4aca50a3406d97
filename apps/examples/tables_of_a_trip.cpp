/// A simulated trip as tables, for trying out embed_ekf: `tables_of_a_trip SECONDS` writes imu.csv,
/// gnss.csv and truth.csv (time, latitude, longitude [deg], height of the IMU) into this folder.

#include <cstdio>
#include <cstdlib>

#include "foucault/core/constants.h"
#include "foucault/simulation/simulated_source.h"

using namespace foucault;

struct Tables {
  std::FILE* imu = std::fopen("imu.csv", "w");
  std::FILE* gnss = std::fopen("gnss.csv", "w");
  std::FILE* truth = std::fopen("truth.csv", "w");

  static void row(std::FILE* file, int64_t t_ns, const Geodetic& p) {
    std::fprintf(file, "%.7f,%.10f,%.10f,%.4f", 1e-9 * t_ns, p.latitude / kDegree,
                 p.longitude / kDegree, p.height);
  }
  void operator()(const ImuIncrement& m) {
    const Eigen::Vector3d rate = m.dtheta_b / m.dt(), force = m.dvel_b / m.dt();
    std::fprintf(imu, "%.7f,%.12g,%.12g,%.12g,%.12g,%.12g,%.12g\n", 1e-9 * m.t_end_ns, rate.x(),
                 rate.y(), rate.z(), force.x(), force.y(), force.z());
  }
  void operator()(const GnssFix& m) {
    const Eigen::Vector3d sigma = m.position_covariance.diagonal().cwiseSqrt();
    row(gnss, m.t_ns, m.antenna);
    std::fprintf(gnss, ",%.4f,%.4f,%.4f\n", sigma.x(), sigma.y(), sigma.z());
  }
  void operator()(const ReferencePose& m) {
    row(truth, m.t_ns, m.position);
    std::fprintf(truth, "\n");
  }
  template <class Other>
  void operator()(const Other&) {}
};

int main(int argc, char** argv) {
  simulation::ScenarioOptions options;
  options.duration_s = argc > 1 ? std::atof(argv[1]) : 300;
  options.reference_rate_hz = 1;
  simulation::SimulatedSource source(options, imu::imu_preset("ADIS16465"));
  Tables tables;
  while (const auto measurement = source.next()) std::visit(tables, *measurement);
}
