#include "solution_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "foucault/state/blocks.h"
#include "foucault/state/vehicle_attitude.h"
#include "units.h"

namespace foucault::app {
namespace {

void append(std::string& row, const Eigen::Vector3d& values, int decimals) {
  for (const double value : values)
    fmt::format_to(std::back_inserter(row), ",{:.{}f}", value, decimals);
}

void append_sigmas(std::string& row, const Eigen::Vector3d& values) {
  for (const double value : values) fmt::format_to(std::back_inserter(row), ",{:.6g}", value);
}

}  // namespace

std::string csv_header() {
  return "t_unix_s,lat_deg,lon_deg,height_m,v_north_m_s,v_east_m_s,v_down_m_s,"
         "roll_deg,pitch_deg,heading_deg,"
         "gyro_bias_x_deg_h,gyro_bias_y_deg_h,gyro_bias_z_deg_h,"
         "accel_bias_x_mgal,accel_bias_y_mgal,accel_bias_z_mgal,"
         "sd_north_m,sd_east_m,sd_down_m,sd_v_north_m_s,sd_v_east_m_s,sd_v_down_m_s,"
         "sd_roll_deg,sd_pitch_deg,sd_heading_deg,"
         "sd_gyro_bias_x_deg_h,sd_gyro_bias_y_deg_h,sd_gyro_bias_z_deg_h,"
         "sd_accel_bias_x_mgal,sd_accel_bias_y_mgal,sd_accel_bias_z_mgal\n";
}

std::string csv_row(const Epoch& epoch, const Mounting& mounting) {
  const VehicleAttitude attitude = vehicle_attitude(epoch, mounting);
  const so3::Euler& euler = attitude.euler;
  std::string row = format_stamp(epoch.t_ns);
  row.reserve(512);
  fmt::format_to(std::back_inserter(row), ",{:.11f},{:.11f},{:.5f}",
                 epoch.position.latitude * kDegrees, epoch.position.longitude * kDegrees,
                 epoch.position.height);
  append(row, epoch.velocity_n, 6);
  append(row, Eigen::Vector3d(euler.roll, euler.pitch, euler.heading) * kDegrees, 7);
  append(row, epoch.bias.gyro * kDegreesPerHour, 5);
  append(row, epoch.bias.accel * kMilligals, 4);
  append_sigmas(row, epoch.sigma_of(block::position));
  append_sigmas(row, epoch.sigma_of(block::velocity));
  append_sigmas(row, attitude.sigma * kDegrees);
  append_sigmas(row, epoch.sigma_of(block::gyro_bias) * kDegreesPerHour);
  append_sigmas(row, epoch.sigma_of(block::accel_bias) * kMilligals);
  row += '\n';
  return row;
}

std::string tum_row(const Epoch& epoch, const Mounting& mounting, const LocalFrame& frame) {
  const Eigen::Quaterniond q_enu_ned(0, std::sqrt(0.5), std::sqrt(0.5), 0);
  const Eigen::Quaterniond q_frd_flu(0, 1, 0, 0);
  const Eigen::Vector3d p_w = frame.to_local(epoch.position);
  const Eigen::Quaterniond q_w_n(frame.R_w_n(epoch.position));
  const Eigen::Quaterniond q =
      (q_enu_ned * q_w_n * vehicle_attitude(epoch, mounting).q_n_v * q_frd_flu).normalized();
  return fmt::format("{} {:.5f} {:.5f} {:.5f} {:.10f} {:.10f} {:.10f} {:.10f}\n",
                     format_stamp(epoch.t_ns), p_w.y(), p_w.x(), -p_w.z(), q.x(), q.y(), q.z(),
                     q.w());
}

SolutionWriter::SolutionWriter(const std::filesystem::path& folder, const Mounting& mounting)
    : mounting_(mounting),
      csv_(folder / "solution.csv"),
      tum_(folder / "solution.tum"),
      kml_(folder / "solution.kml") {
  csv_.write(csv_header());
}

void SolutionWriter::epoch(const Epoch& epoch) {
  if (!frame_) frame_.emplace(epoch.position);
  csv_.write(csv_row(epoch, mounting_));
  tum_.write(tum_row(epoch, mounting_, *frame_));
  kml_.epoch(epoch);
}

void SolutionWriter::finish() {
  csv_.close();
  tum_.close();
  kml_.finish();
}

}  // namespace foucault::app
