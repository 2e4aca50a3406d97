#include "foucault/rawlog/import_ulog.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <utility>
#include <vector>

#include "boot_clock.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "import_run.h"
#include "nmea_accuracy.h"
#include "ulog_file.h"

namespace foucault::rawlog {

namespace {

constexpr double kMicrosecond = 1e-6;
constexpr int64_t kLongestUptime = 1'000'000'000'000'000;  ///< [us]

/// A field with what its numbers are to be multiplied by.
struct Quantity {
  UlogField field;
  double scale = 1;

  double of(const UlogMessage& message, size_t index = 0) const {
    return message.finite(field, index) * scale;
  }
  Eigen::Vector3d vector(const UlogMessage& message) const {
    return {of(message, 0), of(message, 1), of(message, 2)};
  }
};

/// The first field that is there.
std::optional<Quantity> quantity(const UlogFields& fields,
                                 std::initializer_list<std::pair<const char*, double>> names) {
  for (const auto& [name, scale] : names) {
    const auto found = fields.find(name);
    if (found != fields.end()) return Quantity{found->second, scale};
  }
  return std::nullopt;
}

int64_t microseconds(const UlogMessage& message, const UlogField& field) {
  const int64_t value = message.integer(field);
  if (std::abs(value) > kLongestUptime) {
    message.place().fail(fmt::format("a time of {} us cannot be; the file is damaged here", value));
  }
  return value;
}

// IMU -------------------------------------------------------------------------------------------

/// Where an IMU topic has its values.
struct ImuFields {
  UlogField time;
  Quantity gyro, accel, gyro_dt, accel_dt;
  bool means = false;  ///< rates, else increments

  static std::optional<ImuFields> of(const UlogFields& fields);
};

/// Early logs have intervals in seconds, as float.
std::optional<Quantity> interval(const UlogFields& fields, const char* name) {
  std::optional<Quantity> found = quantity(fields, {{name, kMicrosecond}});
  if (found && found->field.type == "float") found->scale = 1;
  return found;
}

std::optional<ImuFields> ImuFields::of(const UlogFields& fields) {
  const bool means = fields.count("gyro_rad") > 0;
  const auto time = quantity(fields, {{"timestamp_sample", 1}, {"timestamp", 1}});
  const auto gyro = quantity(fields, {{"gyro_rad", 1}, {"delta_angle", 1}});
  const auto accel = quantity(fields, {{"accelerometer_m_s2", 1}, {"delta_velocity", 1}});
  const auto gyro_dt = interval(fields, means ? "gyro_integral_dt" : "delta_angle_dt");
  const auto accel_dt = interval(fields, means ? "accelerometer_integral_dt" : "delta_velocity_dt");
  if (!time || !gyro || !accel || !gyro_dt || !accel_dt) return std::nullopt;
  return ImuFields{time->field, *gyro, *accel, *gyro_dt, *accel_dt, means};
}

/// An IMU message on the clock since boot.
struct BootIncrement {
  int64_t t_us = 0;  ///< its end
  double dt = 0;     ///< [s]
  Eigen::Vector3d dtheta = Eigen::Vector3d::Zero();
  Eigen::Vector3d dvel = Eigen::Vector3d::Zero();
};

BootIncrement increment_of(const ImuFields& fields, const UlogMessage& message) {
  constexpr double kShortest = kMicrosecond;
  constexpr double kLongest = 10;  // [s]
  BootIncrement increment;
  increment.t_us = microseconds(message, fields.time);
  increment.dt = fields.gyro_dt.of(message);
  const double accel_dt = fields.accel_dt.of(message);
  for (const double dt : {increment.dt, accel_dt}) {
    if (dt >= kShortest && dt < kLongest) continue;
    message.place().fail(
        fmt::format("topic {}: a sample over {:.6g} s cannot be", message.topic().name, dt));
  }
  const double to_increment = fields.means ? increment.dt : 1;
  increment.dtheta = fields.gyro.vector(message) * to_increment;
  increment.dvel =
      fields.accel.vector(message) * (fields.means ? increment.dt : increment.dt / accel_dt);
  return increment;
}

// GNSS ------------------------------------------------------------------------------------------

/// Where a GNSS topic has its values; names and units changed with PX4 1.14.
struct GnssFields {
  UlogField time, fix_type;
  Quantity latitude, longitude, msl, eph, epv;
  std::optional<Quantity> ellipsoidal, utc, time_relative, velocity_sigma, velocity_valid;
  std::optional<Quantity> heading, heading_sigma;
  std::array<std::optional<Quantity>, 3> velocity;

  static std::optional<GnssFields> of(const UlogFields& fields);
};

std::optional<GnssFields> GnssFields::of(const UlogFields& fields) {
  constexpr double kOld = 1e-7 * kDegree;
  constexpr double kMillimetre = 1e-3;
  const auto time = quantity(fields, {{"timestamp", 1}});
  const auto fix_type = quantity(fields, {{"fix_type", 1}});
  const auto latitude = quantity(fields, {{"latitude_deg", kDegree}, {"lat", kOld}});
  const auto longitude = quantity(fields, {{"longitude_deg", kDegree}, {"lon", kOld}});
  const auto msl = quantity(fields, {{"altitude_msl_m", 1}, {"alt", kMillimetre}});
  const auto eph = quantity(fields, {{"eph", 1}});
  const auto epv = quantity(fields, {{"epv", 1}});
  if (!time || !fix_type || !latitude || !longitude || !msl || !eph || !epv) return std::nullopt;
  GnssFields found;
  found.time = time->field;
  found.fix_type = fix_type->field;
  found.latitude = *latitude;
  found.longitude = *longitude;
  found.msl = *msl;
  found.eph = *eph;
  found.epv = *epv;
  found.ellipsoidal =
      quantity(fields, {{"altitude_ellipsoid_m", 1}, {"alt_ellipsoid", kMillimetre}});
  found.utc = quantity(fields, {{"time_utc_usec", 1}});
  found.time_relative = quantity(fields, {{"timestamp_time_relative", 1}});
  found.velocity_sigma = quantity(fields, {{"s_variance_m_s", 1}});
  found.velocity_valid = quantity(fields, {{"vel_ned_valid", 1}});
  found.heading = quantity(fields, {{"heading", 1}});
  found.heading_sigma = quantity(fields, {{"heading_accuracy", 1}});
  found.velocity = {quantity(fields, {{"vel_n_m_s", 1}}), quantity(fields, {{"vel_e_m_s", 1}}),
                    quantity(fields, {{"vel_d_m_s", 1}})};
  return found;
}

/// None where there is no position of three dimensions that was measured.
std::optional<FixQuality> quality_of(const GnssFields& fields, const UlogMessage& message) {
  switch (message.integer(fields.fix_type)) {
    case 3:
      return FixQuality::single;
    case 4:
      return FixQuality::differential;
    case 5:
      return FixQuality::float_rtk;
    case 6:
      return FixQuality::fixed_rtk;
    default:  // 0, 1: none; 2: without height; 8: extrapolated
      return std::nullopt;
  }
}

FixTime time_of(const GnssFields& fields, const UlogMessage& message) {
  constexpr int64_t kYear2000 = 946'684'800'000'000;
  constexpr int64_t kYear2096 = 3'976'214'400'000'000;
  FixTime time{microseconds(message, fields.time), {}};
  if (fields.time_relative) time.boot_us += microseconds(message, fields.time_relative->field);
  if (!fields.utc) return time;
  const int64_t utc_us = message.integer(fields.utc->field);
  if (utc_us > kYear2000 && utc_us < kYear2096) time.utc_us = utc_us;
  return time;
}

// Survey ----------------------------------------------------------------------------------------

/// A topic and which of its sensors.
using Stream = std::pair<std::string, int>;

/// What there is of a stream.
struct Amount {
  int64_t messages = 0;
  int64_t first_us = 0;
  int64_t last_us = 0;
  double covered = 0;  ///< by the intervals of samples [s]
  std::vector<FixTime> fixes;

  /// Part of its time that the samples cover.
  double coverage() const {
    const double length = static_cast<double>(last_us - first_us) * kMicrosecond;
    return length > 0 ? covered / length : 0;
  }
};

const std::array<const char*, 2> kImuTopics{"vehicle_imu", "sensor_combined"};
const std::array<const char*, 2> kGnssTopics{"vehicle_gps_position", "sensor_gps"};

bool is_one_of(const std::array<const char*, 2>& topics, const std::string& name) {
  return name == topics[0] || name == topics[1];
}

/// What there is in a log, before its records are taken.
class Survey {
 public:
  explicit Survey(const std::string& path);

  Stream imu() const;
  Stream gnss() const;
  BootClock clock() const { return BootClock(gnss_.at(gnss()).fixes); }
  /// IMU to antenna, of the parameters.
  std::optional<Eigen::Vector3d> lever_arm() const;

 private:
  void take(const UlogMessage& message);
  void count(Amount& amount, int64_t t_us);

  std::string path_;
  std::map<Stream, Amount> imu_, gnss_;
  std::map<std::string, double> parameters_;
};

Survey::Survey(const std::string& path) : path_(path) {
  UlogFile file(path);
  bool over = false;
  while (!over) {
    try {
      const std::optional<UlogMessage> message = file.next();
      over = !message;
      if (message) take(*message);
    } catch (const RowError&) {  // told by the readers
    }
  }
  parameters_ = file.parameters();
}

void Survey::take(const UlogMessage& message) {
  const UlogTopic& topic = message.topic();
  const Stream stream{topic.name, topic.instance};
  if (is_one_of(kImuTopics, topic.name)) {
    const auto fields = ImuFields::of(topic.fields);
    if (!fields) return;
    const BootIncrement increment = increment_of(*fields, message);
    Amount& amount = imu_[stream];
    count(amount, increment.t_us);
    if (amount.messages > 1) amount.covered += increment.dt;
  } else if (is_one_of(kGnssTopics, topic.name)) {
    const auto fields = GnssFields::of(topic.fields);
    if (!fields) return;
    const FixTime time = time_of(*fields, message);
    Amount& amount = gnss_[stream];
    count(amount, time.boot_us);
    const bool repeated = !amount.fixes.empty() && amount.fixes.back().utc_us == time.utc_us;
    if (time.utc_us && !repeated && quality_of(*fields, message)) amount.fixes.push_back(time);
  }
}

void Survey::count(Amount& amount, int64_t t_us) {
  if (amount.messages++ == 0) amount.first_us = t_us;
  amount.last_us = t_us;
}

/// The loggers of PX4 thin out vehicle_imu unless told otherwise.
Stream Survey::imu() const {
  constexpr double kEnough = 0.9;
  constexpr double kSome = 0.5;
  const Stream* best = nullptr;
  for (const char* topic : kImuTopics) {
    for (const auto& [stream, amount] : imu_) {
      if (stream.first != topic) continue;
      if (amount.coverage() > kEnough) return stream;
      if (best == nullptr || amount.coverage() > imu_.at(*best).coverage()) best = &stream;
    }
  }
  if (best == nullptr) {
    throw DataError(
        fmt::format("'{}' has neither vehicle_imu nor sensor_combined; choose a logging "
                    "profile of PX4 with one of them (SDLOG_PROFILE)",
                    path_));
  }
  const double coverage = imu_.at(*best).coverage();
  if (coverage > kSome) return *best;
  throw DataError(
      fmt::format("'{}': the IMU was logged for {:.2g} % of the time only (topic {}); "
                  "choose a logging profile of PX4 with a high rate (SDLOG_PROFILE)",
                  path_, 100 * coverage, best->first));
}

/// The first that is not a thinned out one.
Stream Survey::gnss() const {
  int64_t most = 0;
  for (const auto& [stream, amount] : gnss_) most = std::max(most, amount.messages);
  for (const char* topic : kGnssTopics) {
    for (const auto& [stream, amount] : gnss_) {
      if (stream.first == topic && 2 * amount.messages >= most) return stream;
    }
  }
  throw DataError(
      fmt::format("'{}' has neither vehicle_gps_position nor sensor_gps with the fields "
                  "that are needed; log one of them",
                  path_));
}

std::optional<Eigen::Vector3d> Survey::lever_arm() const {
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();
  const std::array<const char*, 3> axes{"X", "Y", "Z"};
  for (size_t i = 0; i < axes.size(); ++i) {
    const auto antenna = parameters_.find(fmt::format("EKF2_GPS_POS_{}", axes[i]));
    const auto imu = parameters_.find(fmt::format("EKF2_IMU_POS_{}", axes[i]));
    if (antenna == parameters_.end()) return std::nullopt;
    arm[static_cast<int>(i)] = antenna->second - (imu == parameters_.end() ? 0 : imu->second);
  }
  if (arm.isZero() || !arm.allFinite()) return std::nullopt;  // zero is PX4's default
  return arm;
}

// Readers ---------------------------------------------------------------------------------------

/// The messages of one stream.
class UlogReader : public RecordReader {
 public:
  UlogReader(const std::string& path, Stream stream, const BootClock& clock)
      : file_(path), stream_(std::move(stream)), clock_(clock) {}

  const InputFile& table() const override { return file_.file(); }

 protected:
  /// One of the two readers of a log tells it.
  std::vector<std::string> damage() const {
    if (file_.unreadable() == 0) return {};
    return {
        fmt::format("{}: {} bytes are no messages of a ULog and were left out, with what they "
                    "were; the file is damaged there, copy it again",
                    file_.file().place(file_.first_unreadable()), file_.unreadable())};
  }

  std::optional<UlogMessage> next_message() {
    while (std::optional<UlogMessage> message = file_.next()) {
      const UlogTopic& topic = message->topic();
      if (topic.name == stream_.first && topic.instance == stream_.second) return message;
    }
    return std::nullopt;
  }

  template <class Fields>
  const Fields& fields_of(const UlogMessage& message, std::optional<Fields>& fields) const {
    if (!fields) fields = Fields::of(message.topic().fields);
    if (!fields) message.place().fail("the format of the topic has changed within the log");
    return *fields;
  }

  const BootClock& clock() const { return clock_; }

  StampOrder order_;

 private:
  UlogFile file_;
  Stream stream_;
  BootClock clock_;
};

class UlogImu : public UlogReader {
 public:
  using UlogReader::UlogReader;

  std::vector<std::string> notices() const override { return damage(); }

  std::optional<Record> next() override {
    const std::optional<UlogMessage> message = next_message();
    if (!message) return std::nullopt;
    const BootIncrement boot = increment_of(fields_of(*message, fields_), *message);
    ImuIncrement increment;
    increment.t_end_ns = checked_stamp(message->place(), clock().utc_ns(boot.t_us));
    increment.t_begin_ns = increment.t_end_ns - nanoseconds(boot.dt);
    increment.dtheta_b = boot.dtheta;
    increment.dvel_b = boot.dvel;
    order_.check(message->place(), increment.t_end_ns);
    return increment;
  }

 private:
  std::optional<ImuFields> fields_;
};

class UlogGnss : public UlogReader {
 public:
  using UlogReader::UlogReader;

  int64_t without_fix() const override { return without_fix_; }

  std::optional<Record> next() override {
    while (const std::optional<UlogMessage> message = next_message()) {
      const GnssFields& fields = fields_of(*message, fields_);
      const std::optional<FixQuality> quality = quality_of(fields, *message);
      if (quality) return fix_of(fields, *message, *quality);
      ++without_fix_;
    }
    return std::nullopt;
  }

 private:
  GnssFix fix_of(const GnssFields& fields, const UlogMessage& message, FixQuality quality) {
    GnssFix fix;
    fix.quality = quality;
    fix.antenna = checked_position(message.place(), fields.latitude.of(message),
                                   fields.longitude.of(message), height(fields, message));
    const double horizontal = sigma(fields.eph, message);
    const Eigen::Vector3d sigmas(horizontal, horizontal, sigma(fields.epv, message));
    fix.position_covariance = sigmas.cwiseAbs2().asDiagonal();
    add_velocity(fields, message, fix);
    add_heading(fields, message, fix);
    FixTime time = time_of(fields, message);
    const bool repeated = time.utc_us == last_utc_us_;  // a receiver that does not count on
    last_utc_us_ = time.utc_us;
    if (repeated) time.utc_us.reset();
    fix.t_ns = checked_stamp(message.place(), clock().utc_ns(time));
    order_.check(message.place(), fix.t_ns);
    return fix;
  }

  /// Above the ellipsoid if the first fix has it: receivers that do not know it say zero.
  double height(const GnssFields& fields, const UlogMessage& message) {
    if (!ellipsoidal_) {
      ellipsoidal_ = fields.ellipsoidal && fields.ellipsoidal->of(message) != 0;
    }
    return *ellipsoidal_ ? fields.ellipsoidal->of(message) : fields.msl.of(message);
  }

  static double sigma(const Quantity& quantity, const UlogMessage& message) {
    const double value = quantity.of(message);
    if (value <= 0)
      message.place().fail("a fix whose accuracy (eph, epv) is not greater than zero");
    return value;
  }

  static void add_velocity(const GnssFields& fields, const UlogMessage& message, GnssFix& fix) {
    const auto& [north, east, down] = fields.velocity;
    if (!north || !east || !down || !fields.velocity_sigma) return;
    if (fields.velocity_valid && message.number(fields.velocity_valid->field) == 0) return;
    const double sigma = message.number(fields.velocity_sigma->field);
    if (!std::isfinite(sigma) || sigma <= 0) return;
    fix.velocity_n = Eigen::Vector3d(north->of(message), east->of(message), down->of(message));
    fix.velocity_covariance = Eigen::Matrix3d::Identity() * sigma * sigma;
  }

  /// Of the body, already: PX4 takes off GPS_YAW_OFFSET. NaN without two antennas.
  static void add_heading(const GnssFields& fields, const UlogMessage& message, GnssFix& fix) {
    if (!fields.heading) return;
    const double heading = message.number(fields.heading->field);
    if (!std::isfinite(heading)) return;
    const double told = fields.heading_sigma ? message.number(fields.heading_sigma->field) : 0;
    fix.heading = GnssHeading{so3::wrap(heading), told > 0 ? told : kHeadingSigma};
  }

  std::optional<GnssFields> fields_;
  std::optional<bool> ellipsoidal_;
  std::optional<int64_t> last_utc_us_;
  int64_t without_fix_ = 0;
};

}  // namespace

ImportSummary import_ulog(const UlogImport& options) {
  const Survey survey(options.log);
  const std::optional<Eigen::Vector3d> arm =
      options.lever_arm ? options.lever_arm : survey.lever_arm();
  if (!arm) {
    throw UsageError(
        "the log's parameters have no lever arm (EKF2_GPS_POS_X, _Y, _Z are zero); give "
        "--lever-arm X,Y,Z");
  }
  ImportInputs inputs;
  inputs.imu = std::make_unique<UlogImu>(options.log, survey.imu(), survey.clock());
  inputs.gnss = std::make_unique<UlogGnss>(options.log, survey.gnss(), survey.clock());
  inputs.lever_arm_v = *arm;
  inputs.sensor.samples = "interval_mean";  // PX4 integrates
  return run_import(options, std::move(inputs));
}

}  // namespace foucault::rawlog
