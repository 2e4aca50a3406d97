#include "foucault/simulation/gnss_simulator.h"

#include <cmath>

#include "foucault/core/so3.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/wgs84.h"

namespace foucault::simulation {
namespace {

Eigen::Vector3d antenna_position_e(const Motion& motion, const Eigen::Vector3d& p_v_a) {
  const Eigen::Matrix3d R_e_n =
      geodesy::wgs84::R_e_n(motion.position.latitude, motion.position.longitude);
  return motion.p_e + R_e_n * (motion.q_n_v * p_v_a);
}

}  // namespace

GnssSimulator::GnssSimulator(const ScenarioOptions& options)
    : options_(options),
      p_b_a_(options.q_v_b().conjugate() * options.lever_arm_m),
      p_v_a_(options.lever_arm_m + options.lever_arm_error_m),
      position_draws_(options.seed, RandomStream::gnss_position),
      velocity_draws_(options.seed, RandomStream::gnss_velocity),
      coloured_draws_(options.seed, RandomStream::gnss_coloured),
      heading_draws_(options.seed, RandomStream::gnss_heading),
      coloured_(coloured_draws_.normal3()) {}

bool GnssSimulator::degraded(double t) const {
  const double since = t - options_.gnss_degraded_start_s;
  return since >= 0 && since < options_.gnss_degraded_length_s;
}

Eigen::Vector3d GnssSimulator::position_noise(double t) {
  if (coloured_at_) {
    const double elapsed = (t - *coloured_at_) / options_.gnss_coloured_tau_s;
    coloured_ = next_markov(coloured_, elapsed, coloured_draws_.normal3());
  }
  coloured_at_ = t;
  return options_.gnss_white_sigma * position_draws_.normal3() +
         options_.gnss_coloured_sigma * coloured_;
}

GnssFix GnssSimulator::measure(const Motion& motion, int64_t t_ns, double t) {
  const double factor = degraded(t) ? options_.gnss_degraded_factor : 1.0;
  const double noise = options_.gnss_noise ? 1.0 : 0.0;
  const Eigen::Vector3d sigma = factor * options_.gnss_sigma_m;
  const double velocity_sigma = factor * options_.gnss_velocity_sigma_m_s;
  const Eigen::Vector3d position_noise_n = noise * sigma.cwiseProduct(position_noise(t));
  const Eigen::Vector3d velocity_noise_n = noise * velocity_sigma * velocity_draws_.normal3();
  const Eigen::Matrix3d R_e_n =
      geodesy::wgs84::R_e_n(motion.position.latitude, motion.position.longitude);

  GnssFix fix;
  fix.t_ns = t_ns;
  fix.antenna = geodesy::wgs84::ecef_to_geodetic(antenna_position_e(motion, p_v_a_) +
                                                 R_e_n * position_noise_n);
  fix.position_covariance = sigma.cwiseAbs2().asDiagonal();
  fix.quality = degraded(t) ? FixQuality::float_rtk
                            : fix_quality(options_.gnss_quality).value_or(FixQuality::unknown);
  fix.p_b_a = p_b_a_;
  if (velocity_sigma > 0) {
    fix.velocity_n = point_velocity_n(motion, p_v_a_) + velocity_noise_n;
    fix.velocity_covariance = velocity_sigma * velocity_sigma * Eigen::Matrix3d::Identity();
  }
  if (options_.heading_sigma_deg > 0) fix.heading = heading(motion);
  return fix;
}

GnssHeading GnssSimulator::heading(const Motion& motion) {
  const double direction = options_.heading_baseline_error_deg * kDegree;
  const Eigen::Vector3d along_v(std::cos(direction), std::sin(direction), 0);
  const double draw = heading_draws_.normal();
  const double anywhere = heading_draws_.phase();
  const bool is_outlier = heading_draws_.happens(0.01 * options_.heading_outlier_percent);
  GnssHeading heading;
  heading.sigma = options_.heading_sigma_deg * kDegree;
  const double noise =
      options_.gnss_noise ? options_.heading_noise_factor * heading.sigma * draw : 0;
  heading.azimuth = so3::wrap(geodesy::azimuth(motion.q_n_v * along_v) + noise);
  if (is_outlier) heading.azimuth = so3::wrap(anywhere);
  return heading;
}

}  // namespace foucault::simulation
