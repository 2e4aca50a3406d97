#include "ubx_imu.h"

#include <cmath>

#include "foucault/core/constants.h"
#include "record_cursor.h"

namespace foucault::rawlog {

namespace {

constexpr int64_t kUbxMillisecondUs = 1000;

struct UbxAxis {
  uint32_t type;
  bool gyro;
  int axis;
};
constexpr std::array<UbxAxis, 6> kUbxAxes{
    {{14, true, 0}, {13, true, 1}, {5, true, 2}, {16, false, 0}, {17, false, 1}, {18, false, 2}}};

/// The lower 24 bits, signed.
double signed_24(uint32_t word) {
  constexpr uint32_t kSign = 1U << 23U;
  const auto data = static_cast<int64_t>(word & ((kSign << 1U) - 1));
  return static_cast<double>((word & kSign) != 0 ? data - (int64_t{kSign} << 1U) : data);
}

}  // namespace

bool UbxAxes::take(uint32_t word) {
  constexpr double kGyroUnit = kDegree / 4096;  // 2^-12 deg/s
  constexpr double kAccelUnit = 1.0 / 1024;     // 2^-10 m/s^2
  constexpr uint32_t kTypes = 63;
  const uint32_t type = word >> 24U & kTypes;
  for (const UbxAxis& axis : kUbxAxes) {
    if (axis.type != type) continue;
    (axis.gyro ? gyro_ : accel_)[axis.axis] =
        signed_24(word) * (axis.gyro ? kGyroUnit : kAccelUnit);
    seen_ |= 1U << static_cast<unsigned>(axis.axis + (axis.gyro ? 0 : 3));
    return true;
  }
  return false;
}

// Ticks -------------------------------------------------------------------------------------------

int64_t UbxTags::unrolled(uint32_t tag) {
  constexpr uint32_t kMask = (1U << 24U) - 1;
  ticks_ += last_tag_ ? (tag - *last_tag_) & kMask : 0;
  last_tag_ = tag;
  return ticks_;
}

void UbxTags::survey(uint32_t clock_ms, uint32_t tag) {
  const bool first = !last_tag_;
  const int64_t ticks = unrolled(tag);
  const bool restarted = clock_ms < last_ms_;
  if (first || restarted) {
    first_ms_ = clock_ms;
    first_ticks_ = ticks;
  }
  last_ms_ = clock_ms;
  constexpr double kNominal = 39.0625;
  constexpr double kMostOff = 0.02;
  constexpr int64_t kLongEnough = 1000;  // [ms]
  if (last_ms_ - first_ms_ < kLongEnough) return;
  const double found = static_cast<double>((last_ms_ - first_ms_) * kUbxMillisecondUs) /
                       static_cast<double>(ticks - first_ticks_);
  if (std::abs(found / kNominal - 1) < kMostOff) tick_us_ = found;
}

void UbxTags::restart() {
  last_tag_.reset();
  ticks_ = 0;
  offset_us_.reset();
}

void UbxTags::begin_message(uint32_t clock_ms, uint32_t tag) {
  constexpr double kSmoothing = 0.05;
  constexpr double kJump = 0.1e6;  // [us]
  const double ticks_us = static_cast<double>(unrolled(tag)) * tick_us_;
  if (clock_ms == 0) return;  // receivers that do not tell it
  const double now_us = static_cast<double>(int64_t{clock_ms} * kUbxMillisecondUs) - ticks_us;
  const bool jumps = !offset_us_ || std::abs(now_us - *offset_us_) > kJump;
  offset_us_ = jumps ? now_us : *offset_us_ + kSmoothing * (now_us - *offset_us_);
}

int64_t UbxTags::boot_us(uint32_t tag) {
  return std::llround(static_cast<double>(unrolled(tag)) * tick_us_ + offset_us_.value_or(0));
}

// Messages ----------------------------------------------------------------------------------------

void UbxImuSamples::survey(const UbxMessage& message) {
  if (key_ != kUbxEsfRaw || message.key() != key_) return;
  RecordCursor cursor(message.payload);
  const auto clock_ms = cursor.get<uint32_t>();
  cursor.skip(sizeof(uint32_t));
  tags_.survey(clock_ms, cursor.get<uint32_t>());
}

void UbxImuSamples::take(const UbxMessage& message) {
  if (message.key() != key_) return;
  if (key_ == kUbxEsfRaw) return take_raw(message);
  take_meas(message);
}

std::optional<UbxImuSample> UbxImuSamples::next() {
  if (ready_.empty()) return std::nullopt;
  const UbxImuSample sample = ready_.front();
  ready_.pop_front();
  return sample;
}

/// The clock, then words of data, each with its tag.
void UbxImuSamples::take_raw(const UbxMessage& message) {
  RecordCursor cursor(message.payload);
  const auto clock_ms = cursor.get<uint32_t>();
  std::optional<uint32_t> sample_tag;
  while (cursor.position() + 2 * sizeof(uint32_t) <= message.payload.size()) {
    const auto word = cursor.get<uint32_t>();
    const auto tag = cursor.get<uint32_t>();
    if (!sample_tag) tags_.begin_message(clock_ms, tag);
    if (sample_tag != tag) axes_.clear();
    sample_tag = tag;
    if (!axes_.take(word) || !axes_.complete()) continue;
    ready_.push_back({tags_.boot_us(tag), axes_.gyro(), axes_.accel()});
    axes_.clear();
  }
}

/// Clock, flags, then words of data; gyroscope and accelerometer mostly come in two messages.
void UbxImuSamples::take_meas(const UbxMessage& message) {
  constexpr int64_t kTogether = 30'000;  // [us]
  constexpr unsigned kCalibrated = 8;
  RecordCursor cursor(message.payload);
  const int64_t boot_us = cursor.get<uint32_t>() * kUbxMillisecondUs;
  const auto flags = cursor.get<uint16_t>();
  cursor.skip(sizeof(uint16_t));  // who provides it
  size_t words = (message.payload.size() - cursor.position()) / sizeof(uint32_t);
  if ((flags & kCalibrated) != 0 && words > 0) --words;  // the last one is a time
  const bool other_is_old =
      std::abs(boot_us - (axes_.has_gyro() ? gyro_us_ : accel_us_)) > kTogether;
  UbxAxes found = other_is_old ? UbxAxes{} : axes_;
  bool any = false;
  for (size_t i = 0; i < words; ++i) any = found.take(cursor.get<uint32_t>()) || any;
  if (!any) return;  // wheel ticks, temperature
  if (!axes_.has_gyro() || other_is_old) gyro_us_ = boot_us;
  if (!axes_.has_accel() || other_is_old) accel_us_ = boot_us;
  axes_ = found;
  if (!axes_.complete()) return;
  ready_.push_back({(gyro_us_ + accel_us_) / 2, axes_.gyro(), axes_.accel()});
  axes_ = UbxAxes{};
}

}  // namespace foucault::rawlog
