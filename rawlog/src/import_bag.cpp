#include "foucault/rawlog/import_bag.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "csv_readers.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/rawlog/import_mapping.h"
#include "import_run.h"
#include "inflate_block.h"
#include "nmea_reader.h"
#include "ros_layout.h"
#include "ros_recording.h"

namespace foucault::rawlog {

namespace {

/// Where a field of numbers stands, if there is one; values as RosLayout::read() gives them.
using Slot = std::optional<size_t>;
using Values = std::vector<double>;

Eigen::Vector3d vector(const Values& values, size_t first) {
  return {values[first], values[first + 1], values[first + 2]};
}

/// Rows of a matrix whose lines are `width` long.
Eigen::Matrix3d matrix(const Values& values, size_t first, size_t width) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 3; ++i) {
    m.row(i) = vector(values, first + static_cast<size_t>(i) * width);
  }
  return m;
}

/// North, east, down of a covariance of east, north, up.
Eigen::Matrix3d ned(const Eigen::Matrix3d& enu) {
  Eigen::Matrix3d turn;
  turn << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  const Eigen::Matrix3d turned = turn * enu * turn.transpose();
  return 0.5 * (turned + turned.transpose());
}

bool is_covariance(const Eigen::Matrix3d& m) {
  return m.allFinite() && m.diagonal().minCoeff() > 0 && m.llt().info() == Eigen::Success;
}

std::array<Slot, 3> want_vector(RosLayout& layout, const std::string& path) {
  return {layout.want(path + ".x"), layout.want(path + ".y"), layout.want(path + ".z")};
}

bool has_all(const std::array<Slot, 3>& slots) { return slots[0] && slots[1] && slots[2]; }

Eigen::Vector3d vector(const Values& values, const std::array<Slot, 3>& slots) {
  return {values[*slots[0]], values[*slots[1]], values[*slots[2]]};
}

/// A message type with the header's stamp.
struct Fields {
  explicit Fields(const RosType& type) : layout(type) {
    seconds = layout.want("header.stamp.sec");
    nanoseconds = layout.want("header.stamp.nanosec");
  }

  /// Of the header, if it has one.
  std::optional<int64_t> stamp(const Values& values) const {
    constexpr double kMost = 0x1p32;
    if (!seconds || !nanoseconds) return std::nullopt;
    for (const double value : {values[*seconds], values[*nanoseconds]}) {
      if (!(value >= 0 && value < kMost)) return std::nullopt;
    }
    const auto stamp = static_cast<int64_t>(values[*seconds]) * kNanosecondsPerSecond +
                       static_cast<int64_t>(values[*nanoseconds]);
    return stamp == 0 ? std::nullopt : std::optional<int64_t>(stamp);
  }

  RosLayout layout;
  Slot seconds, nanoseconds;
};

struct RosImu : Fields {
  explicit RosImu(const RosType& type)
      : Fields(type),
        gyro(want_vector(layout, "angular_velocity")),
        accel(want_vector(layout, "linear_acceleration")),
        gyro_covariance(layout.want("angular_velocity_covariance", 9)),
        accel_covariance(layout.want("linear_acceleration_covariance", 9)) {}
  bool complete() const { return has_all(gyro) && has_all(accel); }

  /// A covariance that begins with -1 says so.
  bool absent(const Values& values) const {
    return (gyro_covariance && values[*gyro_covariance] == -1) ||
           (accel_covariance && values[*accel_covariance] == -1);
  }

  std::array<Slot, 3> gyro, accel;
  Slot gyro_covariance, accel_covariance;
};

struct RosFix : Fields {
  explicit RosFix(const RosType& type)
      : Fields(type),
        position{layout.want("latitude"), layout.want("longitude"), layout.want("altitude")},
        status(layout.want("status.status")),
        covariance(layout.want("position_covariance", 9)),
        covariance_type(layout.want("position_covariance_type")) {}
  bool complete() const { return has_all(position); }

  std::array<Slot, 3> position;
  Slot status, covariance, covariance_type;
};

struct RosVelocity : Fields {
  explicit RosVelocity(const RosType& type)
      : Fields(type), velocity(want_vector(layout, "twist.linear")) {
    if (has_all(velocity)) return;
    velocity = want_vector(layout, "twist.twist.linear");
    covariance = layout.want("twist.covariance", 36);
  }
  /// One with a frame of its own (nav_msgs/Odometry) is told along the axes of the vehicle.
  bool complete() const { return has_all(velocity) && !layout.has("child_frame_id"); }

  std::array<Slot, 3> velocity;
  Slot covariance;
};

/// nmea_msgs/Sentence.
struct RosSentence : Fields {
  explicit RosSentence(const RosType& type)
      : Fields(type), sentence(layout.want_text("sentence")) {}
  bool complete() const { return sentence.has_value(); }

  Slot sentence;
};

// Topics ----------------------------------------------------------------------------------------

template <class Kind>
bool can_be(const RosType& type) {
  try {
    return Kind(type).complete();
  } catch (const BadRecord&) {
    return false;
  }
}

std::string listed(const RosTopics& topics) {
  std::set<std::string> found;
  for (const auto& [id, topic] : topics) {
    found.insert(fmt::format("{} ({}{})", topic.name, topic.type.name,
                             topic.messages == 0 ? ", no message" : ""));
  }
  std::string list = found.empty() ? "none" : "";
  for (const std::string& topic : found) list += (list.empty() ? "" : ", ") + topic;
  return one_line(list);
}

/// The topic that is to be taken: the given one, or the only one with what a `Kind` needs.
template <class Kind>
std::string topic_of(const BagImport& options, const RosTopics& topics,
                     const std::optional<std::string>& given, const char* option,
                     const char* needs) {
  std::set<std::string> found;
  for (const auto& [id, topic] : topics) {
    if (given ? topic.name != *given : topic.messages == 0) continue;
    if (can_be<Kind>(topic.type)) found.insert(topic.name);
  }
  if (found.size() == 1) return *found.begin();
  if (given) {
    throw UsageError(fmt::format("--{}-topic {}: '{}' has no such topic with {}; it has {}", option,
                                 *given, options.bag, needs, listed(topics)));
  }
  if (found.empty()) {
    throw DataError(
        fmt::format("'{}' has no topic with {}; it has {}", options.bag, needs, listed(topics)));
  }
  throw UsageError(fmt::format("'{}' has {} topics with {}: choose one by --{}-topic; it has {}",
                               options.bag, found.size(), needs, option, listed(topics)));
}

// Readers ---------------------------------------------------------------------------------------

/// Messages of some topics of a recording.
class BagReader : public RecordReader {
 public:
  BagReader(RosLog& log, std::set<std::string> topics) : recording_(log.open()) {
    recording_->select(std::move(topics));
  }

  const InputFile& table() const override { return recording_->file(); }

  std::vector<std::string> notices() const override {
    std::vector<std::string> found = recording_->notices();
    for (const auto& [topic, count] : without_stamp_) {
      found.push_back(fmt::format(
          "{}: {} messages of {} have no stamp of their own, that of their recording was taken",
          table().path(), count, topic));
    }
    return found;
  }

 protected:
  const Place& place() const { return recording_->place(); }

  const RosTopic& topic_of(const RosMessage& message) const {
    const auto found = recording_->topics().find(message.topic);
    if (found == recording_->topics().end()) {
      place().fail(
          fmt::format("a message of topic {}, which nothing defines; the recording is damaged here",
                      message.topic));
    }
    return found->second;
  }
  std::optional<RosMessage> next_message() { return recording_->next(); }

  /// The layout of a message's topic.
  template <class Kind>
  const Kind& fields_of(const RosMessage& message, std::map<uint32_t, Kind>& known) const {
    const auto found = known.find(message.topic);
    if (found != known.end()) return found->second;
    return contained([&]() -> const Kind& {
      Kind fields(topic_of(message).type);
      if (!fields.complete()) place().fail("a message whose definition lacks what is needed");
      return known.emplace(message.topic, std::move(fields)).first->second;
    });
  }

  Values values_of(const Fields& fields, const RosMessage& message) {
    return contained([&] { return fields.layout.read(plain(message)); });
  }

  /// Of the header; of the recording where there is none.
  int64_t stamp_of(const Fields& fields, const Values& values, const RosMessage& message) {
    const std::optional<int64_t> stamp = fields.stamp(values);
    if (!stamp) ++without_stamp_[one_line(topic_of(message).name)];
    return stamp.value_or(message.recorded_ns);
  }

  StampOrder order_;

  /// rosbag 2 may compress each message, which then cannot begin as one of CDR does.
  Bytes plain(const RosMessage& message) {
    if (topic_of(message).type.encoding != RosEncoding::cdr || !is_zstd(message.bytes)) {
      return message.bytes;
    }
    const size_t size = zstd_size(message.bytes).value_or(0);
    if (!inflate_block("zstd", message.bytes, size, inflated_)) {
      place().fail("a message that cannot be inflated by zstd; the recording is damaged here");
    }
    return bytes_of(inflated_);
  }

 private:
  template <class Action>
  auto contained(Action action) const -> decltype(action()) {
    try {
      return action();
    } catch (const RecordTooShort&) {
      place().fail("a message that is shorter than its definition; the recording is damaged here");
    } catch (const BadRecord& error) {
      place().fail(fmt::format("{}; the recording is damaged here", error.what()));
    }
  }

  std::unique_ptr<RosRecording> recording_;
  std::vector<unsigned char> inflated_;
  std::map<std::string, int64_t> without_stamp_;
};

class BagImu : public BagReader {
 public:
  BagImu(RosLog& log, const std::string& topic) : BagReader(log, {topic}) {}

  std::optional<Record> next() override {
    const std::optional<RosMessage> message = next_message();
    return message ? std::optional<Record>(sample(*message)) : std::nullopt;
  }

 private:
  imu::ImuSample sample(const RosMessage& message) {
    const RosImu& fields = fields_of(message, fields_);
    const Values values = values_of(fields, message);
    if (fields.absent(values)) {
      place().fail(
          "an IMU sample that says it has no rates or accelerations; choose another "
          "topic by --imu-topic");
    }
    imu::ImuSample sample;
    sample.gyro_b = vector(values, fields.gyro);
    sample.accel_b = vector(values, fields.accel);
    if (!sample.gyro_b.allFinite() || !sample.accel_b.allFinite()) {
      place().fail("an IMU sample with a value that is not finite");
    }
    sample.t_ns = checked_stamp(place(), stamp_of(fields, values, message));
    order_.check(place(), sample.t_ns,
                 sample.gyro_b != last_.gyro_b || sample.accel_b != last_.accel_b);
    last_ = sample;
    return sample;
  }

  std::map<uint32_t, RosImu> fields_;
  imu::ImuSample last_;
};

/// Fixes, each with the velocity of its stamp, which may come before or behind it.
class BagGnss : public BagReader {
 public:
  BagGnss(RosLog& log, const BagImport& options, const std::string& topic)
      : BagReader(log, {topic, options.velocity_topic.value_or(topic)}),
        topic_(topic),
        velocity_topic_(options.velocity_topic),
        sigma_(options.gnss_sigma),
        velocity_sigma_(options.velocity_sigma) {}

  int64_t without_fix() const override { return without_fix_; }

  std::optional<Record> next() override {
    while (const std::optional<RosMessage> message = next_message()) {
      const std::string& topic = topic_of(*message).name;
      std::optional<GnssFix> ready;
      if (velocity_topic_ && topic == *velocity_topic_) {
        ready = take_velocity(*message);
      } else if (topic == topic_) {
        ready = take_fix(*message);
      }
      if (ready) return *ready;
    }
    return std::exchange(pending_, std::nullopt);
  }

 private:
  struct Velocity {
    int64_t t_ns = 0;
    Eigen::Vector3d velocity_n = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  };

  static bool same_stamp(int64_t a_ns, int64_t b_ns) {
    constexpr int64_t kSame = 10'000'000;  // [ns]
    return std::abs(a_ns - b_ns) < kSame;
  }

  /// The fix that is complete by it.
  std::optional<GnssFix> take_fix(const RosMessage& message) {
    const RosFix& fields = fields_of(message, fields_);
    const Values values = values_of(fields, message);
    constexpr double kNoFix = -1;
    if (fields.status && values[*fields.status] == kNoFix) {
      ++without_fix_;
      return std::nullopt;
    }
    const GnssFix fix = fix_of(fields, values, message);
    if (!velocity_topic_) return fix;
    std::optional<GnssFix> before = std::exchange(pending_, fix);
    join();
    return before;
  }

  std::optional<GnssFix> take_velocity(const RosMessage& message) {
    const RosVelocity& fields = fields_of(message, velocity_fields_);
    const Values values = values_of(fields, message);
    const Eigen::Vector3d enu = vector(values, fields.velocity);
    if (!enu.allFinite()) return std::nullopt;  // no velocity at this time
    Velocity velocity;
    velocity.t_ns = stamp_of(fields, values, message);
    velocity.velocity_n = {enu.y(), enu.x(), -enu.z()};
    constexpr size_t kWidth = 6;
    if (fields.covariance) velocity.covariance = ned(matrix(values, *fields.covariance, kWidth));
    if (!is_covariance(velocity.covariance)) {
      velocity.covariance = constant(velocity_sigma_, "velocity");
    }
    velocity_ = velocity;
    return join() ? std::exchange(pending_, std::nullopt) : std::nullopt;
  }

  bool join() {
    if (!pending_ || !velocity_ || !same_stamp(pending_->t_ns, velocity_->t_ns)) return false;
    pending_->velocity_n = velocity_->velocity_n;
    pending_->velocity_covariance = velocity_->covariance;
    return true;
  }

  /// As sensor_msgs/NavSatStatus has it: without and with corrections from satellites or stations.
  static FixQuality quality_of(double status) {
    if (status < 0) return FixQuality::unknown;
    return status > 0 ? FixQuality::differential : FixQuality::single;
  }

  /// Of north, east, down; zero where the message tells none. Only that which is called known is
  /// more than a diagonal (1: by the dilution of precision, 2: the diagonal is known).
  static Eigen::Matrix3d covariance_of(const RosFix& fields, const Values& values) {
    constexpr double kKnown = 3;
    const double type = fields.covariance_type ? values[*fields.covariance_type] : 0;
    if (!fields.covariance || type <= 0) return Eigen::Matrix3d::Zero();
    const Eigen::Matrix3d found = ned(matrix(values, *fields.covariance, 3));
    return type == kKnown ? found : Eigen::Matrix3d(found.diagonal().asDiagonal());
  }

  GnssFix fix_of(const RosFix& fields, const Values& values, const RosMessage& message) {
    const Eigen::Vector3d p = vector(values, fields.position);
    if (!p.allFinite()) place().fail("a fix with a value that is not finite");
    GnssFix fix;
    fix.antenna = checked_position(place(), p.x() * kDegree, p.y() * kDegree, p.z());
    fix.position_covariance = covariance_of(fields, values);
    if (!is_covariance(fix.position_covariance)) {
      fix.position_covariance = constant(sigma_, "gnss");
    }
    if (fields.status) fix.quality = quality_of(values[*fields.status]);
    fix.t_ns = checked_stamp(place(), stamp_of(fields, values, message));
    order_.check(place(), fix.t_ns);
    return fix;
  }

  Eigen::Matrix3d constant(const std::optional<Eigen::Vector3d>& sigma, const char* option) const {
    if (sigma) return sigma->cwiseAbs2().asDiagonal();
    throw UsageError(
        fmt::format("{}: the message tells no covariance; give --{}-sigma "
                    "NORTH,EAST,DOWN",
                    table().place(table().position()), option));
  }

  std::string topic_;
  std::optional<std::string> velocity_topic_;
  std::optional<Eigen::Vector3d> sigma_, velocity_sigma_;
  std::map<uint32_t, RosFix> fields_;
  std::map<uint32_t, RosVelocity> velocity_fields_;
  std::optional<GnssFix> pending_;
  std::optional<Velocity> velocity_;
  int64_t without_fix_ = 0;
};

/// The sentences of a topic.
class BagSentences : public BagReader {
 public:
  BagSentences(RosLog& log, const std::string& topic) : BagReader(log, {topic}) {}

  std::optional<Record> next() override { return std::nullopt; }

  /// Throws RowError and goes on behind it; none at the end.
  std::optional<std::string> sentence() {
    const std::optional<RosMessage> message = next_message();
    if (!message) return std::nullopt;
    if (!begins_ns_) begins_ns_ = message->recorded_ns;
    const RosSentence& fields = fields_of(*message, fields_);
    const Values values = values_of(fields, *message);
    const auto* const begin = plain(*message).begin + static_cast<size_t>(values[*fields.sentence]);
    std::string text(begin, begin + static_cast<size_t>(values[*fields.sentence + 1]));
    text.resize(std::min(text.find_first_of(std::string_view("\r\n\0", 3)), text.size()));
    return text;
  }
  /// Of the first message.
  std::optional<int64_t> begins_ns() const { return begins_ns_; }

 private:
  std::map<uint32_t, RosSentence> fields_;
  std::optional<int64_t> begins_ns_;
};

/// Fixes of a topic of sentences, by their own clock.
class BagNmea : public RecordReader {
 public:
  BagNmea(RosLog& log, const BagImport& options, const std::string& topic) : topic_(topic) {
    const std::optional<int64_t> begins_ns = write_sentences(log, options);
    GnssMapping mapping;
    if (options.gnss_sigma) {
      mapping.sigma_m.assign(options.gnss_sigma->data(), options.gnss_sigma->data() + 3);
    }
    if (options.velocity_sigma) {
      mapping.velocity_sigma_m_s.assign(options.velocity_sigma->data(),
                                        options.velocity_sigma->data() + 3);
    }
    reader_ = make_nmea_reader(
        mapping,
        {sentences_.path(), fmt::format("{} ({})", options.bag, one_line(topic)), begins_ns});
  }

  std::optional<Record> next() override { return reader_->next(); }
  const InputFile& table() const override { return reader_->table(); }
  int64_t without_fix() const override { return reader_->without_fix(); }
  std::vector<std::string> notices() const override {
    std::vector<std::string> found = reader_->notices();
    found.push_back(fmt::format(
        "{}: stamps are the receiver's, those of the IMU may be of another clock", table().path()));
    if (left_out_ > 0) {
      found.push_back(fmt::format("{}: {} damaged messages left out", table().path(), left_out_));
    }
    return found;
  }

 private:
  /// When they begin.
  std::optional<int64_t> write_sentences(RosLog& log, const BagImport& options) {
    std::ofstream file(sentences_.path(), std::ios::binary);
    BagSentences messages(log, topic_);
    for (bool over = false; !over;) {
      try {
        const std::optional<std::string> sentence = messages.sentence();
        over = !sentence;
        file << sentence.value_or("") << '\n';
      } catch (const RowError& error) {
        if (!options.skip_bad_rows) {
          throw DataError(fmt::format("{}, or skip bad rows (--skip-bad-rows)", error.what()));
        }
        ++left_out_;
      }
    }
    if (!file.flush()) {
      throw DataError(
          fmt::format("'{}' cannot be written to, the disk may be full", sentences_.path()));
    }
    return messages.begins_ns();
  }

  std::string topic_;
  TemporaryFile sentences_;
  std::unique_ptr<RecordReader> reader_;
  int64_t left_out_ = 0;
};

void check_sigma(const std::optional<Eigen::Vector3d>& sigma, const char* option) {
  if (!sigma || sigma->minCoeff() > 0) return;
  throw UsageError(fmt::format("--{}-sigma: three numbers greater than zero are needed", option));
}

template <class Kind>
bool has_topic(const RosTopics& topics, const std::optional<std::string>& given) {
  return std::any_of(topics.begin(), topics.end(), [&](const auto& numbered) {
    const RosTopic& topic = numbered.second;
    return (given ? topic.name == *given : topic.messages != 0) && can_be<Kind>(topic.type);
  });
}

/// Of sentences only where there are no fixes, or if that is the topic given.
std::unique_ptr<RecordReader> make_gnss(RosLog& log, const RosTopics& topics,
                                        const BagImport& options) {
  const auto& given = options.gnss_topic;
  if (!has_topic<RosFix>(topics, given) && has_topic<RosSentence>(topics, given)) {
    return std::make_unique<BagNmea>(
        log, options, topic_of<RosSentence>(options, topics, given, "gnss", "sentences of NMEA"));
  }
  return std::make_unique<BagGnss>(
      log, options,
      topic_of<RosFix>(options, topics, given, "gnss", "latitude, longitude and altitude"));
}

}  // namespace

ImportSummary import_bag(const BagImport& options) {
  check_sigma(options.gnss_sigma, "gnss");
  check_sigma(options.velocity_sigma, "velocity");
  ImuMapping imu;
  imu.axes = options.imu_axes;
  ImportInputs inputs;
  naming_mapping("--imu-axes", [&] { inputs.mounting = imu.mounting(); });
  RosLog log(options.bag);
  const RosTopics topics = log.topics();
  inputs.imu =
      std::make_unique<BagImu>(log, topic_of<RosImu>(options, topics, options.imu_topic, "imu",
                                                     "angular_velocity and linear_acceleration"));
  inputs.gnss = make_gnss(log, topics, options);
  if (options.velocity_topic) {
    topic_of<RosVelocity>(options, topics, options.velocity_topic, "velocity",
                          "a twist east, north, up");
  }
  inputs.lever_arm_v = options.lever_arm;
  return run_import(options, std::move(inputs));
}

}  // namespace foucault::rawlog
