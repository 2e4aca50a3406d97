#include "foucault/rawlog/import_dataflash.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "boot_clock.h"
#include "dataflash_file.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/imu/increments.h"
#include "import_run.h"
#include "nmea_accuracy.h"

namespace foucault::rawlog {

namespace {

/// Kind of message and which of its sensors.
using DataflashStream = std::pair<std::string, int>;

constexpr double kMillisecondUs = 1e3;

/// "GPS" with its instance, or "GPS2".
DataflashStream stream_of(const DataflashMessage& message) {
  std::string kind = message.name();
  const std::optional<double> instance = message.number("I");
  if (instance) return {kind, static_cast<int>(*instance)};
  if (kind.size() < 2 || kind.back() < '2' || kind.back() > '9') return {kind, 0};
  const int number = kind.back() - '1';
  kind.pop_back();
  return {kind, number};
}

/// Since boot. Old GPS messages have it as T, beside the receiver's TimeMS.
int64_t boot_us(const DataflashMessage& message) {
  constexpr double kLongestUptime = 1e15;  // [us]
  const bool is_gps = message.name().rfind("GPS", 0) == 0;
  const std::optional<double> us = message.number("TimeUS");
  const double found = us ? *us : message.needed(is_gps ? "T" : "TimeMS") * kMillisecondUs;
  if (!(std::abs(found) <= kLongestUptime)) {
    message.place().fail(
        fmt::format("a time of {:.6g} us cannot be; the file is damaged here", found));
  }
  return std::llround(found);
}

Eigen::Vector3d three_of(const DataflashMessage& message, const std::string& prefix) {
  return {message.needed(prefix + "X"), message.needed(prefix + "Y"), message.needed(prefix + "Z")};
}

// IMU -------------------------------------------------------------------------------------------

/// IMT: increments over its interval.
struct DataflashIncrement {
  int64_t t_us = 0;
  double dt = 0;  ///< [s]
  Eigen::Vector3d dtheta = Eigen::Vector3d::Zero();
  Eigen::Vector3d dvel = Eigen::Vector3d::Zero();
};

DataflashIncrement dataflash_increment(const DataflashMessage& message) {
  constexpr double kShortest = 1e-6;
  constexpr double kLongest = 10;  // [s]
  DataflashIncrement increment;
  increment.t_us = boot_us(message);
  increment.dt = message.needed("DelaT");
  const double accel_dt = message.needed("DelvT");
  for (const double dt : {increment.dt, accel_dt}) {
    if (dt >= kShortest && dt < kLongest) continue;
    message.place().fail(fmt::format("an IMT over {:.6g} s cannot be", dt));
  }
  increment.dtheta = three_of(message, "DA");
  increment.dvel = three_of(message, "DV") * (increment.dt / accel_dt);
  return increment;
}

// GNSS ------------------------------------------------------------------------------------------

std::optional<FixQuality> quality_of(const DataflashMessage& message) {
  switch (std::lround(message.needed("Status"))) {
    case 3:
      return FixQuality::single;
    case 4:
      return FixQuality::differential;
    case 5:
      return FixQuality::float_rtk;
    case 6:
      return FixQuality::fixed_rtk;
    case 8:
      return FixQuality::ppp;
    default:  // 0, 1: none; 2: without height; 7: surveyed in
      return std::nullopt;
  }
}

FixTime time_of(const DataflashMessage& message) {
  const std::optional<double> new_week = message.number("GWk");
  const double week = new_week ? *new_week : message.needed("Week");
  const double ms = new_week ? message.needed("GMS") : message.needed("TimeMS");
  constexpr double kMost = 1e9;
  if (!(std::abs(week) < kMost && std::abs(ms) < kMost)) {
    message.place().fail("a GPS time that cannot be; the file is damaged here");
  }
  constexpr int64_t kNsOfMs = 1'000'000;
  FixTime time{boot_us(message), {}};
  if (week > 0) {
    time.utc_us = gps_stamp(message.place(), std::llround(week), std::llround(ms) * kNsOfMs) /
                  kNanosecondsPerMicrosecond;
  }
  return time;
}

// Survey ----------------------------------------------------------------------------------------

/// What there is of a stream.
struct DataflashAmount {
  int64_t messages = 0;  ///< with a fix, of GNSS
  int64_t first_us = 0;
  int64_t last_us = 0;
  double covered = 0;  ///< by the intervals of increments [s]
  std::vector<FixTime> fixes;

  void count(int64_t t_us) {
    if (messages++ == 0) first_us = t_us;
    last_us = t_us;
  }
  bool is_covered() const {
    constexpr double kEnough = 0.9;
    return covered * 1e6 > kEnough * static_cast<double>(last_us - first_us) && messages > 1;
  }
};

/// What there is in a log, before its records are taken.
class DataflashSurvey {
 public:
  explicit DataflashSurvey(const std::string& path);

  DataflashStream imu() const;
  DataflashStream gnss() const;
  BootClock clock() const { return BootClock(streams_.at(gnss()).fixes); }
  /// IMU to antenna, of the parameters.
  std::optional<Eigen::Vector3d> lever_arm() const;

 private:
  void take(const DataflashMessage& message);
  std::optional<DataflashStream> first(const std::string& kind) const;
  std::optional<double> parameter(const std::vector<std::string>& names) const;

  std::string path_;
  std::map<DataflashStream, DataflashAmount> streams_;
  std::map<std::string, double> parameters_;
};

DataflashSurvey::DataflashSurvey(const std::string& path) : path_(path) {
  DataflashFile file(path);
  bool over = false;
  while (!over) {
    try {
      const std::optional<DataflashMessage> message = file.next();
      over = !message;
      if (message) take(*message);
    } catch (const RowError&) {  // told by the readers
    }
  }
  parameters_ = file.parameters();
}

void DataflashSurvey::take(const DataflashMessage& message) {
  const std::string& name = message.name();
  if (name.rfind("IMT", 0) == 0) {
    const DataflashIncrement increment = dataflash_increment(message);
    DataflashAmount& amount = streams_[stream_of(message)];
    if (amount.messages > 0) amount.covered += increment.dt;
    amount.count(increment.t_us);
  } else if (name.rfind("IMU", 0) == 0) {
    streams_[stream_of(message)].count(boot_us(message));
  } else if (name.rfind("GPS", 0) == 0 && quality_of(message)) {
    const FixTime time = time_of(message);
    DataflashAmount& amount = streams_[stream_of(message)];
    amount.count(time.boot_us);
    if (time.utc_us) amount.fixes.push_back(time);
  }
}

/// The first that is not a thinned out one.
std::optional<DataflashStream> DataflashSurvey::first(const std::string& kind) const {
  int64_t most = 0;
  for (const auto& [stream, amount] : streams_) {
    if (stream.first == kind) most = std::max(most, amount.messages);
  }
  for (const auto& [stream, amount] : streams_) {
    if (stream.first == kind && 2 * amount.messages >= most) return stream;
  }
  return std::nullopt;
}

DataflashStream DataflashSurvey::imu() const {
  const std::optional<DataflashStream> increments = first("IMT");
  if (increments && streams_.at(*increments).is_covered()) return *increments;
  const std::optional<DataflashStream> rates = first("IMU");
  if (rates) return *rates;
  throw DataError(
      fmt::format("'{}' has no IMU messages; set the bit of the IMU in LOG_BITMASK", path_));
}

DataflashStream DataflashSurvey::gnss() const {
  const std::optional<DataflashStream> found = first("GPS");
  if (found && !streams_.at(*found).fixes.empty()) return *found;
  throw DataError(fmt::format(
      "'{}' has no GPS messages with a fix of three dimensions, week and time since boot", path_));
}

std::optional<double> DataflashSurvey::parameter(const std::vector<std::string>& names) const {
  for (const std::string& name : names) {
    const auto found = parameters_.find(name);
    if (found != parameters_.end()) return found->second;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector3d> DataflashSurvey::lever_arm() const {
  const int receiver = gnss().second + 1;
  const int sensor = imu().second + 1;
  Eigen::Vector3d arm = Eigen::Vector3d::Zero();
  const std::array<const char*, 3> axes{"X", "Y", "Z"};
  for (size_t i = 0; i < axes.size(); ++i) {
    const std::optional<double> antenna =
        parameter({fmt::format("GPS_POS{}_{}", receiver, axes[i]),
                   fmt::format("GPS{}_POS_{}", receiver, axes[i])});
    if (!antenna) return std::nullopt;
    arm[static_cast<int>(i)] =
        *antenna - parameter({fmt::format("INS_POS{}_{}", sensor, axes[i])}).value_or(0);
  }
  if (arm.isZero() || !arm.allFinite()) return std::nullopt;  // zero is ArduPilot's default
  return arm;
}

// Readers ---------------------------------------------------------------------------------------

/// The messages of one stream.
class DataflashReader : public RecordReader {
 public:
  DataflashReader(const std::string& path, DataflashStream stream, const BootClock& clock)
      : file_(path), stream_(std::move(stream)), clock_(clock) {}

  const InputFile& table() const override { return file_.file(); }

 protected:
  /// Of its kind, or of `beside`, and its instance.
  std::optional<DataflashMessage> next_message(const std::string& beside = {}) {
    while (std::optional<DataflashMessage> message = file_.next()) {
      const std::string kind = message->name().substr(0, stream_.first.size());
      if (kind != stream_.first && kind != beside) continue;
      const DataflashStream stream = stream_of(*message);
      const bool is_kind = stream.first == stream_.first || stream.first == beside;
      if (is_kind && stream.second == stream_.second) return message;
    }
    return std::nullopt;
  }

  const BootClock& clock() const { return clock_; }
  const DataflashFile& file() const { return file_; }

  StampOrder order_;

 private:
  DataflashFile file_;
  DataflashStream stream_;
  BootClock clock_;
};

class DataflashRates : public DataflashReader {
 public:
  using DataflashReader::DataflashReader;

  std::optional<Record> next() override {
    const std::optional<DataflashMessage> message = next_message();
    if (!message) return std::nullopt;
    imu::ImuSample sample;
    sample.gyro_b = three_of(*message, "Gyr");
    sample.accel_b = three_of(*message, "Acc");
    sample.t_ns = checked_stamp(message->place(), clock().utc_ns(boot_us(*message)));
    order_.check(message->place(), sample.t_ns);
    return sample;
  }
};

class DataflashIncrements : public DataflashReader {
 public:
  using DataflashReader::DataflashReader;

  std::optional<Record> next() override {
    const std::optional<DataflashMessage> message = next_message();
    if (!message) return std::nullopt;
    const DataflashIncrement boot = dataflash_increment(*message);
    ImuIncrement increment;
    increment.t_end_ns = checked_stamp(message->place(), clock().utc_ns(boot.t_us));
    increment.t_begin_ns = increment.t_end_ns - nanoseconds(boot.dt);
    increment.dtheta_b = boot.dtheta;
    increment.dvel_b = boot.dvel;
    order_.check(message->place(), increment.t_end_ns);
    return increment;
  }
};

/// Where nobody tells: of a position at an HDOP of 1 [m], down twice that, and of a velocity [m/s].
constexpr double kDataflashSigma = 1.7;
constexpr double kDataflashVelocitySigma = 0.3;

/// Fixes with the accuracies that come behind them.
class DataflashGnss : public DataflashReader {
 public:
  using DataflashReader::DataflashReader;

  int64_t without_fix() const override { return without_fix_; }

  std::optional<Record> next() override {
    while (const std::optional<DataflashMessage> message = next_message("GPA")) {
      if (message->name().rfind("GPA", 0) == 0) {
        if (waiting_ && boot_us(*message) == waiting_us_) take_accuracy(*message);
        continue;
      }
      const std::optional<GnssFix> ready = finished();
      const std::optional<FixQuality> quality = quality_of(*message);
      if (quality) {
        wait(*message, *quality);
      } else {
        ++without_fix_;
      }
      if (ready) return *ready;
    }
    const std::optional<GnssFix> last = finished();
    if (!last) return std::nullopt;
    return *last;
  }

  std::vector<std::string> notices() const override;

 private:
  void wait(const DataflashMessage& message, FixQuality quality) {
    GnssFix fix;
    fix.quality = quality;
    fix.antenna = checked_position(message.place(), message.needed("Lat") * kDegree,
                                   message.needed("Lng") * kDegree, message.needed("Alt"));
    const std::optional<double> hdop = message.number("HDop");
    hdop_ = hdop && *hdop > 0 ? *hdop : 1;
    const std::optional<double> speed = message.number("Spd");
    if (speed) {
      const double course = message.needed("GCrs") * kDegree;
      has_vertical_ = message.has("VZ");
      fix.velocity_n = Eigen::Vector3d(*speed * std::cos(course), *speed * std::sin(course),
                                       message.number("VZ").value_or(0));
    }
    const FixTime time = time_of(message);
    fix.t_ns = checked_stamp(message.place(), clock().utc_ns(time));
    order_.check(message.place(), fix.t_ns);
    waiting_ = fix;
    waiting_us_ = time.boot_us;
    sigma_.reset();
    velocity_sigma_.reset();
  }

  void take_accuracy(const DataflashMessage& message) {
    const double horizontal = message.needed("HAcc");
    const double vertical = message.needed("VAcc");
    const double speed = message.needed("SAcc");
    if (horizontal > 0 && vertical > 0) sigma_ = {horizontal, horizontal, vertical};
    if (speed > 0) velocity_sigma_ = speed;
    if (message.number("VV").value_or(1) == 0) has_vertical_ = false;
  }

  /// The one that waits, with what came for it.
  std::optional<GnssFix> finished() {
    if (!waiting_) return std::nullopt;
    GnssFix fix = *waiting_;
    waiting_.reset();
    if (!sigma_) assumed_ = true;
    const Eigen::Vector3d sigma =
        sigma_.value_or(hdop_ * kDataflashSigma * Eigen::Vector3d(1, 1, 2));
    fix.position_covariance = sigma.cwiseAbs2().asDiagonal();
    if (!fix.velocity_n) return fix;
    if (!velocity_sigma_) velocity_assumed_ = true;
    Eigen::Vector3d of_velocity =
        Eigen::Vector3d::Constant(velocity_sigma_.value_or(kDataflashVelocitySigma));
    if (!has_vertical_) of_velocity.z() = kOpenVerticalSigma;
    fix.velocity_covariance = of_velocity.cwiseAbs2().asDiagonal();
    return fix;
  }

  std::optional<GnssFix> waiting_;  ///< for its accuracies
  int64_t waiting_us_ = 0;
  double hdop_ = 1;
  bool has_vertical_ = false;
  std::optional<Eigen::Vector3d> sigma_;
  std::optional<double> velocity_sigma_;
  int64_t without_fix_ = 0;
  bool assumed_ = false;
  bool velocity_assumed_ = false;
};

std::vector<std::string> DataflashGnss::notices() const {
  const std::string& path = table().path();
  std::vector<std::string> found{
      fmt::format("{}: heights above the sea taken as above the ellipsoid", path)};
  if (file().damages() > 0) {
    found.push_back(
        fmt::format("{}: passed over {} bytes in {} places that are no message; the "
                    "first at byte {}",
                    path, file().damaged_bytes(), file().damages(), file().first_damage()));
  }
  if (assumed_) {
    found.push_back(
        fmt::format("{}: fixes without accuracies (GPA): HDOP times {} m assumed, down twice that",
                    path, kDataflashSigma));
  }
  if (velocity_assumed_) {
    found.push_back(fmt::format("{}: velocities without an accuracy (GPA): {} m/s assumed", path,
                                kDataflashVelocitySigma));
  }
  return found;
}

}  // namespace

ImportSummary import_dataflash(const DataflashImport& options) {
  const DataflashSurvey survey(options.log);
  const DataflashStream imu = survey.imu();
  ImportInputs inputs;
  if (imu.first == "IMT") {
    inputs.imu = std::make_unique<DataflashIncrements>(options.log, imu, survey.clock());
  } else {
    inputs.imu = std::make_unique<DataflashRates>(options.log, imu, survey.clock());
  }
  inputs.gnss = std::make_unique<DataflashGnss>(options.log, survey.gnss(), survey.clock());
  const std::optional<Eigen::Vector3d> arm =
      options.lever_arm ? options.lever_arm : survey.lever_arm();
  if (!arm) {
    throw UsageError(
        "the log's parameters have no lever arm (GPS_POS1_X, _Y, _Z are zero); give --lever-arm "
        "X,Y,Z");
  }
  inputs.lever_arm_v = *arm;
  return run_import(options, std::move(inputs));
}

}  // namespace foucault::rawlog
