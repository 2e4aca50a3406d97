#include "foucault/export/solution_csv.h"

#include <fmt/format.h>

#include <iterator>

#include "foucault/core/units.h"
#include "foucault/state/blocks.h"
#include "foucault/state/vehicle_attitude.h"

namespace foucault::exports {
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

std::string csv_row(const state::Epoch& epoch, const state::Mounting& mounting) {
  const state::VehicleAttitude attitude = state::vehicle_attitude(epoch, mounting);
  const so3::Euler& euler = attitude.euler;
  std::string row = units::format_stamp(epoch.t_ns);
  row.reserve(512);
  fmt::format_to(std::back_inserter(row), ",{:.11f},{:.11f},{:.5f}",
                 epoch.position.latitude * units::kDegrees,
                 epoch.position.longitude * units::kDegrees, epoch.position.height);
  append(row, epoch.velocity_n, 6);
  append(row, Eigen::Vector3d(euler.roll, euler.pitch, euler.heading) * units::kDegrees, 7);
  append(row, epoch.bias.gyro * units::kDegreesPerHour, 5);
  append(row, epoch.bias.accel * units::kMilligals, 4);
  append_sigmas(row, epoch.sigma_of(state::block::position));
  append_sigmas(row, epoch.sigma_of(state::block::velocity));
  append_sigmas(row, attitude.sigma * units::kDegrees);
  append_sigmas(row, epoch.sigma_of(state::block::gyro_bias) * units::kDegreesPerHour);
  append_sigmas(row, epoch.sigma_of(state::block::accel_bias) * units::kMilligals);
  row += '\n';
  return row;
}

SolutionCsv::SolutionCsv(const std::filesystem::path& path, const state::Mounting& mounting)
    : mounting_(mounting), file_(path) {
  file_.write(csv_header());
}

}  // namespace foucault::exports
