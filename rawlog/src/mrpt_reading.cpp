#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/position.h"
#include "foucault/core/time.h"
#include "foucault/core/time_mismatch.h"
#include "foucault/imu/burst_stamps.h"
#include "foucault/imu/increments.h"
#include "foucault/imu/recent_rates.h"
#include "foucault/rawlog/mrpt_convert.h"
#include "imu_halves.h"
#include "mrpt_entries.h"
#include "notes_comment.h"
#include "rawlog_stream.h"

namespace foucault::rawlog {

using rawlog::LoggedObservation;

namespace {

constexpr std::string_view kImu = "CObservationIMU";
constexpr std::string_view kGps = "CObservationGPS";
constexpr std::string_view kOdometry = "CObservationOdometry";
constexpr std::string_view kNotFinite = "not finite";

/// What must be known of a log before its first measurement.
struct Overview {
  std::string imu_label;
  bool imu_halves = false;  ///< gyroscope and accelerometer in records of their own
  std::string accel_label;  ///< of such an accelerometer
  rawlog::SensorPose imu;
  std::string gnss_label;
  rawlog::SensorPose antenna;
  Geodetic first_fix;
  bool by_rmc = false;  ///< no other positions: those of RMC, without heights
};

const mrpt::obs::CObservationGPS* as_gps(const LoggedObservation& logged) {
  return dynamic_cast<const mrpt::obs::CObservationGPS*>(logged.observation.get());
}

bool label_fits(const std::string& wanted, std::string_view label) {
  return wanted.empty() || wanted == label;
}

/// MRPT's grabbers append the kind of sentence to the label: GPS_NMEA_GGA, GPS_NMEA_RMC.
std::string_view receiver_of(std::string_view label) {
  return label.substr(0, label.rfind("_NMEA_"));
}

/// A velocity that is no number does not spoil a position.
bool velocity_finite(const GnssFix& fix) {
  return fix.velocity_n->allFinite() && fix.velocity_covariance.allFinite();
}

bool finite(const imu::ImuSample& sample) {
  return sample.gyro_b.allFinite() && sample.accel_b.allFinite();
}

/// For a fix that is still to come.
template <class Part>
void keep_waiting(int64_t t_ns, const Part& part, std::map<int64_t, Part>& waiting) {
  constexpr size_t kMost = 100;
  waiting[t_ns] = part;
  if (waiting.size() > kMost) waiting.erase(waiting.begin());
}

/// Reads ahead until the first IMU sample and the first fix.
class OverviewScan {
 public:
  OverviewScan(const std::string& path, const RawlogOptions& options)
      : path_(path), options_(options) {}

  Overview run() {
    rawlog::RawlogStream stream(path_, options_.reference_label);
    while (!(imu_found_ && gnss_found_)) {
      const std::optional<LoggedObservation> logged = stream.next();
      if (!logged) {
        imu_found_ = imu_found_ || (gyro_found_ && accel_found_);
        if (imu_found_ && (gnss_found_ || overview_.by_rmc)) break;
        throw DataError(stream.damage() ? *stream.damage() : missing());
      }
      look_at(*logged);
    }
    return overview_;
  }

 private:
  void look_at(const LoggedObservation& logged) {
    if (!logged.t_ns) return;
    if (logged.imu) {
      ++imus_;
      if (!imu_found_ && label_fits(options_.imu_label, logged.label())) look_at(*logged.imu);
    } else if (const auto* gps = as_gps(logged)) {
      if (gps->sensorLabel == options_.reference_label) return;
      ++gps_;
      if (!gnss_found_ && label_fits(options_.gnss_label, gps->sensorLabel)) take_fix(*gps);
    }
  }

  /// Records with both are preferred to halves, where they come soon.
  void look_at(const rawlog::ImuRecord& imu) {
    constexpr int kSoon = 200;
    if (imu.sample || (imu.gyro_b && !gyro_found_)) {
      overview_.imu_label = imu.label;
      overview_.imu = rawlog::from_mrpt(rawlog::pose_of(imu.pose));
    }
    if (imu.accel_b && !accel_found_) overview_.accel_label = imu.label;
    gyro_found_ = gyro_found_ || imu.gyro_b;
    accel_found_ = accel_found_ || imu.accel_b;
    overview_.imu_halves = !imu.sample;
    imu_found_ = imu.sample || (gyro_found_ && accel_found_ && ++halves_ > kSoon);
  }

  void take_fix(const mrpt::obs::CObservationGPS& gps) {
    std::optional<GnssFix> fix = rawlog::decode_fix(gps, 0);
    const bool found = fix && is_position(fix->antenna);
    if (!found && overview_.by_rmc) return;
    if (!found) fix = rawlog::decode_rmc(gps, 0);
    if (!fix || !is_position(fix->antenna)) return;
    gnss_found_ = found;
    overview_.by_rmc = !found;
    overview_.gnss_label = gps.sensorLabel;
    overview_.antenna = rawlog::from_mrpt(gps.sensorPose);
    overview_.first_fix = fix->antenna;
  }

  std::string missing() const {
    const std::string imu_wish =
        options_.imu_label.empty() ? "" : fmt::format(" labelled '{}'", options_.imu_label);
    const std::string gnss_wish =
        options_.gnss_label.empty() ? "" : fmt::format(" labelled '{}'", options_.gnss_label);
    if (!imu_found_) {
      return fmt::format(
          "'{}' has no IMU: {} CObservationIMU, none{} with stamp, gyroscope and "
          "accelerometer; see `foucault info`",
          path_, imus_, imu_wish);
    }
    return fmt::format(
        "'{}' has no GNSS: {} CObservationGPS, none{} with a stamp and a position "
        "(BESTPOS, PZS or GGA); see `foucault info`",
        path_, gps_, gnss_wish);
  }

  std::string path_;
  RawlogOptions options_;
  Overview overview_;
  bool imu_found_ = false;
  bool gyro_found_ = false, accel_found_ = false;  // alone
  int halves_ = 0;
  bool gnss_found_ = false;
  int64_t imus_ = 0;
  int64_t gps_ = 0;
};

/// First and last stamp of a stream.
struct Span {
  int64_t first_ns = std::numeric_limits<int64_t>::max();
  int64_t last_ns = std::numeric_limits<int64_t>::min();

  void add(int64_t t_ns) {
    first_ns = std::min(first_ns, t_ns);
    last_ns = std::max(last_ns, t_ns);
  }
  bool empty() const { return first_ns > last_ns; }
  bool overlaps(const Span& other) const {
    return first_ns <= other.last_ns && other.first_ns <= last_ns;
  }
};

bool same(const imu::ImuSample& a, const imu::ImuSample& b) {
  return a.t_ns == b.t_ns && a.gyro_b == b.gyro_b && a.accel_b == b.accel_b;
}

class MrptReading final : public LogReading {
 public:
  MrptReading(const std::string& path, imu::SampleKind samples, const RawlogOptions& options)
      : path_(path),
        options_(options),
        reorder_ns_(nanoseconds(options.reorder_s)),
        fix_delay_ns_(nanoseconds(options.fix_delay_s)),
        overview_(OverviewScan(path, options).run()),
        lever_arm_told_(mrpt_notes(path).lever_arm),
        mounting_{overview_.imu.q_v_s},
        lever_arm_(lever_arm_to(overview_.antenna)),
        stream_(path, options.reference_label),
        incrementer_(samples) {}

  std::optional<Measurement> next() override {
    while (!over_ && !settled()) read_one();
    return take_earliest();
  }

  std::vector<state::Notice> notices() const override;

  const state::Mounting& mounting() const override { return mounting_; }
  const Eigen::Vector3d& lever_arm() const override { return lever_arm_; }
  const std::string& imu_label() const override { return overview_.imu_label; }
  const std::string& gnss_label() const override { return overview_.gnss_label; }
  const SourceCounts& counts() const override { return counts_; }
  const std::optional<std::string>& damage() const override { return stream_.damage(); }
  double progress() const override { return stream_.progress(); }

 private:
  Eigen::Vector3d lever_arm_to(const rawlog::SensorPose& antenna) const {
    return overview_.imu.q_v_s.conjugate() * (antenna.p_v_s - overview_.imu.p_v_s);
  }

  /// The earliest measurement can no longer be preceded by one that is still to come.
  bool settled() const;
  std::optional<Measurement> take_earliest();
  /// The velocity of a reference moved to the IMU, too: v + omega x arm.
  void swing(ReferencePose& pose) const;
  void read_one();
  void dispatch(const LoggedObservation& logged, int64_t t_ns);
  void take_imu(const rawlog::ImuRecord& imu, int64_t record, int64_t t_ns);
  void take_half(const rawlog::ImuRecord& imu, int64_t record, int64_t t_ns);
  void take_sample(const imu::ImuSample& sample, int64_t record);
  void put_in_order(const imu::ImuSample& sample, int64_t record);
  void convert_until(int64_t t_ns);
  void convert(const imu::ImuSample& sample, int64_t stamp_ns);
  void take_gps(const mrpt::obs::CObservationGPS& gps, int64_t t_ns);
  void take_velocity(const mrpt::obs::CObservationGPS& gps, int64_t t_ns);
  void take_heading(const mrpt::obs::CObservationRobotPose& pose, int64_t t_ns);
  /// Fixes at a stamp of the log that wait to be given out.
  std::vector<GnssFix*> fixes_at(int64_t t_ns);
  const rawlog::SensorPose& pose_of(const rawlog::InsRecord& ins);
  void take_reference(const ReferencePose& pose, const rawlog::SensorPose& from,
                      std::string_view type);
  void take_odometry(const mrpt::obs::CObservationOdometry& odometry, int64_t t_ns);
  /// False if it comes too late to be put in order.
  bool add(const Measurement& measurement);
  void skip(std::string_view type, std::string_view reason = {});
  /// The same, with the stamp of the first in the notices.
  void skip_noted(std::string_view type, std::string_view reason, int64_t t_ns);
  void skip_backward(int64_t record, int64_t t_ns);
  void end();
  void check_overlap() const;
  [[noreturn]] void fail(int64_t record, int64_t t_ns, const std::string& what) const;

  std::string path_;
  RawlogOptions options_;
  int64_t reorder_ns_;
  int64_t fix_delay_ns_;
  Overview overview_;
  std::string lever_arm_told_;  ///< as RecordingNotes
  state::Mounting mounting_;
  Eigen::Vector3d lever_arm_;
  rawlog::RawlogStream stream_;
  imu::Incrementer incrementer_;
  SourceCounts counts_;

  ImuHalves halves_;
  int64_t newest_accel_ns_ = std::numeric_limits<int64_t>::min();
  std::optional<imu::ImuSample> ahead_;  ///< far after the one before it; the next one tells
  std::deque<imu::ImuSample> samples_;   ///< by stamp; others may still come between them
  imu::BurstStamps even_stamps_;
  std::optional<imu::ImuSample> last_sample_;  ///< of those that are increments now, as recorded
  std::optional<int64_t> last_stamp_ns_;       ///< its stamp made even
  int backward_in_a_row_ = 0;
  std::deque<ImuIncrement> increments_;
  std::multimap<int64_t, Measurement> others_;
  std::map<int64_t, rawlog::GroundVelocity> waiting_velocities_;  ///< their fixes are still to come
  std::map<int64_t, GnssHeading> waiting_headings_;               ///< the same
  std::vector<unsigned char> ins_pose_bytes_;                     ///< of the InsRecord before
  rawlog::SensorPose ins_pose_;
  Eigen::Vector3d reference_arm_v_ = Eigen::Vector3d::Zero();  ///< reference to IMU
  imu::RecentRates rates_{imu::kLeverArmRateMemory};           ///< of what was released
  int64_t newest_imu_ns_ = std::numeric_limits<int64_t>::min();
  int64_t released_ns_ = std::numeric_limits<int64_t>::min();
  int64_t released_increment_ns_ = std::numeric_limits<int64_t>::min();
  std::optional<int64_t> first_late_ns_;
  std::map<std::string, int64_t> first_skipped_ns_;  // keys as in counts_.skipped
  Span imu_span_;
  Span fix_span_;
  bool over_ = false;
};

bool MrptReading::settled() const {
  int64_t earliest_ns = std::numeric_limits<int64_t>::max();
  if (!increments_.empty()) earliest_ns = increments_.front().t_end_ns;
  if (!others_.empty()) earliest_ns = std::min(earliest_ns, others_.begin()->first);
  return newest_imu_ns_ != std::numeric_limits<int64_t>::min() &&
         earliest_ns <= newest_imu_ns_ - reorder_ns_;
}

std::optional<Measurement> MrptReading::take_earliest() {
  const bool other_first =
      !others_.empty() &&
      (increments_.empty() || others_.begin()->first <= increments_.front().t_end_ns);
  if (other_first) {
    Measurement measurement = std::move(others_.begin()->second);
    released_ns_ = others_.begin()->first;
    others_.erase(others_.begin());
    if (auto* pose = std::get_if<ReferencePose>(&measurement)) swing(*pose);
    return measurement;
  }
  if (increments_.empty()) return std::nullopt;
  const ImuIncrement increment = increments_.front();
  increments_.pop_front();
  rates_.add(increment);
  released_ns_ = increment.t_end_ns;
  released_increment_ns_ = increment.t_end_ns;
  return increment;
}

/// The Earth's rate and the gyroscopes' biases are left in: 1 mm/s for an arm of 2 m.
void MrptReading::swing(ReferencePose& pose) const {
  if (!pose.velocity_n || !pose.q_n_v || reference_arm_v_.squaredNorm() == 0) return;
  const Eigen::Vector3d omega_v = mounting_.q_v_b * rates_.gyro_b;
  *pose.velocity_n += *pose.q_n_v * omega_v.cross(reference_arm_v_);
}

void MrptReading::read_one() {
  const std::optional<LoggedObservation> logged = stream_.next();
  if (!logged) {
    over_ = true;
    end();
  } else if (!logged->imu && !logged->ins && !logged->observation) {
    skip(logged->type);
  } else if (!logged->t_ns) {
    skip(logged->type, "no stamp");
  } else {
    dispatch(*logged, *logged->t_ns);
  }
}

void MrptReading::dispatch(const LoggedObservation& logged, int64_t t_ns) {
  if (logged.imu) return take_imu(*logged.imu, logged.record, t_ns);
  if (logged.ins) {
    return take_reference(rawlog::decode_reference(*logged.ins, t_ns), pose_of(*logged.ins), kGps);
  }
  if (const auto* gps = as_gps(logged)) return take_gps(*gps, t_ns);
  const mrpt::obs::CObservation* observation = logged.observation.get();
  if (const auto* odometry = dynamic_cast<const mrpt::obs::CObservationOdometry*>(observation)) {
    return take_odometry(*odometry, t_ns);
  }
  const auto* pose = dynamic_cast<const mrpt::obs::CObservationRobotPose*>(observation);
  if (pose != nullptr && pose->sensorLabel == options_.reference_label) {
    return take_reference(rawlog::decode_reference(*pose, overview_.first_fix, t_ns),
                          rawlog::from_mrpt(pose->sensorPose), logged.type);
  }
  if (pose != nullptr && pose->sensorLabel == kHeadingLabel) return take_heading(*pose, t_ns);
  if (notes_comment(logged) == nullptr) skip(logged.type);
}

void MrptReading::take_imu(const rawlog::ImuRecord& imu, int64_t record, int64_t t_ns) {
  if (overview_.imu_halves) return take_half(imu, record, t_ns);
  if (imu.label != overview_.imu_label) return skip(kImu, "another label");
  if (!imu.sample) return skip(kImu, "no gyroscope or no accelerometer");
  imu::ImuSample sample = *imu.sample;
  sample.t_ns = t_ns;
  if (!finite(sample)) return skip_noted(kImu, kNotFinite, t_ns);
  take_sample(sample, record);
}

void MrptReading::take_half(const rawlog::ImuRecord& imu, int64_t record, int64_t t_ns) {
  const std::optional<Eigen::Vector3d>& half = imu.gyro_b ? imu.gyro_b : imu.accel_b;
  const std::string& label = imu.gyro_b ? overview_.imu_label : overview_.accel_label;
  if (!half || imu.label != label) return skip(kImu, "another label");
  if (!half->allFinite()) return skip_noted(kImu, kNotFinite, t_ns);
  if (imu.gyro_b) {
    halves_.add_gyro(t_ns, *half);
  } else {
    halves_.add_accel(t_ns, *half);
    newest_accel_ns_ = std::max(newest_accel_ns_, t_ns);
  }
  for (const imu::ImuSample& sample : halves_.take(newest_accel_ns_)) take_sample(sample, record);
}

/// A stamp far ahead is a hole if the next goes on from there, else a slip of the clock.
void MrptReading::take_sample(const imu::ImuSample& sample, int64_t record) {
  if (const std::optional<imu::ImuSample> ahead = std::exchange(ahead_, std::nullopt)) {
    if (sample.t_ns >= ahead->t_ns) {
      put_in_order(*ahead, record);
    } else {
      skip_noted(kImu, "stamp ahead of those that follow", ahead->t_ns);
    }
  }
  constexpr int64_t kFarAhead = kNanosecondsPerSecond;
  const bool any = newest_imu_ns_ != std::numeric_limits<int64_t>::min();
  if (any && sample.t_ns - newest_imu_ns_ > kFarAhead) {
    ahead_ = sample;
  } else {
    put_in_order(sample, record);
  }
}

void MrptReading::put_in_order(const imu::ImuSample& sample, int64_t record) {
  if (last_sample_ && sample.t_ns <= last_sample_->t_ns) {
    if (same(sample, *last_sample_)) {
      ++counts_.imu_duplicates;
      return;
    }
    return skip_backward(record, sample.t_ns);
  }
  backward_in_a_row_ = 0;
  auto place = samples_.end();
  while (place != samples_.begin() && std::prev(place)->t_ns > sample.t_ns) --place;
  for (auto it = place; it != samples_.begin() && std::prev(it)->t_ns == sample.t_ns; --it) {
    if (!same(sample, *std::prev(it))) continue;
    ++counts_.imu_duplicates;
    return;
  }
  if (place != samples_.end()) ++counts_.imu_reordered;
  samples_.insert(place, sample);
  ++counts_.imu_samples;
  imu_span_.add(sample.t_ns);
  newest_imu_ns_ = std::max(newest_imu_ns_, sample.t_ns);
  convert_until(newest_imu_ns_ - reorder_ns_);
}

void MrptReading::convert_until(int64_t t_ns) {
  while (true) {
    const std::vector<int64_t>& stamps = even_stamps_.take(samples_, t_ns);
    if (stamps.empty()) return;
    for (const int64_t stamp_ns : stamps) {
      convert(samples_.front(), stamp_ns);
      samples_.pop_front();
    }
  }
}

void MrptReading::convert(const imu::ImuSample& sample, int64_t stamp_ns) {
  last_sample_ = sample;
  if (last_stamp_ns_ && stamp_ns <= *last_stamp_ns_) {
    --counts_.imu_samples;
    return skip_noted(kImu, "stamp comes twice", stamp_ns);
  }
  last_stamp_ns_ = stamp_ns;
  imu::ImuSample even = sample;
  even.t_ns = stamp_ns;
  if (const std::optional<ImuIncrement> increment = incrementer_.add(even)) {
    increments_.push_back(*increment);
  }
}

void MrptReading::take_gps(const mrpt::obs::CObservationGPS& gps, int64_t t_ns) {
  if (gps.sensorLabel == options_.reference_label) {
    const std::optional<ReferencePose> pose = rawlog::decode_reference(gps, t_ns);
    if (!pose) return skip(kGps, "reference without INSPVAS");
    return take_reference(*pose, rawlog::from_mrpt(gps.sensorPose), kGps);
  }
  if (receiver_of(gps.sensorLabel) != receiver_of(overview_.gnss_label)) {
    return skip(kGps, "another label");
  }
  std::optional<GnssFix> fix =
      overview_.by_rmc ? rawlog::decode_rmc(gps, t_ns) : rawlog::decode_fix(gps, t_ns);
  if (!fix) return take_velocity(gps, t_ns);
  const auto waiting = waiting_velocities_.find(t_ns);
  if (!fix->velocity_n && waiting != waiting_velocities_.end()) {
    fix->velocity_n = waiting->second.velocity_n;
    fix->velocity_covariance = waiting->second.covariance;
    waiting_velocities_.erase(waiting);
  }
  const auto heading = waiting_headings_.find(t_ns);
  if (heading != waiting_headings_.end()) {
    fix->heading = heading->second;
    waiting_headings_.erase(heading);
  }
  fix->p_b_a = lever_arm_to(rawlog::from_mrpt(gps.sensorPose));
  fix->lever_arm_known =
      lever_arm_told_ == "given" || (lever_arm_told_ == "not_told" && !fix->p_b_a.isZero());
  if (!is_finite(fix->antenna) || !fix->position_covariance.allFinite() ||
      !fix->p_b_a.allFinite()) {
    return skip_noted(kGps, kNotFinite, t_ns);
  }
  if (!is_position(fix->antenna)) {
    return skip_noted(kGps, "latitude and longitude zero, or out of range", t_ns);
  }
  if (fix->velocity_n && !velocity_finite(*fix)) {
    fix->velocity_n.reset();
    skip_noted("velocity of CObservationGPS", kNotFinite, t_ns);
  }
  fix->t_ns = t_ns - fix_delay_ns_;
  fix_span_.add(fix->t_ns);
  if (add(*fix)) ++counts_.fixes;
}

/// Of a sentence that was logged apart from its position.
void MrptReading::take_velocity(const mrpt::obs::CObservationGPS& gps, int64_t t_ns) {
  const std::optional<rawlog::GroundVelocity> velocity = rawlog::decode_velocity(gps);
  if (!velocity) return skip(kGps, "no position");
  for (GnssFix* fix : fixes_at(t_ns)) {
    if (fix->velocity_n) continue;
    fix->velocity_n = velocity->velocity_n;
    fix->velocity_covariance = velocity->covariance;
    return;
  }
  keep_waiting(t_ns, *velocity, waiting_velocities_);
}

void MrptReading::take_heading(const mrpt::obs::CObservationRobotPose& pose, int64_t t_ns) {
  const std::optional<GnssHeading> heading = rawlog::decode_heading(pose);
  if (!heading) return skip("CObservationRobotPose", "heading without a sigma");
  for (GnssFix* fix : fixes_at(t_ns)) {
    fix->heading = heading;
    return;
  }
  keep_waiting(t_ns, *heading, waiting_headings_);
}

std::vector<GnssFix*> MrptReading::fixes_at(int64_t t_ns) {
  std::vector<GnssFix*> fixes;
  const auto [begin, end] = others_.equal_range(t_ns - fix_delay_ns_);
  for (auto it = begin; it != end; ++it) {
    if (auto* fix = std::get_if<GnssFix>(&it->second)) fixes.push_back(fix);
  }
  return fixes;
}

/// It is the same in all records, as a rule.
const rawlog::SensorPose& MrptReading::pose_of(const rawlog::InsRecord& ins) {
  const Bytes& bytes = ins.pose;
  if (!std::equal(bytes.begin, bytes.end, ins_pose_bytes_.begin(), ins_pose_bytes_.end())) {
    ins_pose_bytes_.assign(bytes.begin, bytes.end);
    ins_pose_ = rawlog::from_mrpt(rawlog::pose_of(bytes));
  }
  return ins_pose_;
}

void MrptReading::take_reference(const ReferencePose& pose, const rawlog::SensorPose& from,
                                 std::string_view type) {
  const ReferencePose of_imu = rawlog::moved_to_imu(pose, from, overview_.imu.p_v_s);
  reference_arm_v_ = overview_.imu.p_v_s - from.p_v_s;
  if (!is_finite(of_imu.position)) return skip_noted(type, kNotFinite, pose.t_ns);
  if (add(of_imu)) ++counts_.references;
}

void MrptReading::take_odometry(const mrpt::obs::CObservationOdometry& odometry, int64_t t_ns) {
  if (!odometry.hasVelocities) return skip(kOdometry, "no velocity");
  if (!std::isfinite(odometry.velocityLocal.vx)) return skip_noted(kOdometry, kNotFinite, t_ns);
  if (add(WheelSpeed{t_ns, odometry.velocityLocal.vx})) ++counts_.wheel_speeds;
}

bool MrptReading::add(const Measurement& measurement) {
  const int64_t t_ns = stamp(measurement);
  if (t_ns < released_ns_ || t_ns <= released_increment_ns_) {
    ++counts_.late;
    if (!first_late_ns_) first_late_ns_ = t_ns;
    return false;
  }
  others_.emplace(t_ns, measurement);
  return true;
}

void MrptReading::skip(std::string_view type, std::string_view reason) {
  ++counts_.skipped[reason.empty() ? std::string(type) : fmt::format("{} ({})", type, reason)];
}

void MrptReading::skip_noted(std::string_view type, std::string_view reason, int64_t t_ns) {
  const std::string name = fmt::format("{} ({})", type, reason);
  ++counts_.skipped[name];
  first_skipped_ns_.emplace(name, t_ns);
}

/// A few are a recorder's hiccup; many in a row are a log that is not in order.
void MrptReading::skip_backward(int64_t record, int64_t t_ns) {
  constexpr int kMostInARow = 100;
  if (++backward_in_a_row_ > kMostInARow) {
    fail(record, t_ns,
         fmt::format(
             "{} IMU samples in a row come more than {:g} s after later ones, the last before "
             "them of {}; sort the log by time",
             backward_in_a_row_, options_.reorder_s, utc_text(last_sample_->t_ns)));
  }
  skip_noted(kImu, "comes too late", t_ns);
}

void MrptReading::end() {
  if (halves_.alone() > 0) counts_.skipped["CObservationIMU (no force near it)"] = halves_.alone();
  if (ahead_) put_in_order(*ahead_, stream_.records());
  convert_until(std::numeric_limits<int64_t>::max());
  const bool usable = counts_.imu_samples > 0 && counts_.fixes > 0;
  if (damage() && !usable) throw DataError(*damage());
  check_overlap();
}

void MrptReading::check_overlap() const {
  if (imu_span_.empty() || fix_span_.empty()) {
    throw DataError(fmt::format("'{}': no {} of it is finite; see `foucault info`", path_,
                                imu_span_.empty() ? "IMU sample" : "GNSS fix"));
  }
  if (imu_span_.overlaps(fix_span_)) {
    if (counts_.fixes > 0) return;
    throw DataError(
        fmt::format("'{}': every fix comes more than {:g} s late; sort the log by time, or raise "
                    "rawlog.reorder_s",
                    path_, options_.reorder_s));
  }
  const double later_s = to_seconds(fix_span_.first_ns - imu_span_.first_ns);
  throw DataError(fmt::format(
      "'{}': IMU ({} to {}) and GNSS ({} to {}) do not overlap; GNSS begins {}", path_,
      utc_text(imu_span_.first_ns), utc_text(imu_span_.last_ns), utc_text(fix_span_.first_ns),
      utc_text(fix_span_.last_ns), describe_mismatch(later_s)));
}

void MrptReading::fail(int64_t record, int64_t t_ns, const std::string& what) const {
  throw DataError(fmt::format("'{}': record {} at {}: {}", path_, record, utc_text(t_ns), what));
}

std::vector<state::Notice> MrptReading::notices() const {
  std::vector<state::Notice> notices;
  if (overview_.by_rmc) {
    notices.push_back({fix_span_.first_ns, state::NoticeKind::skipped,
                       "the receiver tells positions by RMC only, without heights: zero is taken, "
                       "with a sigma of 1 km; log GGA as well"});
  }
  if (counts_.late > 0) {
    notices.push_back({*first_late_ns_, state::NoticeKind::skipped,
                       fmt::format("{} records came more than {:g} s late and were left out, the "
                                   "first of {}",
                                   counts_.late, options_.reorder_s, utc_text(*first_late_ns_))});
  }
  const int64_t begin_ns = counts_.imu_samples > 0 ? imu_span_.first_ns : 0;
  if (counts_.imu_duplicates > 0) {
    notices.push_back({begin_ns, state::NoticeKind::skipped,
                       fmt::format("{} IMU samples repeat the one before them and were left out",
                                   counts_.imu_duplicates)});
  }
  if (counts_.imu_reordered > 0) {
    notices.push_back(
        {begin_ns, state::NoticeKind::skipped,
         fmt::format("{} IMU samples came after later ones and were put in order by stamp",
                     counts_.imu_reordered)});
  }
  if (const std::optional<std::string> bursts = even_stamps_.summary()) {
    notices.push_back({even_stamps_.first_ns(), state::NoticeKind::skipped, *bursts});
  }
  for (const auto& [name, count] : counts_.skipped) {
    const auto first = first_skipped_ns_.find(name);
    const bool known = first != first_skipped_ns_.end();
    notices.push_back(
        {known ? first->second : begin_ns, state::NoticeKind::skipped,
         fmt::format("{} x {} not used{}", count, name, known ? ", the first here" : "")});
  }
  return notices;
}

}  // namespace

std::unique_ptr<LogReading> mrpt_reading(const std::string& path, imu::SampleKind samples,
                                         const RawlogOptions& options) {
  return std::make_unique<MrptReading>(path, samples, options);
}

}  // namespace foucault::rawlog
