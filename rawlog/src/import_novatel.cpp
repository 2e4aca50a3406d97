#include "foucault/rawlog/import_novatel.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <set>
#include <utility>

#include "csv_readers.h"
#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/place.h"
#include "foucault/rawlog/import_mapping.h"
#include "import_run.h"
#include "novatel_file.h"
#include "novatel_imu.h"

namespace foucault::rawlog {

namespace {

using NovatelIds = std::vector<NovatelId>;

/// Solutions, and their velocities, in the order of preference: BESTPOS may be the receiver's INS.
const std::vector<std::pair<NovatelId, NovatelId>> kNovatelSolutions{
    {NovatelId::bestgnsspos, NovatelId::bestgnssvel},
    {NovatelId::bestpos, NovatelId::bestvel},
    {NovatelId::rtkpos, NovatelId::rtkvel},
    {NovatelId::ppppos, NovatelId::pppvel},
    {NovatelId::psrpos, NovatelId::psrvel}};
const NovatelIds kNovatelRaw{NovatelId::rawimusx, NovatelId::rawimux, NovatelId::rawimus,
                             NovatelId::rawimu};
const NovatelIds kNovatelCorrected{NovatelId::imuratecorrimus, NovatelId::corrimudatas,
                                   NovatelId::corrimudata, NovatelId::corrimus};
const NovatelIds kNovatelPoses{NovatelId::inspvas, NovatelId::inspva, NovatelId::inspvax};
/// Sensor axes that look forward, right, down where nothing else is told.
const std::vector<std::string> kNovatelAxes{"y", "x", "-z"};

bool is_one_of(const NovatelIds& ids, NovatelId id) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

/// "Table: Solution Status".
const NovatelNames kSolutionStatus{{"SOL_COMPUTED", 0}};

/// "Table: Position or Velocity Type".
const NovatelNames kPositionTypes{{"NONE", 0},
                                  {"SINGLE", 16},
                                  {"PSRDIFF", 17},
                                  {"WAAS", 18},
                                  {"SBAS", 18},
                                  {"PROPAGATED", 19},
                                  {"OMNISTAR", 20},
                                  {"L1_FLOAT", 32},
                                  {"IONOFREE_FLOAT", 33},
                                  {"NARROW_FLOAT", 34},
                                  {"L1_INT", 48},
                                  {"WIDE_INT", 49},
                                  {"NARROW_INT", 50},
                                  {"RTK_DIRECT_INS", 51},
                                  {"INS_SBAS", 52},
                                  {"INS_PSRSP", 53},
                                  {"INS_PSRDIFF", 54},
                                  {"INS_RTKFLOAT", 55},
                                  {"INS_RTKFIXED", 56},
                                  {"INS_OMNISTAR", 57},
                                  {"INS_OMNISTAR_HP", 58},
                                  {"INS_OMNISTAR_XP", 59},
                                  {"OMNISTAR_HP", 64},
                                  {"OMNISTAR_XP", 65},
                                  {"CDGPS", 67},
                                  {"PPP_CONVERGING", 68},
                                  {"PPP", 69},
                                  {"OPERATIONAL", 70},
                                  {"WARNING", 71},
                                  {"OUT_OF_BOUNDS", 72},
                                  {"INS_PPP_CONVERGING", 73},
                                  {"INS_PPP", 74},
                                  {"PPP_BASIC_CONVERGING", 77},
                                  {"PPP_BASIC", 78},
                                  {"INS_PPP_BASIC_CONVERGING", 79},
                                  {"INS_PPP_BASIC", 80}};

/// None of a position that is no measurement: given by the user, or extrapolated.
std::optional<FixQuality> novatel_quality(int type) {
  static const std::map<int, FixQuality> kQualities{
      {16, FixQuality::single},       {17, FixQuality::differential},
      {18, FixQuality::differential}, {20, FixQuality::differential},
      {32, FixQuality::float_rtk},    {33, FixQuality::float_rtk},
      {34, FixQuality::float_rtk},    {48, FixQuality::fixed_rtk},
      {49, FixQuality::float_rtk},  // wide lanes: decimetres
      {50, FixQuality::fixed_rtk},    {51, FixQuality::fixed_rtk},
      {52, FixQuality::differential}, {53, FixQuality::single},
      {54, FixQuality::differential}, {55, FixQuality::float_rtk},
      {56, FixQuality::fixed_rtk},    {57, FixQuality::differential},
      {58, FixQuality::ppp},          {59, FixQuality::ppp},
      {64, FixQuality::ppp},          {65, FixQuality::ppp},
      {67, FixQuality::differential}, {68, FixQuality::ppp},
      {69, FixQuality::ppp},          {70, FixQuality::unknown},
      {71, FixQuality::unknown},      {72, FixQuality::unknown},
      {73, FixQuality::ppp},          {74, FixQuality::ppp},
      {77, FixQuality::ppp},          {78, FixQuality::ppp},
      {79, FixQuality::ppp},          {80, FixQuality::ppp}};
  const auto found = kQualities.find(type);
  return found == kQualities.end() ? std::nullopt : std::optional(found->second);
}

/// Of the receiver's filter of GNSS and IMU.
bool is_of_novatel_ins(int type) {
  static const std::set<int> kTypes{51, 52, 53, 54, 55, 56, 57, 58, 59, 73, 74, 79, 80};
  return kTypes.count(type) > 0;
}

/// "Table: Inertial Solution Status".
const NovatelNames kInsStatus{{"INS_HIGH_VARIANCE", 2},
                              {"INS_SOLUTION_GOOD", 3},
                              {"INS_SOLUTION_FREE", 6},
                              {"INS_ALIGNMENT_COMPLETE", 7}};
bool is_good_ins(int status) { return status == 3 || status == 6 || status == 7; }

int64_t stamp_of(const NovatelMessage& message) {
  return gps_stamp(*message.place, message.week, message.tow_ns);
}

/// Of logs that have their own week and seconds; none before the receiver knows the time.
std::optional<int64_t> own_stamp(const NovatelMessage& message, int64_t week, double seconds) {
  if (!(std::abs(seconds) < 2 * kSecondsPerWeek)) {
    message.place->fail(
        fmt::format("{} s are no time of a week; the file is damaged here", seconds));
  }
  if (week == 0) return std::nullopt;
  return gps_stamp(*message.place, week, nanoseconds(seconds));
}

Eigen::Vector3d three_numbers(NovatelFields& fields) {
  Eigen::Vector3d found;
  for (int i = 0; i < 3; ++i) found[i] = fields.number<double>();
  return found;
}

/// Latitude, longitude [deg], height [m]; heights above the sea have their undulation behind them.
Geodetic position_of(NovatelFields& fields, const NovatelMessage& message, bool undulation) {
  const Eigen::Vector3d place = three_numbers(fields);
  const double above = undulation ? fields.number<float>() : 0;
  return checked_position(*message.place, place.x() * kDegree, place.y() * kDegree,
                          place.z() + above);
}

// Logs ------------------------------------------------------------------------------------------

/// BESTPOS and its like.
struct NovatelPosition {
  GnssFix fix;
  bool solved = false;  ///< else nothing of the rest counts
  bool of_ins = false;
  int datum = 0;  ///< as numbered there
};

constexpr int kNovatelWgs84 = 61;

NovatelPosition position_of(const NovatelMessage& message) {
  static const NovatelNames kDatums{{"WGS84", kNovatelWgs84}};
  NovatelFields fields(message);
  const int status = fields.code(kSolutionStatus);
  const int type = fields.code(kPositionTypes);
  const std::optional<FixQuality> quality = novatel_quality(type);
  NovatelPosition found;
  if (status != 0 || !quality || message.week == 0) return found;
  found.solved = true;
  found.of_ins = is_of_novatel_ins(type);
  found.fix.t_ns = stamp_of(message);
  found.fix.quality = *quality;
  found.fix.antenna = position_of(fields, message, true);
  found.datum = fields.code(kDatums);
  Eigen::Vector3d sigma;
  for (int i = 0; i < 3; ++i) sigma[i] = static_cast<double>(fields.number<float>());
  if (sigma.minCoeff() <= 0) message.place->fail("a position whose sigma is not greater than zero");
  found.fix.position_covariance = sigma.cwiseAbs2().asDiagonal();
  return found;
}

struct NovatelVelocity {
  int64_t t_ns = 0;
  Eigen::Vector3d velocity_n = Eigen::Vector3d::Zero();
};

/// None without a solution.
std::optional<NovatelVelocity> velocity_of(const NovatelMessage& message) {
  constexpr double kLongestLatency = 10;  // [s]
  NovatelFields fields(message);
  const int status = fields.code(kSolutionStatus);
  fields.skip_codes(1);
  if (status != 0 || message.week == 0) return std::nullopt;
  const double latency = fields.number<float>();
  fields.number<float>();
  const Eigen::Vector3d course = three_numbers(fields);  // speed, track [deg], up
  if (std::abs(latency) > kLongestLatency) {
    message.place->fail(fmt::format("a velocity with a latency of {:.3g} s", latency));
  }
  const double track = course.y() * kDegree;
  return NovatelVelocity{stamp_of(message) - nanoseconds(latency),
                         {course.x() * std::cos(track), course.x() * std::sin(track), -course.z()}};
}

/// INSPVA and its like; none while the solution is not good.
std::optional<ReferencePose> pose_of(const NovatelMessage& message) {
  NovatelFields fields(message);
  ReferencePose pose;
  std::optional<int64_t> t_ns;
  int status = 0;
  const bool extended = message.id == NovatelId::inspvax;
  if (extended) {
    status = fields.code(kInsStatus);
    fields.skip_codes(1);
    if (message.week > 0) t_ns = stamp_of(message);
  } else {
    const auto week = fields.number<uint32_t>();
    t_ns = own_stamp(message, week, fields.number<double>());
  }
  if (!t_ns || (extended && !is_good_ins(status))) return std::nullopt;
  pose.t_ns = *t_ns;
  const Eigen::Vector3d place = three_numbers(fields);
  const double undulation = extended ? fields.number<float>() : 0;
  const Eigen::Vector3d v = three_numbers(fields);
  const Eigen::Vector3d euler = three_numbers(fields) * kDegree;
  if (!extended) status = fields.code(kInsStatus);
  if (!is_good_ins(status)) return std::nullopt;
  pose.position = checked_position(*message.place, place.x() * kDegree, place.y() * kDegree,
                                   place.z() + undulation);
  pose.velocity_n = Eigen::Vector3d(v.x(), v.y(), -v.z());
  pose.q_n_v = so3::from_euler({euler.x(), euler.y(), euler.z()});
  return pose;
}

/// An IMU log on the sensor's axes x, y, z.
struct NovatelSample {
  std::optional<int64_t> t_ns;                      ///< none before the receiver knows the time
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< counts, or [rad]
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< counts, or [m/s]
  bool error = false;
  std::optional<int> type;
};

/// RAWIMU and its like: z, -y, x.
NovatelSample raw_sample_of(const NovatelMessage& message) {
  constexpr unsigned kError = 1;
  constexpr unsigned kEncrypted = 2;
  NovatelFields fields(message);
  NovatelSample sample;
  int64_t week = 0;
  if (message.id == NovatelId::rawimux || message.id == NovatelId::rawimusx) {
    const auto info = fields.bits<uint8_t>();
    if ((info & kEncrypted) != 0) {
      message.place->fail("IMU data that the receiver has encrypted; they cannot be read");
    }
    sample.error = (info & kError) != 0;
    sample.type = fields.number<uint8_t>();
    week = fields.number<uint16_t>();
  } else {
    week = fields.number<uint32_t>();
  }
  sample.t_ns = own_stamp(message, week, fields.number<double>());
  fields.bits<uint32_t>();
  for (Eigen::Vector3d* vector : {&sample.accel, &sample.gyro}) {
    for (const int axis : {2, 1, 0}) (*vector)[axis] = fields.number<int32_t>();
    vector->y() = -vector->y();
  }
  return sample;
}

/// CORRIMU...: x, y, z.
NovatelSample corrected_sample_of(const NovatelMessage& message) {
  NovatelFields fields(message);
  NovatelSample sample;
  const auto week = fields.number<uint32_t>();  // CORRIMUS: number of samples
  if (message.id == NovatelId::corrimus) {
    if (message.week > 0) sample.t_ns = stamp_of(message);
  } else {
    sample.t_ns = own_stamp(message, week, fields.number<double>());
  }
  sample.gyro = three_numbers(fields);
  sample.accel = three_numbers(fields);
  return sample;
}

/// What INSCONFIG tells. Vectors on the vehicle's axes forward, right, down.
struct NovatelConfig {
  int imu_type = 0;
  std::optional<Eigen::Quaterniond> q_v_b;
  std::optional<Eigen::Vector3d> antenna_b;  ///< IMU to antenna on the IMU's axes [m]
  std::optional<Eigen::Vector3d> antenna_v;
};

state::Mounting mounting_of(const std::vector<std::string>& axes) {
  ImuMapping mapping;
  mapping.axes = axes;
  state::Mounting mounting;
  naming_mapping("--imu-axes", [&] { mounting = mapping.mounting(); });
  return mounting;
}

/// Turns of the frame about its z, then its x, then its y bring the IMU's onto the vehicle's
/// (SETINSROTATION).
Eigen::Quaterniond rotation_of(const Eigen::Vector3d& angles) {
  const Eigen::Quaterniond q_b_vehicle = so3::exp(angles.z() * Eigen::Vector3d::UnitZ()) *
                                         so3::exp(angles.x() * Eigen::Vector3d::UnitX()) *
                                         so3::exp(angles.y() * Eigen::Vector3d::UnitY());
  return mounting_of(kNovatelAxes).q_v_b * q_b_vehicle.conjugate();
}

struct NovatelOffset {
  int what = 0;
  int frame = 0;
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
};

std::vector<NovatelOffset> offsets_of(NovatelFields& fields, const NovatelMessage& message,
                                      const NovatelNames& names) {
  constexpr uint32_t kMost = 100;
  static const NovatelNames kFrames{{"IMUBODY", 0}, {"VEHICLE", 1}};
  const auto count = fields.number<uint32_t>();
  if (count > kMost) message.place->fail("log INSCONFIG tells too many offsets");
  std::vector<NovatelOffset> found(count);
  for (NovatelOffset& offset : found) {
    offset.what = fields.code(names);
    offset.frame = fields.code(kFrames);
    for (int i = 0; i < 3; ++i) offset.value[i] = static_cast<double>(fields.number<float>());
    for (int i = 0; i < 3; ++i) fields.number<float>();
    fields.skip_codes(1);
  }
  return found;
}

NovatelConfig config_of(const NovatelMessage& message) {
  constexpr int kAntenna = 1;
  constexpr int kVehicle = 11;
  NovatelFields fields(message);
  NovatelConfig config;
  config.imu_type = fields.code(novatel_imu_names());
  for (int i = 0; i < 2; ++i) fields.number<uint8_t>();  // mapping, alignment velocity
  fields.number<uint16_t>();                             // heave window
  fields.skip_codes(1);                                  // profile
  fields.bits<uint32_t>();                               // updates
  fields.skip_codes(3);                                  // alignment, relative INS
  fields.bits<uint32_t>();                               // receiver status
  for (int i = 0; i < 2; ++i) fields.number<uint8_t>();  // seeds
  fields.number<uint16_t>();
  for (int i = 0; i < 6; ++i) fields.number<uint32_t>();
  for (const NovatelOffset& offset : offsets_of(fields, message, {{"ANT1", kAntenna}})) {
    if (offset.what != kAntenna) continue;
    if (offset.frame == 0) config.antenna_b = offset.value;
    if (offset.frame == 1) config.antenna_v = mounting_of(kNovatelAxes).q_v_b * offset.value;
  }
  for (const NovatelOffset& offset : offsets_of(fields, message, {{"RBV", kVehicle}})) {
    if (offset.what == kVehicle) config.q_v_b = rotation_of(offset.value * kDegree);
  }
  return config;
}

/// How much the poses of the receiver turn for what its corrected increments turn.
class NovatelTurns {
 public:
  void take(const ReferencePose& pose) {
    if (q_n_v_ && since_ > 0) {
      const Eigen::Vector3d turned = so3::log(q_n_v_->conjugate() * *pose.q_n_v);
      of_both_ += turned.dot(sum_);
      of_increments_ += sum_.squaredNorm();
      angle_ += turned.norm();
    }
    q_n_v_ = pose.q_n_v;
    sum_.setZero();
    since_ = 0;
  }

  void take(const NovatelSample& sample) {
    sum_ += q_v_vehicle_ * sample.gyro;
    ++since_;
  }

  /// None where nothing turned.
  std::optional<double> ratio() const {
    constexpr double kEnough = 20 * kDegree;
    if (angle_ < kEnough || !(of_increments_ > 0)) return std::nullopt;
    return of_both_ / of_increments_;
  }

 private:
  std::optional<Eigen::Quaterniond> q_n_v_;
  Eigen::Quaterniond q_v_vehicle_ = mounting_of(kNovatelAxes).q_v_b;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();  ///< since the last pose [rad]
  int since_ = 0;                                  ///< samples
  double of_both_ = 0;
  double of_increments_ = 0;
  double angle_ = 0;
};

// Survey ----------------------------------------------------------------------------------------

/// What there is in a log, before its records are taken.
class NovatelSurvey {
 public:
  explicit NovatelSurvey(const std::string& path);

  /// Position and velocity.
  std::pair<NovatelId, NovatelId> solution() const;
  std::optional<NovatelId> imu() const;
  std::optional<NovatelId> pose() const { return most(kNovatelPoses); }
  std::optional<double> turns(NovatelId corrected) const;
  bool has(NovatelId id) const { return counts_.count(id) > 0; }
  const std::optional<int>& imu_type() const { return imu_type_; }
  const NovatelConfig& config() const { return config_; }

 private:
  void take(const NovatelMessage& message);
  bool counts(const NovatelMessage& message);
  std::optional<NovatelId> most(const NovatelIds& ids) const;

  std::string path_;
  std::map<NovatelId, int64_t> counts_;  ///< of logs with a solution
  int64_t messages_ = 0;
  int64_t damaged_ = 0;
  std::optional<int> imu_type_;
  NovatelConfig config_;
  std::map<NovatelId, NovatelTurns> turns_;  ///< of corrected logs
};

NovatelSurvey::NovatelSurvey(const std::string& path) : path_(path) {
  NovatelFile file(path);
  bool over = false;
  while (!over) {
    try {
      const std::optional<NovatelMessage> message = file.next();
      over = !message;
      if (message) take(*message);
    } catch (const RowError&) {  // told by the readers
    }
  }
  messages_ = file.messages();
  damaged_ = file.damaged();
}

void NovatelSurvey::take(const NovatelMessage& message) {
  if (message.id == NovatelId::insconfig) {
    config_ = config_of(message);
    if (!imu_type_ && config_.imu_type > 0) imu_type_ = config_.imu_type;
  } else if (counts(message)) {
    ++counts_[message.id];
  }
}

bool NovatelSurvey::counts(const NovatelMessage& message) {
  if (is_one_of(kNovatelPoses, message.id)) {
    const std::optional<ReferencePose> pose = pose_of(message);
    if (!pose) return false;
    for (auto& [id, turns] : turns_) turns.take(*pose);
    return true;
  }
  if (is_one_of(kNovatelCorrected, message.id)) {
    const NovatelSample sample = corrected_sample_of(message);
    turns_[message.id].take(sample);
    return sample.t_ns.has_value();
  }
  if (is_one_of(kNovatelRaw, message.id)) {
    const NovatelSample sample = raw_sample_of(message);
    if (sample.type) imu_type_ = sample.type;
    return sample.t_ns.has_value();
  }
  for (const auto& [position, velocity] : kNovatelSolutions) {
    if (message.id == position) return position_of(message).solved;
    if (message.id == velocity) return velocity_of(message).has_value();
  }
  return false;
}

std::optional<NovatelId> NovatelSurvey::most(const NovatelIds& ids) const {
  std::optional<NovatelId> best;
  for (const NovatelId id : ids) {
    const auto found = counts_.find(id);
    if (found != counts_.end() && (!best || found->second > counts_.at(*best))) best = id;
  }
  return best;
}

std::optional<double> NovatelSurvey::turns(NovatelId corrected) const {
  const auto found = turns_.find(corrected);
  return found == turns_.end() ? std::nullopt : found->second.ratio();
}

std::pair<NovatelId, NovatelId> NovatelSurvey::solution() const {
  for (const auto& solution : kNovatelSolutions) {
    if (has(solution.first)) return solution;
  }
  throw DataError(
      fmt::format("'{}' has no position of a NovAtel receiver with a solution: {} logs are whole, "
                  "{} damaged; log BESTPOS or BESTGNSSPOS",
                  path_, messages_, damaged_));
}

std::optional<NovatelId> NovatelSurvey::imu() const {
  const std::optional<NovatelId> raw = most(kNovatelRaw);
  if (raw) return raw;
  const std::optional<NovatelId> corrected = most(kNovatelCorrected);
  if (corrected && !pose()) {
    throw DataError(
        fmt::format("'{}': {} has gravity taken out, and there is no INSPVA to put it back by; "
                    "log RAWIMUSX",
                    path_, name_of(*corrected)));
  }
  return corrected;
}

// Readers ---------------------------------------------------------------------------------------

class NovatelReader : public RecordReader {
 public:
  NovatelReader(const std::string& path, NovatelIds ids) : file_(path), ids_(std::move(ids)) {}

  const InputFile& table() const override { return file_.file(); }
  int64_t without_fix() const override { return without_; }

  std::vector<std::string> notices() const override {
    std::vector<std::string> found;
    if (repeated_ > 0) {
      found.push_back(fmt::format("{}: left out {} logs {} of a stamp that was there before",
                                  table().path(), repeated_, name_of(ids_.front())));
    }
    return found;
  }

 protected:
  std::optional<NovatelMessage> next_message() {
    while (std::optional<NovatelMessage> message = file_.next()) {
      if (is_one_of(ids_, message->id)) return message;
    }
    return std::nullopt;
  }

  /// A log may go to several ports.
  bool is_repeated(int64_t t_ns) {
    const bool repeated = last_ns_ && *last_ns_ == t_ns;
    last_ns_ = t_ns;
    if (repeated) ++repeated_;
    return repeated;
  }

  void check_order(const NovatelMessage& message, int64_t t_ns) {
    order_.check(*message.place, t_ns);
  }

  const NovatelFile& file() const { return file_; }

  int64_t without_ = 0;

 private:
  NovatelFile file_;
  NovatelIds ids_;
  StampOrder order_;
  std::optional<int64_t> last_ns_;
  int64_t repeated_ = 0;
};

/// Attitude between the poses of the receiver, carried on by its corrected increments.
class NovatelAttitude {
 public:
  void take(const ReferencePose& pose) {
    place_.emplace(pose.position);
    q_n_v_ = *pose.q_n_v;
    t_ns_ = pose.t_ns;
    pose_ns_ = pose.t_ns;
  }

  /// Puts back gravity and the Earth's rate; increments on the vehicle's axes. False before there
  /// is a pose, or after none came for long.
  bool restore(ImuIncrement& increment) {
    constexpr int64_t kLongest = 10 * kNanosecondsPerSecond;
    if (!place_ || increment.t_end_ns - pose_ns_ > kLongest) return false;
    const double dt = increment.dt();
    const Eigen::Vector3d rate = increment.dtheta_b / dt;
    const int64_t middle_ns = (increment.t_begin_ns + increment.t_end_ns) / 2;
    const Eigen::Quaterniond q_middle = q_n_v_ * so3::exp(rate * seconds_between(t_ns_, middle_ns));
    const Eigen::Vector3d gravity_n(0, 0, place_->gravity);
    increment.dvel_b -= q_middle.conjugate() * gravity_n * dt;
    increment.dtheta_b += q_middle.conjugate() * place_->omega_ie_n * dt;
    if (increment.t_end_ns > t_ns_) {
      q_n_v_ = q_n_v_ * so3::exp(rate * seconds_between(t_ns_, increment.t_end_ns));
      t_ns_ = increment.t_end_ns;
    }
    return true;
  }

 private:
  std::optional<geodesy::Place> place_;
  Eigen::Quaterniond q_n_v_ = Eigen::Quaterniond::Identity();
  int64_t t_ns_ = 0;
  int64_t pose_ns_ = 0;
};

class NovatelImu : public NovatelReader {
 public:
  NovatelImu(const std::string& path, NovatelId id, const NovatelScales& scales)
      : NovatelReader(path, {id}), id_(id), scales_(scales) {}

  std::optional<Record> next() override {
    while (ready_.empty()) {
      const std::optional<NovatelMessage> message = next_message();
      if (!message) return std::nullopt;
      take(*message);
    }
    const ImuIncrement increment = ready_.front();
    ready_.pop_front();
    return increment;
  }

  std::vector<std::string> notices() const override {
    std::vector<std::string> found = NovatelReader::notices();
    if (errors_ > 0) {
      found.push_back(fmt::format("{}: {} IMU samples are marked as wrong by the receiver ({})",
                                  table().path(), errors_, name_of(id_)));
    }
    return found;
  }

 protected:
  NovatelImu(const std::string& path, const NovatelIds& ids, const NovatelScales& scales)
      : NovatelReader(path, ids), id_(ids.front()), scales_(scales) {}

  virtual void take(const NovatelMessage& message) { take(raw_sample_of(message), message); }

  void take(const NovatelSample& sample, const NovatelMessage& message) {
    if (!sample.t_ns) {
      ++without_;
      return;
    }
    if (is_repeated(*sample.t_ns)) return;
    if (sample.error) ++errors_;
    check_order(message, *sample.t_ns);
    const std::optional<int64_t> length_ns = lengths_.ending_at(*sample.t_ns);
    if (!length_ns) {
      first_ = sample;
      return;
    }
    if (first_) put(*first_, *length_ns);
    first_.reset();
    put(sample, *length_ns);
  }

  /// On the axes of the log.
  virtual std::optional<ImuIncrement> finished(const ImuIncrement& increment) { return increment; }

 private:
  void put(const NovatelSample& sample, int64_t length_ns) {
    ImuIncrement increment;
    increment.t_end_ns = *sample.t_ns;
    increment.t_begin_ns = *sample.t_ns - length_ns;
    increment.dtheta_b = sample.gyro * scales_.gyro;
    increment.dvel_b = sample.accel * scales_.accel;
    const std::optional<ImuIncrement> done = finished(increment);
    if (done) {
      ready_.push_back(*done);
    } else {
      ++without_;
    }
  }

  NovatelId id_;
  NovatelScales scales_;
  IntervalLengths lengths_;
  std::optional<NovatelSample> first_;  ///< waits for its length
  std::deque<ImuIncrement> ready_;
  int64_t errors_ = 0;
};

/// Corrected increments, brought to the vehicle's axes and made what an IMU measures again.
class NovatelCorrectedImu : public NovatelImu {
 public:
  NovatelCorrectedImu(const std::string& path, NovatelId id, NovatelId pose,
                      const NovatelScales& scales)
      : NovatelImu(path, NovatelIds{id, pose}, scales), id_(id), pose_(pose) {}

  std::vector<std::string> notices() const override {
    std::vector<std::string> found = NovatelImu::notices();
    found.push_back(
        fmt::format("{}: {} is corrected by the receiver's filter, its biases are out already; "
                    "gravity and the Earth's rate were put back by {}; log RAWIMUSX",
                    table().path(), name_of(id_), name_of(pose_)));
    return found;
  }

 protected:
  void take(const NovatelMessage& message) override {
    if (message.id == id_) {
      NovatelImu::take(corrected_sample_of(message), message);
    } else if (const std::optional<ReferencePose> pose = pose_of(message)) {
      attitude_.take(*pose);
    }
  }

  std::optional<ImuIncrement> finished(const ImuIncrement& increment) override {
    ImuIncrement restored = increment;
    restored.dtheta_b = q_v_b_ * increment.dtheta_b;
    restored.dvel_b = q_v_b_ * increment.dvel_b;
    return attitude_.restore(restored) ? std::optional(restored) : std::nullopt;
  }

 private:
  NovatelId id_, pose_;
  Eigen::Quaterniond q_v_b_ = mounting_of(kNovatelAxes).q_v_b;
  NovatelAttitude attitude_;
};

constexpr double kNovatelVelocitySigma = 0.1;  ///< where nobody tells [m/s]

class NovatelGnss : public NovatelReader {
 public:
  NovatelGnss(const NovatelImport& options, const NovatelSurvey& survey)
      : NovatelReader(options.log, {survey.solution().first, survey.solution().second}),
        position_(survey.solution().first),
        has_velocity_(survey.has(survey.solution().second)),
        sigma_(options.velocity_sigma) {}

  std::optional<Record> next() override {
    while (true) {
      if (!fixes_.empty() && (over_ || velocity_is_settled())) {
        GnssFix fix = fixes_.front();
        fixes_.pop_front();
        add_velocity(fix);
        return fix;
      }
      if (over_) return std::nullopt;
      const std::optional<NovatelMessage> message = next_message();
      over_ = !message;
      if (message) take(*message);
    }
  }

  std::vector<std::string> notices() const override;

 private:
  void take(const NovatelMessage& message) {
    if (message.id != position_) {
      const std::optional<NovatelVelocity> velocity = velocity_of(message);
      const bool follows =
          velocity && (velocities_.empty() || velocity->t_ns > velocities_.back().t_ns);
      if (follows) velocities_.push_back(*velocity);
      return;
    }
    const NovatelPosition position = position_of(message);
    if (!position.solved) {
      ++without_;
      return;
    }
    if (is_repeated(position.fix.t_ns)) return;
    check_order(message, position.fix.t_ns);
    if (position.of_ins) ++of_ins_;
    if (position.datum != kNovatelWgs84) ++other_datum_;
    fixes_.push_back(position.fix);
  }

  /// Velocities reach the first fix, or none will.
  bool velocity_is_settled() const {
    constexpr size_t kMostWaiting = 100;
    return !has_velocity_ || fixes_.size() > kMostWaiting ||
           (!velocities_.empty() && velocities_.back().t_ns >= fixes_.front().t_ns);
  }

  /// By a line between those before and behind, which are late by their latency.
  void add_velocity(GnssFix& fix) {
    constexpr int64_t kFarthest = 1'500'000'000;  // [ns]
    while (velocities_.size() > 1 && velocities_[1].t_ns <= fix.t_ns) velocities_.pop_front();
    if (velocities_.empty() || velocities_.front().t_ns > fix.t_ns) return;
    const NovatelVelocity& before = velocities_.front();
    Eigen::Vector3d velocity = before.velocity_n;
    if (before.t_ns < fix.t_ns) {
      if (velocities_.size() < 2 || velocities_[1].t_ns - before.t_ns > kFarthest) return;
      const NovatelVelocity& behind = velocities_[1];
      const double part =
          seconds_between(before.t_ns, fix.t_ns) / seconds_between(before.t_ns, behind.t_ns);
      velocity += part * (behind.velocity_n - before.velocity_n);
    }
    fix.velocity_n = velocity;
    const Eigen::Vector3d sigma = sigma_.value_or(Eigen::Vector3d::Constant(kNovatelVelocitySigma));
    fix.velocity_covariance = sigma.cwiseAbs2().asDiagonal();
    ++with_velocity_;
  }

  NovatelId position_;
  bool has_velocity_;
  std::optional<Eigen::Vector3d> sigma_;
  bool over_ = false;
  std::deque<GnssFix> fixes_;  ///< wait for their velocities
  std::deque<NovatelVelocity> velocities_;
  int64_t with_velocity_ = 0;
  int64_t of_ins_ = 0;
  int64_t other_datum_ = 0;
};

std::vector<std::string> NovatelGnss::notices() const {
  std::vector<std::string> found = NovatelReader::notices();
  const std::string& path = table().path();
  if (file().damaged() > 0) {
    found.push_back(fmt::format(
        "{}: left out {} of {} logs, cut off or with a wrong CRC; the first at byte {}", path,
        file().damaged(), file().damaged() + file().messages(), file().first_damaged()));
  }
  if (of_ins_ > 0) {
    found.push_back(
        fmt::format("{}: {} positions of {} are of the receiver's own INS, not of GNSS alone; log "
                    "BESTGNSSPOS",
                    path, of_ins_, name_of(position_)));
  }
  if (other_datum_ > 0) {
    found.push_back(fmt::format("{}: {} positions in another datum than WGS84 taken as they are",
                                path, other_datum_));
  }
  if (with_velocity_ > 0 && !sigma_) {
    found.push_back(
        fmt::format("{}: velocities have no sigma, {} m/s assumed; if known, give --velocity-sigma",
                    path, kNovatelVelocitySigma));
  }
  return found;
}

class NovatelReference : public NovatelReader {
 public:
  NovatelReference(const std::string& path, NovatelId id) : NovatelReader(path, {id}), id_(id) {}

  std::optional<Record> next() override {
    while (const std::optional<NovatelMessage> message = next_message()) {
      const std::optional<ReferencePose> pose = pose_of(*message);
      if (!pose) {
        ++without_;
        continue;
      }
      if (is_repeated(pose->t_ns)) continue;
      check_order(*message, pose->t_ns);
      return *pose;
    }
    return std::nullopt;
  }

  std::vector<std::string> notices() const override {
    std::vector<std::string> found = NovatelReader::notices();
    found.push_back(fmt::format(
        "{}: the reference is the receiver's own solution ({}) of these data, no independent one",
        table().path(), name_of(id_)));
    return found;
  }

 private:
  NovatelId id_;
};

// Options ---------------------------------------------------------------------------------------

/// Those of the command line.
std::optional<NovatelScales> given_scales(const NovatelImport& options) {
  if (!options.imu_scales) return std::nullopt;
  if (options.imu_scales->minCoeff() > 0) {
    return NovatelScales{options.imu_scales->x(), options.imu_scales->y()};
  }
  throw UsageError("--imu-scales: two numbers greater than zero are needed");
}

/// Corrected logs are sums since the log before, but of old firmware single samples of the IMU.
NovatelScales corrected_scales(const NovatelImport& options, const NovatelSurvey& survey,
                               NovatelId id) {
  constexpr double kSame = 0.1;
  const std::optional<NovatelScales> given = given_scales(options);
  if (given) return *given;
  const double ratio = survey.turns(id).value_or(1);
  if (std::abs(ratio - 1) < kSame) return {1, 1};
  throw UsageError(
      fmt::format("'{0}': INSPVA turns {1:.3g} times as much as {2}, which holds single samples of "
                  "the IMU; give the samples of a log with --imu-scales N,N (about {1:.3g}), or "
                  "log RAWIMUSX",
                  options.log, ratio, name_of(id)));
}

NovatelScales scales_of(const NovatelImport& options, const std::optional<int>& told) {
  const std::optional<NovatelScales> given = given_scales(options);
  if (given) return *given;
  std::optional<int> type = told;
  std::vector<std::string_view> names;
  for (const auto& [name, number] : novatel_imu_names()) {
    names.push_back(name);
    if (options.imu_type == name) type = number;
  }
  const std::optional<NovatelScales> scales = type ? novatel_scales(*type) : std::nullopt;
  const bool unknown_name =
      options.imu_type && (!type || novatel_imu_name(*type) != *options.imu_type);
  if (scales && !unknown_name) return *scales;
  const std::string what =
      options.imu_type ? fmt::format("--imu-type {} is not known", *options.imu_type)
      : type           ? fmt::format("the IMU's type, {}, is not known", novatel_imu_name(*type))
                       : std::string("the log does not tell the IMU's type (RAWIMUX, INSCONFIG)");
  throw UsageError(
      fmt::format("{}; give --imu-type, one of {}, or what a count is: --imu-scales GYRO,ACCEL "
                  "[rad],[m/s]",
                  what, fmt::join(names, ", ")));
}

state::Mounting mounting_of(const NovatelImport& options, const NovatelConfig& config) {
  if (!options.imu_axes.empty()) return mounting_of(options.imu_axes);
  if (config.q_v_b) return {*config.q_v_b};
  return mounting_of(kNovatelAxes);
}

Eigen::Vector3d lever_arm_of(const NovatelImport& options, const NovatelConfig& config,
                             const state::Mounting& mounting) {
  if (options.lever_arm) return *options.lever_arm;
  if (config.antenna_v) return *config.antenna_v;
  if (config.antenna_b) return mounting.q_v_b * *config.antenna_b;
  throw UsageError("the log has no lever arm (ANT1 of INSCONFIG); give --lever-arm X,Y,Z");
}

void check_velocity_sigma(const NovatelImport& options) {
  if (!options.velocity_sigma || options.velocity_sigma->minCoeff() > 0) return;
  throw UsageError("--velocity-sigma: three numbers greater than zero are needed");
}

}  // namespace

ImportSummary import_novatel(const NovatelImport& options) {
  check_velocity_sigma(options);
  const NovatelSurvey survey(options.log);
  const state::Mounting of_imu = mounting_of(options, survey.config());
  ImportInputs inputs;
  inputs.gnss = std::make_unique<NovatelGnss>(options, survey);
  inputs.lever_arm_v = lever_arm_of(options, survey.config(), of_imu);
  inputs.sensor.samples = "interval_mean";  // increments
  const std::optional<NovatelId> imu = survey.imu();
  const std::optional<NovatelId> pose = survey.pose();
  if (imu && is_one_of(kNovatelRaw, *imu)) {
    inputs.mounting = of_imu;
    inputs.imu =
        std::make_unique<NovatelImu>(options.log, *imu, scales_of(options, survey.imu_type()));
  } else if (imu) {
    inputs.imu = std::make_unique<NovatelCorrectedImu>(options.log, *imu, *pose,
                                                       corrected_scales(options, survey, *imu));
  }
  if (pose) inputs.reference = std::make_unique<NovatelReference>(options.log, *pose);
  return run_import(options, std::move(inputs));
}

}  // namespace foucault::rawlog
