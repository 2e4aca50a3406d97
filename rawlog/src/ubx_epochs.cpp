#include "ubx_epochs.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/geodesy/wgs84.h"
#include "import_run.h"
#include "record_cursor.h"

namespace foucault::rawlog {

namespace {

constexpr int64_t kUbxMillisecond = 1'000'000;  ///< [ns]
constexpr double kUbxAngle = 1e-7 * kDegree;
constexpr double kUbxFineAngle = 1e-9 * kDegree;
constexpr double kUbxMillimetre = 1e-3;
constexpr double kUbxTenthMillimetre = 1e-4;
constexpr double kUbxCentimetre = 1e-2;

template <class T>
double ubx_number(RecordCursor& cursor) {
  return static_cast<double>(cursor.get<T>());
}

/// Three numbers of a kind.
template <class T>
Eigen::Vector3d ubx_vector(RecordCursor& cursor) {
  Eigen::Vector3d vector;
  for (int i = 0; i < 3; ++i) vector[i] = ubx_number<T>(cursor);
  return vector;
}

/// Longitude, latitude, height and height above the sea.
Geodetic ubx_place(RecordCursor& cursor, double metre) {
  Geodetic place;
  place.longitude = ubx_number<int32_t>(cursor) * kUbxAngle;
  place.latitude = ubx_number<int32_t>(cursor) * kUbxAngle;
  place.height = ubx_number<int32_t>(cursor) * metre;
  cursor.skip(sizeof(int32_t));
  return place;
}

/// Year, month, day, hour, minute, second.
std::optional<int64_t> ubx_utc(RecordCursor& cursor) {
  const auto year = cursor.get<uint16_t>();
  const auto month = cursor.get<uint8_t>();
  const auto day = cursor.get<uint8_t>();
  const auto hour = cursor.get<uint8_t>();
  const auto minute = cursor.get<uint8_t>();
  const auto second = cursor.get<uint8_t>();
  const std::optional<int64_t> midnight =
      midnight_ns(fmt::format("{}-{}-{}", year, month, day), "%Y-%m-%d");
  if (!midnight || hour > 23 || minute > 59 || second > 60) return std::nullopt;
  return *midnight +
         (hour * kSecondsPerHour + minute * int64_t{60} + second) * kNanosecondsPerSecond;
}

/// Of the fix type that NAV messages share.
UbxStatus::Kind ubx_kind(uint8_t fix_type, bool fix_is_ok) {
  if (!fix_is_ok) return UbxStatus::Kind::none;
  if (fix_type == 3) return UbxStatus::Kind::measured;
  if (fix_type == 4) return UbxStatus::Kind::fused;
  return UbxStatus::Kind::none;  // none, dead reckoning, without height, time only
}

FixQuality ubx_quality(unsigned carrier, bool differential) {
  if (carrier == 2) return FixQuality::fixed_rtk;
  if (carrier == 1) return FixQuality::float_rtk;
  return differential ? FixQuality::differential : FixQuality::single;
}

/// Upper triangle: north-north, north-east, north-down, east-east, east-down, down-down.
std::optional<Eigen::Matrix3d> ubx_covariance(RecordCursor& cursor) {
  Eigen::Matrix3d covariance;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) covariance(i, j) = covariance(j, i) = ubx_number<float>(cursor);
  }
  const bool positive = covariance.allFinite() && covariance.llt().info() == Eigen::Success;
  return positive ? std::optional(covariance) : std::nullopt;
}

// Messages, each behind its iTOW ------------------------------------------------------------------

void take_pvt(RecordCursor& cursor, UbxEpoch& epoch) {
  constexpr unsigned kDateAndTime = 3;
  std::optional<int64_t> utc_ns = ubx_utc(cursor);
  const auto valid = cursor.get<uint8_t>();
  cursor.skip(sizeof(uint32_t));  // accuracy of the time
  const auto nano = cursor.get<int32_t>();
  if (utc_ns && (valid & kDateAndTime) == kDateAndTime) epoch.utc_ns = *utc_ns + nano;
  const auto fix_type = cursor.get<uint8_t>();
  const auto flags = cursor.get<uint8_t>();
  cursor.skip(2);  // more flags, satellites
  UbxPosition position;
  position.place = ubx_place(cursor, kUbxMillimetre);
  position.horizontal = ubx_number<uint32_t>(cursor) * kUbxMillimetre;
  position.vertical = ubx_number<uint32_t>(cursor) * kUbxMillimetre;
  UbxVelocity velocity;
  velocity.velocity_n = ubx_vector<int32_t>(cursor) * kUbxMillimetre;
  cursor.skip(2 * sizeof(int32_t));  // along the ground, heading
  velocity.accuracy = ubx_number<uint32_t>(cursor) * kUbxMillimetre;
  cursor.skip(sizeof(uint32_t) + sizeof(uint16_t));  // accuracy of the heading, PDOP
  if ((cursor.get<uint8_t>() & 1U) != 0) epoch.position_invalid = true;
  epoch.standard = position;
  epoch.velocity = velocity;
  epoch.status =
      UbxStatus{ubx_kind(fix_type, (flags & 1U) != 0), ubx_quality(flags >> 6U, (flags & 2U) != 0)};
}

void take_posllh(RecordCursor& cursor, UbxEpoch& epoch) {
  UbxPosition position;
  position.place = ubx_place(cursor, kUbxMillimetre);
  position.horizontal = ubx_number<uint32_t>(cursor) * kUbxMillimetre;
  position.vertical = ubx_number<uint32_t>(cursor) * kUbxMillimetre;
  if (!epoch.standard) epoch.standard = position;
}

void take_velned(RecordCursor& cursor, UbxEpoch& epoch) {
  UbxVelocity velocity;
  velocity.velocity_n = ubx_vector<int32_t>(cursor) * kUbxCentimetre;
  cursor.skip(3 * sizeof(int32_t));  // speed, along the ground, heading
  velocity.accuracy = ubx_number<uint32_t>(cursor) * kUbxCentimetre;
  if (!epoch.velocity) epoch.velocity = velocity;
}

/// Its head, version to iTOW, is read.
void take_hpposllh(RecordCursor& cursor, UbxEpoch& epoch) {
  UbxPosition position;
  position.place = ubx_place(cursor, kUbxMillimetre);
  position.place.longitude += ubx_number<int8_t>(cursor) * kUbxFineAngle;
  position.place.latitude += ubx_number<int8_t>(cursor) * kUbxFineAngle;
  position.place.height += ubx_number<int8_t>(cursor) * kUbxTenthMillimetre;
  cursor.skip(sizeof(int8_t));
  position.horizontal = ubx_number<uint32_t>(cursor) * kUbxTenthMillimetre;
  position.vertical = ubx_number<uint32_t>(cursor) * kUbxTenthMillimetre;
  epoch.precise = position;
}

void take_cov(RecordCursor& cursor, UbxEpoch& epoch) {
  constexpr size_t kReserved = 9;
  cursor.skip(1);  // version
  const bool position_is_valid = cursor.flag();
  const bool velocity_is_valid = cursor.flag();
  cursor.skip(kReserved);
  const std::optional<Eigen::Matrix3d> position = ubx_covariance(cursor);
  const std::optional<Eigen::Matrix3d> velocity = ubx_covariance(cursor);
  if (position_is_valid) epoch.position_covariance = position;
  if (velocity_is_valid) epoch.velocity_covariance = velocity;
}

/// The rover as the moving base sees it. Its head, version to iTOW, is read.
void take_relposned(RecordCursor& cursor, UbxEpoch& epoch) {
  constexpr double kHeadingStep = 1e-5 * kDegree;
  constexpr unsigned kValid = 0x105, kCarrier = 0x18, kFixed = 0x10, kMovingBase = 0x20;
  constexpr size_t kParts = 4;  // north, east, down, length
  cursor.skip(kParts * sizeof(int32_t));
  const double heading = ubx_number<int32_t>(cursor) * kHeadingStep;
  cursor.skip(sizeof(int32_t) + kParts * sizeof(int8_t) + kParts * sizeof(uint32_t));
  const double accuracy = ubx_number<uint32_t>(cursor) * kHeadingStep;
  cursor.skip(sizeof(int32_t));
  const auto flags = cursor.get<uint32_t>();
  const bool valid = (flags & kValid) == kValid && (flags & kCarrier) == kFixed;
  if (!valid || (flags & kMovingBase) == 0 || !(accuracy > 0)) return;
  epoch.heading = GnssHeading{so3::wrap(heading), accuracy};
}

/// Week and nanoseconds beside an iTOW.
std::optional<GpsTime> ubx_gps_time(int64_t tow_ms, int week, int32_t nano) {
  const int64_t tow_ns = tow_ms * kUbxMillisecond + nano;
  if (week <= 0 || tow_ns < 0 || tow_ns >= kNanosecondsPerWeek) return std::nullopt;
  return GpsTime{week, tow_ns};
}

void take_sol(RecordCursor& cursor, UbxEpoch& epoch) {
  constexpr unsigned kWeekAndTime = 0xc;
  const auto nano = cursor.get<int32_t>();
  const auto week = cursor.get<int16_t>();
  const auto fix_type = cursor.get<uint8_t>();
  const auto flags = cursor.get<uint8_t>();
  if ((flags & kWeekAndTime) == kWeekAndTime && !epoch.gps) {
    epoch.gps = ubx_gps_time(epoch.tow_ms, week, nano);
  }
  const Eigen::Vector3d p_e = ubx_vector<int32_t>(cursor) * kUbxCentimetre;
  const double accuracy = ubx_number<uint32_t>(cursor) * kUbxCentimetre;
  const Eigen::Vector3d v_e = ubx_vector<int32_t>(cursor) * kUbxCentimetre;
  const double speed_accuracy = ubx_number<uint32_t>(cursor) * kUbxCentimetre;
  if (!epoch.status) {
    epoch.status =
        UbxStatus{ubx_kind(fix_type, (flags & 1U) != 0), ubx_quality(0, (flags & 2U) != 0)};
  }
  constexpr double kEarth = 6e6;
  if (p_e.norm() < kEarth) return;
  const Geodetic place = geodesy::wgs84::ecef_to_geodetic(p_e);
  epoch.ecef = UbxPosition{place, accuracy, accuracy};
  const Eigen::Matrix3d R_e_n = geodesy::wgs84::R_e_n(place.latitude, place.longitude);
  epoch.ecef_velocity = UbxVelocity{R_e_n.transpose() * v_e, speed_accuracy};
}

void take_status(RecordCursor& cursor, UbxEpoch& epoch) {
  const auto fix_type = cursor.get<uint8_t>();
  const auto flags = cursor.get<uint8_t>();
  if (epoch.status) return;
  epoch.status =
      UbxStatus{ubx_kind(fix_type, (flags & 1U) != 0), ubx_quality(0, (flags & 2U) != 0)};
}

void take_timegps(RecordCursor& cursor, UbxEpoch& epoch) {
  constexpr unsigned kTimeAndWeek = 3;
  const auto nano = cursor.get<int32_t>();
  const auto week = cursor.get<int16_t>();
  cursor.skip(1);  // leap seconds
  if ((cursor.get<uint8_t>() & kTimeAndWeek) == kTimeAndWeek) {
    epoch.gps = ubx_gps_time(epoch.tow_ms, week, nano);
  }
}

void take_timeutc(RecordCursor& cursor, UbxEpoch& epoch) {
  constexpr unsigned kUtc = 4;
  cursor.skip(sizeof(uint32_t));  // accuracy
  const auto nano = cursor.get<int32_t>();
  const std::optional<int64_t> utc_ns = ubx_utc(cursor);
  const bool valid = (cursor.get<uint8_t>() & kUtc) != 0;
  if (utc_ns && valid && !epoch.utc_ns) epoch.utc_ns = *utc_ns + nano;
}

/// What is read of class NAV, and how many bytes come before its iTOW.
struct UbxReading {
  uint16_t key;
  size_t head;
  void (*take)(RecordCursor& cursor, UbxEpoch& epoch);
};
constexpr uint16_t kHpposllh = 0x0114, kRelposned = 0x013c;
constexpr std::array<UbxReading, 10> kUbxReadings{{{0x0107, 0, take_pvt},
                                                   {kHpposllh, 4, take_hpposllh},
                                                   {kRelposned, 4, take_relposned},
                                                   {0x0136, 0, take_cov},
                                                   {0x0102, 0, take_posllh},
                                                   {0x0112, 0, take_velned},
                                                   {0x0106, 0, take_sol},
                                                   {0x0103, 0, take_status},
                                                   {0x0120, 0, take_timegps},
                                                   {0x0121, 0, take_timeutc}}};

const UbxReading* ubx_reading(uint16_t key) {
  for (const UbxReading& reading : kUbxReadings) {
    if (reading.key == key) return &reading;
  }
  return nullptr;
}

}  // namespace

std::optional<UbxEpoch> UbxEpochs::next() {
  while (!finished_) {
    const std::optional<UbxMessage> message = file_.next();
    if (!message) {
      finished_.swap(current_);
      break;
    }
    try {
      take(*message);
    } catch (const RecordTooShort&) {
      file_.place().fail(fmt::format(
          "a NAV message (class and id 0x{:04x}) of {} bytes, too few for its kind; the "
          "recording is damaged here",
          message->key(), message->payload.size()));
    }
  }
  return std::exchange(finished_, std::nullopt);
}

void UbxEpochs::take(const UbxMessage& message) {
  constexpr int64_t kMillisecondsPerWeek = int64_t{kSecondsPerWeek} * 1000;
  const UbxReading* reading = ubx_reading(message.key());
  if (reading == nullptr) return;
  RecordCursor cursor(message.payload);
  const unsigned char* const head = cursor.take(reading->head);
  const int64_t tow_ms = cursor.get<uint32_t>();
  if (tow_ms >= kMillisecondsPerWeek) {
    file_.place().fail(fmt::format("an iTOW of {} ms lies outside its week", tow_ms));
  }
  if (!current_ || current_->tow_ms != tow_ms) {
    finished_ = std::exchange(current_, UbxEpoch{});
    current_->byte = file_.file().position();
    current_->tow_ms = tow_ms;
  }
  // The head of HPPOSLLH ends with its flags; RELPOSNED of version 0 has no heading.
  const bool invalid = (message.key() == kHpposllh && (head[3] & 1U) != 0) ||
                       (message.key() == kRelposned && head[0] == 0);
  if (!invalid) reading->take(cursor, *current_);
}

}  // namespace foucault::rawlog
