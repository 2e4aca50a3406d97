#include <mrpt/obs/gnss_messages.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/rawlog/mrpt_convert.h"
#include "foucault/rawlog/rawlog_source.h"
#include "mrpt_records.h"
#include "nmea_accuracy.h"

/// GPS records of MRPT to fixes and back.
namespace foucault::rawlog {

namespace {

namespace gnss = mrpt::obs::gnss;
namespace position_type = mrpt::obs::gnss::nv_oem6_position_type;
namespace solution_status = mrpt::obs::gnss::nv_oem6_solution_status;
namespace ins_status = mrpt::obs::gnss::nv_oem6_ins_status_type;

constexpr double kVelocitySigma = 0.1;  ///< of a velocity vector that comes without one [m/s]
/// Spherical error probable of an isotropic error of sigma 1.
constexpr double kSepPerSigma = 1.5382;
constexpr uint32_t kMostSatellites = 256;

template <class Message>
const Message* message(const mrpt::obs::CObservationGPS& gps) {
  const auto found = gps.messages.find(static_cast<gnss::gnss_message_type_t>(Message::msg_type));
  if (found == gps.messages.end()) return nullptr;
  return dynamic_cast<const Message*>(found->second.get());
}

Eigen::Matrix3d diagonal(double north, double east, double down) {
  return Eigen::Vector3d(north * north, east * east, down * down).asDiagonal();
}

Geodetic geodetic(double latitude_deg, double longitude_deg, double height) {
  return {latitude_deg * kDegree, longitude_deg * kDegree, height};
}

// NovAtel BESTPOS -------------------------------------------------------------------------------

/// Table 84 of the OEM6 manual, and the types that OEM7 added. None: no position of GNSS.
std::optional<FixQuality> quality_of_type(uint32_t type) {
  switch (type) {
    case position_type::L1_INT:
    case position_type::WIDE_INT:
    case position_type::NARROW_INT:
    case position_type::RTK_DIRECT_INS:
    case position_type::INS_RTKFIXED:
      return FixQuality::fixed_rtk;
    case position_type::FLOATCONV:
    case position_type::WIDELANE:
    case position_type::NARROWLANE:
    case position_type::L1_FLOAT:
    case position_type::IONOFREE_FLOAT:
    case position_type::NARROW_FLOAT:
    case position_type::INS_RTKFLOAT:
      return FixQuality::float_rtk;
    case position_type::OMNISTAR_HP:
    case position_type::OMNISTAR_XP:
    case 68:  // PPP_CONVERGING
    case 69:  // PPP
    case 73:  // INS_PPP_CONVERGING
    case 74:  // INS_PPP
    case 77:  // PPP_BASIC_CONVERGING
    case 78:  // PPP_BASIC
      return FixQuality::ppp;
    case position_type::PSRDIFF:
    case position_type::WAAS:
    case position_type::OMNISTAR:
    case position_type::INS_PSRDIFF:
    case position_type::CDGPS:
      return FixQuality::differential;
    case position_type::SINGLE:
    case position_type::INS_PSRSP:
      return FixQuality::single;
    case position_type::NONE:
    case position_type::DOPPLER_VELOCITY:
    case position_type::PROPAGATED:
    case position_type::INS:
      return std::nullopt;
    default:
      return FixQuality::unknown;
  }
}

position_type::nv_position_type_t type_of_quality(FixQuality quality) {
  switch (quality) {
    case FixQuality::fixed_rtk:
      return position_type::NARROW_INT;
    case FixQuality::float_rtk:
      return position_type::NARROW_FLOAT;
    case FixQuality::ppp:
      return position_type::OMNISTAR_HP;
    case FixQuality::differential:
      return position_type::PSRDIFF;
    case FixQuality::single:
      return position_type::SINGLE;
    case FixQuality::unknown:
      break;
  }
  return position_type::Reserved;
}

std::optional<GnssFix> fix_of_bestpos(const gnss::Message_NV_OEM6_BESTPOS& message) {
  const auto fields = message.fields;  // packed: a copy, no references into it
  if (fields.solution_stat != solution_status::SOL_COMPUTED) return std::nullopt;
  const std::optional<FixQuality> quality = quality_of_type(fields.position_type);
  if (!quality) return std::nullopt;
  GnssFix fix;
  fix.quality = *quality;
  fix.antenna = geodetic(fields.lat, fields.lon, fields.hgt + fields.undulation);
  fix.position_covariance = diagonal(fields.lat_sigma, fields.lon_sigma, fields.hgt_sigma);
  return fix;
}

gnss::Message_NV_OEM6_BESTPOS bestpos_of(const GnssFix& fix) {
  const GpsTime time = unix_to_gps(fix.t_ns);
  const Eigen::Vector3d sigma = fix.position_covariance.diagonal().cwiseSqrt();
  gnss::Message_NV_OEM6_BESTPOS message;
  auto& fields = message.fields;
  fields.header.week = static_cast<uint16_t>(time.week);
  fields.header.ms_in_week = static_cast<uint32_t>(time.tow_ns / 1'000'000);
  fields.solution_stat = solution_status::SOL_COMPUTED;
  fields.position_type = type_of_quality(fix.quality);
  fields.lat = fix.antenna.latitude / kDegree;
  fields.lon = fix.antenna.longitude / kDegree;
  fields.hgt = fix.antenna.height;
  fields.undulation = 0;
  fields.lat_sigma = static_cast<float>(sigma.x());
  fields.lon_sigma = static_cast<float>(sigma.y());
  fields.hgt_sigma = static_cast<float>(sigma.z());
  fields.num_sats_sol =
      static_cast<uint8_t>(std::clamp(fix.details.satellites.value_or(0), 0, 255));
  fields.num_sats_tracked = fields.num_sats_sol;
  fields.diff_age = static_cast<float>(fix.details.correction_age.value_or(0));
  return message;
}

// TopCon PZS ------------------------------------------------------------------------------------

Eigen::Matrix3d ned_of_ecef(const mrpt::math::CMatrixFloat44& covariance_e,
                            const Eigen::Matrix3d& R_e_n) {
  Eigen::Matrix3d covariance;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      covariance(row, column) = covariance_e(row, column);
    }
  }
  const Eigen::Matrix3d turned = R_e_n.transpose() * covariance * R_e_n;
  return 0.5 * (turned + turned.transpose());
}

mrpt::math::CMatrixFloat44 ecef_of_ned(const Eigen::Matrix3d& covariance_n,
                                       const Eigen::Matrix3d& R_e_n) {
  const Eigen::Matrix3d turned = R_e_n * covariance_n * R_e_n.transpose();
  mrpt::math::CMatrixFloat44 covariance;
  covariance.setZero();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      covariance(row, column) = static_cast<float>(turned(row, column));
    }
  }
  return covariance;
}

GnssFix fix_of_pzs(const gnss::Message_TOPCON_PZS& pzs) {
  constexpr uint8_t kMillimetreGps = 2;
  GnssFix fix;
  fix.antenna = geodetic(pzs.latitude_degrees, pzs.longitude_degrees, pzs.height_meters);
  fix.quality = pzs.Fix == kMillimetreGps ? FixQuality::fixed_rtk : FixQuality::unknown;
  if (pzs.hasPosCov) return fix;
  const NmeaSigma assumed = nmea_sigma(fix.quality, std::nullopt);
  const double sep = pzs.PSigma / kSepPerSigma;
  fix.position_covariance =
      sep > 0 ? diagonal(sep, sep, sep)
              : diagonal(assumed.horizontal, assumed.horizontal, assumed.vertical);
  return fix;
}

void add_pzs_position_covariance(const gnss::Message_TOPCON_PZS& pzs, GnssFix& fix) {
  if (!pzs.hasPosCov) return;
  fix.position_covariance = ned_of_ecef(
      pzs.pos_covariance, geodesy::wgs84::R_e_n(fix.antenna.latitude, fix.antenna.longitude));
}

void add_pzs_velocity(const gnss::Message_TOPCON_PZS& pzs, GnssFix& fix) {
  const Eigen::Matrix3d R_e_n = geodesy::wgs84::R_e_n(fix.antenna.latitude, fix.antenna.longitude);
  const Eigen::Vector3d v_e(pzs.cartesian_vx, pzs.cartesian_vy, pzs.cartesian_vz);
  fix.velocity_n = R_e_n.transpose() * v_e;
  fix.velocity_covariance = pzs.hasVelCov
                                ? ned_of_ecef(pzs.vel_covariance, R_e_n)
                                : diagonal(kVelocitySigma, kVelocitySigma, kVelocitySigma);
}

bool is_diagonal(const Eigen::Matrix3d& matrix) {
  return matrix.isDiagonal(std::numeric_limits<double>::epsilon());
}

gnss::Message_TOPCON_PZS pzs_of(const GnssFix& fix) {
  const Eigen::Matrix3d R_e_n = geodesy::wgs84::R_e_n(fix.antenna.latitude, fix.antenna.longitude);
  const Eigen::Vector3d p_e = geodesy::wgs84::geodetic_to_ecef(fix.antenna);
  gnss::Message_TOPCON_PZS pzs;
  pzs.latitude_degrees = fix.antenna.latitude / kDegree;
  pzs.longitude_degrees = fix.antenna.longitude / kDegree;
  pzs.height_meters = fix.antenna.height;
  pzs.RTK_height_meters = fix.antenna.height;
  pzs.Fix = 1;
  pzs.hasPosCov = !is_diagonal(fix.position_covariance);
  pzs.pos_covariance = ecef_of_ned(fix.position_covariance, R_e_n);
  pzs.hasCartesianPosVel = fix.velocity_n.has_value();
  pzs.hasVelCov = fix.velocity_n.has_value();
  pzs.vel_covariance = ecef_of_ned(fix.velocity_covariance, R_e_n);
  const Eigen::Vector3d v_e = R_e_n * fix.velocity_n.value_or(Eigen::Vector3d::Zero());
  pzs.cartesian_x = p_e.x();
  pzs.cartesian_y = p_e.y();
  pzs.cartesian_z = p_e.z();
  pzs.cartesian_vx = v_e.x();
  pzs.cartesian_vy = v_e.y();
  pzs.cartesian_vz = v_e.z();
  return pzs;
}

// NMEA ------------------------------------------------------------------------------------------

/// The fix quality of GGA. None: no fix, or dead reckoning.
std::optional<FixQuality> quality_of_nmea(int indicator) {
  switch (indicator) {
    case 0:
    case 6:
      return std::nullopt;
    case 1:
    case 3:
      return FixQuality::single;
    case 2:
    case 9:
      return FixQuality::differential;
    case 4:
      return FixQuality::fixed_rtk;
    case 5:
      return FixQuality::float_rtk;
    default:
      return FixQuality::unknown;
  }
}

uint8_t nmea_of_quality(FixQuality quality) {
  switch (quality) {
    case FixQuality::fixed_rtk:
      return 4;
    case FixQuality::float_rtk:
      return 5;
    case FixQuality::ppp:
    case FixQuality::differential:
      return 2;
    case FixQuality::single:
    case FixQuality::unknown:
      break;
  }
  return 1;
}

std::optional<GnssFix> fix_of_gga(const gnss::Message_NMEA_GGA& message) {
  const auto fields = message.fields;
  const std::optional<FixQuality> quality = quality_of_nmea(fields.fix_quality);
  if (!quality) return std::nullopt;
  const std::optional<double> hdop =
      fields.thereis_HDOP ? std::optional<double>(fields.HDOP) : std::nullopt;
  const NmeaSigma sigma = nmea_sigma(*quality, hdop);
  GnssFix fix;
  fix.quality = *quality;
  fix.antenna = geodetic(fields.latitude_degrees, fields.longitude_degrees,
                         fields.altitude_meters + fields.geoidal_distance);
  fix.position_covariance = diagonal(sigma.horizontal, sigma.horizontal, sigma.vertical);
  return fix;
}

gnss::UTC_time time_of_day(int64_t t_ns) {
  constexpr int64_t kMinute = 60 * kNanosecondsPerSecond;
  const int64_t of_day_ns =
      (t_ns % kNanosecondsPerDay + kNanosecondsPerDay) % kNanosecondsPerDay;  // before 1970 too
  gnss::UTC_time time;
  time.hour = static_cast<uint8_t>(of_day_ns / kMinute / 60);
  time.minute = static_cast<uint8_t>(of_day_ns / kMinute % 60);
  time.sec = to_seconds(of_day_ns % kMinute);
  return time;
}

/// What programs look for that know nothing but NMEA (rawlog-edit); BESTPOS says the same better.
gnss::Message_NMEA_GGA gga_of(const GnssFix& fix) {
  gnss::Message_NMEA_GGA message;
  auto& fields = message.fields;
  fields.UTCTime = time_of_day(fix.t_ns);
  fields.latitude_degrees = fix.antenna.latitude / kDegree;
  fields.longitude_degrees = fix.antenna.longitude / kDegree;
  fields.altitude_meters = fix.antenna.height;
  fields.orthometric_altitude = fix.antenna.height;
  fields.corrected_orthometric_altitude = fix.antenna.height;
  fields.geoidal_distance = 0;
  fields.fix_quality = nmea_of_quality(fix.quality);
  fields.satellitesUsed = static_cast<uint32_t>(std::max(fix.details.satellites.value_or(0), 0));
  fields.thereis_HDOP = fix.details.hdop.has_value();
  fields.HDOP = static_cast<float>(fix.details.hdop.value_or(0));
  return message;
}

FixDetails details_of(const mrpt::obs::CObservationGPS& gps) {
  FixDetails details;
  if (const auto* gga = message<gnss::Message_NMEA_GGA>(gps)) {
    const auto fields = gga->fields;
    if (fields.satellitesUsed > 0 && fields.satellitesUsed < kMostSatellites) {
      details.satellites = static_cast<int>(fields.satellitesUsed);
    }
    if (fields.thereis_HDOP && fields.HDOP > 0) details.hdop = fields.HDOP;
  }
  if (const auto* bestpos = message<gnss::Message_NV_OEM6_BESTPOS>(gps)) {
    const auto fields = bestpos->fields;
    if (fields.num_sats_sol > 0) details.satellites = fields.num_sats_sol;
    if (fields.diff_age > 0) details.correction_age = fields.diff_age;
  }
  return details;
}

GroundVelocity ground_velocity(double speed, double course) {
  return {Eigen::Vector3d(speed * std::cos(course), speed * std::sin(course), 0),
          diagonal(kGroundSpeedSigma, kGroundSpeedSigma, kOpenVerticalSigma)};
}

// Receivers of newer MRPT -----------------------------------------------------------------------

template <class Gps, class = void>
struct HasCovarianceEnu : std::false_type {};
template <class Gps>
struct HasCovarianceEnu<Gps, std::void_t<decltype(std::declval<Gps>().covariance_enu)>>
    : std::true_type {};

/// East-North-Up to North-East-Down, and back.
Eigen::Matrix3d ned_of_enu(const Eigen::Matrix3d& covariance) {
  const Eigen::Matrix3d turn = (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();
  return turn * covariance * turn.transpose();
}

/// The covariance that MRPT keeps beside the messages from 2.11.12 on.
template <class Gps>
std::optional<Eigen::Matrix3d> covariance_enu(const Gps& gps) {
  if (const auto* record = dynamic_cast<const GpsRecord*>(&gps)) {
    return record->position_covariance_w;
  }
  if constexpr (HasCovarianceEnu<Gps>::value) {
    if (gps.covariance_enu) return Eigen::Matrix3d(gps.covariance_enu->asEigen());
  }
  return std::nullopt;
}

/// The quality by the fix type of version 13; none if there is no position of GNSS.
std::optional<FixQuality> quality_of_record(const GpsRecord& record, FixQuality otherwise) {
  switch (record.kind_of_fix) {
    case GpsRecord::kNoFix:
    case GpsRecord::kDeadReckoning:
      return std::nullopt;
    case GpsRecord::kAutonomous:
      return FixQuality::single;
    case GpsRecord::kSbas:
    case GpsRecord::kGbas:
    case GpsRecord::kDgps:
      return FixQuality::differential;
    case GpsRecord::kRtkFloat:
      return FixQuality::float_rtk;
    case GpsRecord::kRtkFixed:
      return FixQuality::fixed_rtk;
    case GpsRecord::kPpp:
      return FixQuality::ppp;
    default:
      return otherwise;
  }
}

std::optional<GnssFix> position_of(const mrpt::obs::CObservationGPS& gps) {
  if (const auto* bestpos = message<gnss::Message_NV_OEM6_BESTPOS>(gps)) {
    return fix_of_bestpos(*bestpos);
  }
  if (const auto* pzs = message<gnss::Message_TOPCON_PZS>(gps)) return fix_of_pzs(*pzs);
  if (const auto* gga = message<gnss::Message_NMEA_GGA>(gps)) return fix_of_gga(*gga);
  return std::nullopt;
}

}  // namespace

std::optional<GroundVelocity> decode_velocity(const mrpt::obs::CObservationGPS& gps) {
  const auto* rmc = message<gnss::Message_NMEA_RMC>(gps);
  const auto* vtg = message<gnss::Message_NMEA_VTG>(gps);
  if (rmc != nullptr && rmc->fields.validity_char == 'A') {
    return ground_velocity(rmc->fields.speed_knots * kKnot,
                           rmc->fields.direction_degrees * kDegree);
  }
  if (rmc == nullptr && vtg != nullptr) {
    return ground_velocity(vtg->fields.ground_speed_knots * kKnot,
                           vtg->fields.true_track * kDegree);
  }
  return std::nullopt;
}

std::optional<GnssFix> decode_fix(const mrpt::obs::CObservationGPS& gps, int64_t t_ns) {
  std::optional<GnssFix> fix = position_of(gps);
  if (!fix) return std::nullopt;
  fix->t_ns = t_ns;
  if (const auto* record = dynamic_cast<const GpsRecord*>(&gps)) {
    const std::optional<FixQuality> quality = quality_of_record(*record, fix->quality);
    if (!quality) return std::nullopt;
    fix->quality = *quality;
  }
  const std::optional<Eigen::Matrix3d> covariance = covariance_enu(gps);
  const bool told = covariance && (covariance->diagonal().array() > 0).all();  // zero: unknown
  if (told) fix->position_covariance = ned_of_enu(*covariance);
  fix->details = details_of(gps);
  const auto* pzs = message<gnss::Message_TOPCON_PZS>(gps);
  if (pzs != nullptr) add_pzs_position_covariance(*pzs, *fix);
  if (pzs != nullptr && pzs->hasCartesianPosVel) {
    add_pzs_velocity(*pzs, *fix);
  } else {
    if (const std::optional<GroundVelocity> velocity = decode_velocity(gps)) {
      fix->velocity_n = velocity->velocity_n;
      fix->velocity_covariance = velocity->covariance;
    }
  }
  return fix;
}

std::optional<GnssFix> decode_rmc(const mrpt::obs::CObservationGPS& gps, int64_t t_ns) {
  constexpr double kNoHeightSigma = 1000;
  const auto* rmc = message<gnss::Message_NMEA_RMC>(gps);
  if (rmc == nullptr || rmc->fields.validity_char != 'A') return std::nullopt;
  const auto fields = rmc->fields;
  const NmeaSigma sigma = nmea_sigma(FixQuality::unknown, std::nullopt);
  const GroundVelocity velocity =
      ground_velocity(fields.speed_knots * kKnot, fields.direction_degrees * kDegree);
  GnssFix fix;
  fix.t_ns = t_ns;
  fix.antenna = geodetic(fields.latitude_degrees, fields.longitude_degrees, 0);
  fix.position_covariance = diagonal(sigma.horizontal, sigma.horizontal, kNoHeightSigma);
  fix.velocity_n = velocity.velocity_n;
  fix.velocity_covariance = velocity.covariance;
  return fix;
}

void encode_fix(const GnssFix& fix, mrpt::obs::CObservationGPS& gps) {
  gps.messages.clear();
  gps.has_satellite_timestamp = true;
  gps.setMsg(bestpos_of(fix));
  gps.setMsg(gga_of(fix));
  if (fix.velocity_n || !is_diagonal(fix.position_covariance)) gps.setMsg(pzs_of(fix));
}

namespace {

ReferencePose pose_of_inspvas(const gnss::Message_NV_OEM6_INSPVAS::content_t& fields,
                              int64_t t_ns) {
  ReferencePose pose;
  pose.t_ns = t_ns;
  pose.position = geodetic(fields.lat, fields.lon, fields.hgt);
  const Eigen::Vector3d velocity(fields.vel_north, fields.vel_east, -fields.vel_up);
  const Eigen::Vector3d angles(fields.roll, fields.pitch, fields.azimuth);
  if (velocity.allFinite()) pose.velocity_n = velocity;
  // NovAtel turns by azimuth, pitch, roll, in this order, as forward-right-down does.
  if (angles.allFinite()) {
    pose.q_n_v =
        so3::from_euler({angles.x() * kDegree, angles.y() * kDegree, angles.z() * kDegree});
  }
  return pose;
}

}  // namespace

std::optional<ReferencePose> decode_reference(const mrpt::obs::CObservationGPS& gps, int64_t t_ns) {
  const auto* ins = message<gnss::Message_NV_OEM6_INSPVAS>(gps);
  if (ins == nullptr) return std::nullopt;
  return pose_of_inspvas(ins->fields, t_ns);
}

ReferencePose decode_reference(const InsRecord& record, int64_t t_ns) {
  gnss::Message_NV_OEM6_INSPVAS::content_t fields;
  std::memcpy(static_cast<void*>(&fields), record.message.begin, sizeof(fields));
  return pose_of_inspvas(fields, t_ns);
}

void encode_reference(const ReferencePose& pose, mrpt::obs::CObservationGPS& gps) {
  constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
  const GpsTime time = unix_to_gps(pose.t_ns);
  const Eigen::Vector3d velocity = pose.velocity_n.value_or(Eigen::Vector3d::Constant(kAbsent));
  const so3::Euler euler =
      pose.q_n_v ? so3::to_euler(*pose.q_n_v) : so3::Euler{kAbsent, kAbsent, kAbsent};
  gnss::Message_NV_OEM6_INSPVAS message;
  auto& fields = message.fields;
  fields.header.week = static_cast<uint16_t>(time.week);
  fields.header.ms_in_week = static_cast<uint32_t>(time.tow_ns / 1'000'000);
  fields.week = static_cast<uint32_t>(time.week);
  fields.seconds_in_week = static_cast<double>(time.tow_ns) * 1e-9;
  fields.lat = pose.position.latitude / kDegree;
  fields.lon = pose.position.longitude / kDegree;
  fields.hgt = pose.position.height;
  fields.vel_north = velocity.x();
  fields.vel_east = velocity.y();
  fields.vel_up = -velocity.z();
  fields.roll = euler.roll / kDegree;
  fields.pitch = euler.pitch / kDegree;
  fields.azimuth = euler.heading / kDegree;
  fields.ins_status = ins_status::INS_SOLUTION_GOOD;
  gps.messages.clear();
  gps.has_satellite_timestamp = true;
  gps.setMsg(message);
}

}  // namespace foucault::rawlog
