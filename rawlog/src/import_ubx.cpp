#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <utility>

#include "boot_clock.h"
#include "csv_readers.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "raw_gnss.h"
#include "record_cursor.h"
#include "ubx_epochs.h"
#include "ubx_imu.h"

namespace foucault::rawlog {

namespace {

constexpr int64_t kUbxMillisecondNs = 1'000'000;

/// UTC stamps of times of week, whatever the receiver takes for leap seconds.
class UbxCalendar {
 public:
  explicit UbxCalendar(int64_t near_ns) : near_ns_(near_ns) {}

  /// Of an epoch, which tells the date of those that follow.
  int64_t stamp_of(const UbxEpoch& epoch) {
    if (epoch.gps) return near_ns_ = gps_to_unix_ns(*epoch.gps);
    if (epoch.utc_ns) near_ns_ = *epoch.utc_ns;
    const int64_t stamp_ns = stamp_of(epoch.tow_ms);
    near_ns_ = stamp_ns + (epoch.utc_ns ? below_second(*epoch.utc_ns - stamp_ns) : 0);
    return near_ns_;
  }

  /// Of the week that brings it nearest to the last one.
  int64_t stamp_of(int64_t tow_ms) const {
    const int64_t tow_ns = tow_ms * kUbxMillisecondNs;
    GpsTime near = unix_to_gps(near_ns_);
    if (near.tow_ns - tow_ns > kNanosecondsPerWeek / 2) ++near.week;
    if (tow_ns - near.tow_ns > kNanosecondsPerWeek / 2) --near.week;
    return gps_to_unix_ns({near.week, tow_ns});
  }

 private:
  /// iTOW is rounded to milliseconds; UTC tells the rest, and differs by whole seconds until the
  /// receiver knows the leap seconds.
  static int64_t below_second(int64_t difference_ns) {
    constexpr int64_t kMost = 2 * kUbxMillisecondNs;
    const int64_t seconds = std::llround(static_cast<double>(difference_ns) / 1e9);
    const int64_t rest_ns = difference_ns - seconds * kNanosecondsPerSecond;
    return std::abs(rest_ns) <= kMost ? rest_ns : 0;
  }

  int64_t near_ns_;
};

bool has_position(const UbxEpoch& epoch) {
  const bool denied = epoch.status && epoch.status->kind == UbxStatus::Kind::none;
  return epoch.position() != nullptr && !denied;
}

/// What there is in a recording, before its records are taken.
struct UbxSurvey {
  explicit UbxSurvey(const std::string& path);

  int64_t fixes = 0;
  std::optional<int64_t> dated_ns;  ///< the first
  bool raw_observations = false;
  int64_t esf_raw = 0, esf_meas = 0;  ///< messages
};

UbxSurvey::UbxSurvey(const std::string& path) {
  UbxFile file(path);
  while (const std::optional<UbxMessage> message = file.next()) {
    constexpr uint16_t kRawx = 0x0215;
    constexpr uint16_t kRaw = 0x0210;
    raw_observations |= message->key() == kRawx || message->key() == kRaw;
    esf_raw += message->key() == kUbxEsfRaw ? 1 : 0;
    esf_meas += message->key() == kUbxEsfMeas ? 1 : 0;
  }
  if (file.messages() == 0) {
    throw DataError(fmt::format("'{}' has no UBX message; check the file", path));
  }
  UbxEpochs epochs(path);
  for (bool over = false; !over;) {
    try {
      const std::optional<UbxEpoch> epoch = epochs.next();
      over = !epoch;
      if (over) break;
      if (has_position(*epoch)) ++fixes;
      if (!dated_ns && epoch->gps) dated_ns = gps_to_unix_ns(*epoch->gps);
      if (!dated_ns) dated_ns = epoch->utc_ns;
    } catch (const RowError&) {  // comes again when the file is read
    }
  }
}

// GNSS --------------------------------------------------------------------------------------------

class UbxEpochPlace : public Place {
 public:
  UbxEpochPlace(const InputFile& file, int64_t byte) : file_(file), byte_(byte) {}

 private:
  std::string where() const override { return file_.place(byte_); }

  const InputFile& file_;
  int64_t byte_;
};

class UbxGnss : public RecordReader {
 public:
  UbxGnss(const GnssMapping& mapping, const std::string& path, int64_t dated_ns)
      : epochs_(path),
        velocity_(mapping.velocity),
        offset_ns_(nanoseconds(mapping.time.offset_s)),
        calendar_(dated_ns) {}

  const InputFile& table() const override { return epochs_.file().file(); }
  int64_t without_fix() const override { return without_fix_; }

  std::optional<Record> next() override {
    while (const std::optional<UbxEpoch> epoch = epochs_.next()) {
      const int64_t stamp_ns = calendar_.stamp_of(*epoch);
      if (has_position(*epoch)) return fix_of(*epoch, stamp_ns);
      if (epoch->status || epoch->position()) ++without_fix_;
    }
    return std::nullopt;
  }

  std::vector<std::string> notices() const override {
    std::vector<std::string> found = epochs_.file().notices();
    if (fused_ > 0) {
      found.push_back(fmt::format(
          "{}: {} fixes are fused with the receiver's own inertial sensors (fix type 4): smooth "
          "and late, and of the point the receiver was told; raw observations with --base are "
          "better",
          table().path(), fused_));
    }
    return found;
  }

 private:
  GnssFix fix_of(const UbxEpoch& epoch, int64_t stamp_ns) {
    const UbxEpochPlace place(table(), epoch.byte);
    const UbxPosition& position = *epoch.position();
    GnssFix fix;
    if (epoch.status) fix.quality = epoch.status->quality;
    fix.antenna = checked_position(place, position.place.latitude, position.place.longitude,
                                   position.place.height);
    fix.position_covariance = covariance_of(epoch, position, place);
    if (velocity_) add_velocity(epoch, fix);
    fix.heading = epoch.heading;
    fix.t_ns = checked_stamp(place, stamp_ns + offset_ns_);
    order_.check(place, fix.t_ns);
    if (epoch.status && epoch.status->kind == UbxStatus::Kind::fused) ++fused_;
    return fix;
  }

  static Eigen::Matrix3d covariance_of(const UbxEpoch& epoch, const UbxPosition& position,
                                       const Place& place) {
    constexpr double kLargest = 1e5;  // [m]
    if (epoch.position_covariance) return *epoch.position_covariance;
    for (const double sigma : {position.horizontal, position.vertical}) {
      if (sigma > 0 && sigma < kLargest) continue;
      place.fail(fmt::format("a fix with an accuracy (hAcc, vAcc) of {} m", sigma));
    }
    const double horizontal = position.horizontal / std::sqrt(2.0);
    return Eigen::Vector3d(horizontal, horizontal, position.vertical).cwiseAbs2().asDiagonal();
  }

  static void add_velocity(const UbxEpoch& epoch, GnssFix& fix) {
    constexpr double kLargest = 1e3;  // [m/s]
    const UbxVelocity* speed = epoch.speed();
    if (speed == nullptr) return;
    const bool told = speed->accuracy > 0 && speed->accuracy < kLargest;
    if (!epoch.velocity_covariance && !told) return;
    fix.velocity_n = speed->velocity_n;
    const double horizontal = speed->accuracy / std::sqrt(2.0);
    fix.velocity_covariance = epoch.velocity_covariance.value_or(
        Eigen::Vector3d(horizontal, horizontal, speed->accuracy).cwiseAbs2().asDiagonal());
  }

  UbxEpochs epochs_;
  bool velocity_;
  int64_t offset_ns_;
  UbxCalendar calendar_;
  StampOrder order_;
  int64_t without_fix_ = 0;
  int64_t fused_ = 0;
};

// IMU ---------------------------------------------------------------------------------------------

constexpr uint16_t kNavStatus = 0x0103;

/// iTOW of what a receiver sends of an epoch [ms], where it is what comes first.
std::optional<int64_t> tow_of(const UbxMessage& message) {
  constexpr std::array<uint16_t, 11> kTimed{0x0101, 0x0102, kNavStatus, 0x0106, 0x0107, 0x0111,
                                            0x0112, 0x0120, 0x0121,     0x1010, 0x2800};
  constexpr int64_t kMillisecondsPerWeek = int64_t{kSecondsPerWeek} * 1000;
  if (std::find(kTimed.begin(), kTimed.end(), message.key()) == kTimed.end()) return std::nullopt;
  const int64_t tow_ms = RecordCursor(message.payload).get<uint32_t>();
  return tow_ms < kMillisecondsPerWeek ? std::optional(tow_ms) : std::nullopt;
}

/// Ties of the receiver's clock since power-up to UTC.
class UbxClockTies {
 public:
  explicit UbxClockTies(int64_t dated_ns) : calendar_(dated_ns) {}

  void take(const UbxMessage& message, std::optional<int64_t> sampled_us) {
    constexpr size_t kToClock = 8;
    const std::optional<int64_t> tow_ms = tow_of(message);
    if (!tow_ms) return;
    const int64_t utc_us = calendar_.stamp_of(*tow_ms) / kNanosecondsPerMicrosecond;
    if (message.key() == kNavStatus) {
      RecordCursor cursor(message.payload);
      cursor.skip(sizeof(uint32_t) + kToClock);
      told_.push_back({int64_t{cursor.get<uint32_t>()} * 1000, utc_us});
    }
    // Of all that come of an epoch the first is least late.
    if (sampled_us && (!newest_us_ || utc_us > *newest_us_)) {
      newest_us_ = utc_us;
      by_order_.push_back({*sampled_us, utc_us});
    }
  }

  bool told() const { return !told_.empty(); }
  bool any() const { return told() || !by_order_.empty(); }
  BootClock clock() const { return BootClock(told() ? told_ : by_order_); }

 private:
  UbxCalendar calendar_;
  std::optional<int64_t> newest_us_;
  std::vector<FixTime> told_;
  std::vector<FixTime> by_order_;
};

class UbxImu : public RecordReader {
 public:
  UbxImu(const std::string& path, uint16_t key, int64_t dated_ns)
      : file_(path), means_(key == kUbxEsfMeas), samples_(key) {
    tie(path, dated_ns);
  }

  const InputFile& table() const override { return file_.file(); }

  std::optional<Record> next() override {
    while (ready_.empty()) {
      if (const std::optional<UbxImuSample> sample = samples_.next()) {
        put(*sample);
        continue;
      }
      const std::optional<UbxMessage> message = file_.next();
      if (!message) return std::nullopt;
      take(*message);
    }
    const ImuIncrement increment = ready_.front();
    ready_.pop_front();
    return increment;
  }

  std::vector<std::string> notices() const override {
    std::vector<std::string> found;
    if (!told_) {
      found.push_back(fmt::format(
          "{}: no NAV-STATUS: the IMU's clock is tied to GPS time by the order of messages, some "
          "tenths of a second may be left (estimated as the time offset); switch NAV-STATUS on",
          table().path()));
    }
    if (means_) {
      found.push_back(
          fmt::format("{}: the IMU is ESF-MEAS, means over some 0.1 s; switch ESF-RAW on if the "
                      "receiver has it",
                      table().path()));
    }
    return found;
  }

 private:
  void take(const UbxMessage& message) {
    try {
      samples_.take(message);
    } catch (const RecordTooShort&) {
      file_.place().fail(fmt::format(
          "an ESF message of {} bytes, too few for its kind; the recording is damaged here",
          message.payload.size()));
    }
  }

  /// The first sample is as long as the second.
  void put(const UbxImuSample& sample) {
    const int64_t t_ns = checked_stamp(file_.place(), clock_.utc_ns(sample.boot_us));
    order_.check(file_.place(), t_ns);
    const std::optional<int64_t> interval_ns = intervals_.ending_at(t_ns);
    if (!interval_ns) {
      first_ = sample;
      return;
    }
    if (first_) {
      ready_.push_back(increment_of(*first_, clock_.utc_ns(first_->boot_us), *interval_ns));
    }
    first_.reset();
    ready_.push_back(increment_of(sample, t_ns, *interval_ns));
  }

  void tie(const std::string& path, int64_t dated_ns) {
    UbxFile first(path);
    while (const std::optional<UbxMessage> message = first.next()) {
      try {
        samples_.survey(*message);
      } catch (const RecordTooShort&) {  // told when the file is read
      }
    }
    samples_.restart();
    UbxImuSamples samples = samples_;
    UbxClockTies ties(dated_ns);
    std::optional<int64_t> sampled_us;
    UbxFile second(path);
    while (const std::optional<UbxMessage> message = second.next()) {
      try {
        samples.take(*message);
        while (const auto sample = samples.next()) sampled_us = sample->boot_us;
        ties.take(*message, sampled_us);
      } catch (const RecordTooShort&) {
      }
    }
    if (!ties.any()) {
      throw DataError(fmt::format(
          "'{}' has an IMU (ESF) and no message with GPS time (NAV); switch NAV-PVT on", path));
    }
    clock_ = ties.clock();
    told_ = ties.told();
  }

  /// Means stand in the middle of their interval.
  ImuIncrement increment_of(const UbxImuSample& sample, int64_t t_ns, int64_t interval_ns) const {
    ImuIncrement increment;
    increment.t_end_ns = means_ ? t_ns + interval_ns / 2 : t_ns;
    increment.t_begin_ns = increment.t_end_ns - interval_ns;
    increment.dtheta_b = sample.gyro * increment.dt();
    increment.dvel_b = sample.accel * increment.dt();
    return increment;
  }

  UbxFile file_;
  bool means_;
  UbxImuSamples samples_;
  BootClock clock_;
  bool told_ = false;
  IntervalLengths intervals_;
  StampOrder order_;
  std::optional<UbxImuSample> first_;
  std::deque<ImuIncrement> ready_;
};

int64_t date_of(const UbxSurvey& survey, const std::string& path) {
  if (survey.dated_ns) return *survey.dated_ns;
  throw DataError(
      fmt::format("'{}' has no date (NAV-PVT, NAV-TIMEGPS, NAV-TIMEUTC or NAV-SOL with a valid "
                  "one); switch NAV-PVT on",
                  path));
}

/// The receiver's own IMU, where there is no table.
void add_own_imu(const UbxImport& options, const UbxSurvey& survey, ImportInputs& inputs) {
  constexpr int64_t kFew = 10;
  if (inputs.imu || std::max(survey.esf_raw, survey.esf_meas) < kFew) return;
  if (!options.lever_arm) {
    throw UsageError("the recording has an IMU; give --lever-arm X,Y,Z, from it to the antenna");
  }
  inputs.imu =
      std::make_unique<UbxImu>(options.rover, survey.esf_raw >= kFew ? kUbxEsfRaw : kUbxEsfMeas,
                               date_of(survey, options.rover));
  ImuMapping imu;
  imu.axes = options.imu_axes;
  naming_mapping("--imu-axes", [&] { inputs.mounting = imu.mounting(); });
}

}  // namespace

ImportSummary import_ubx(const UbxImport& options) {
  const UbxSurvey survey(options.rover);
  ImportInputs inputs;
  const ImportMapping mapping = add_tables({options.mapping, options.data_dir},
                                           {options.imu, options.reference, options.wheel}, inputs);
  if (options.lever_arm) inputs.lever_arm_v = options.lever_arm;
  add_own_imu(options, survey, inputs);
  if (options.base || (survey.fixes == 0 && survey.raw_observations)) {
    return import_raw_observations(options, std::move(inputs), mapping);
  }
  inputs.gnss =
      std::make_unique<UbxGnss>(mapping.gnss, options.rover, date_of(survey, options.rover));
  return run_import(options, std::move(inputs));
}

}  // namespace foucault::rawlog
