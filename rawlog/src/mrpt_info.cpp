#include <algorithm>
#include <cmath>
#include <utility>

#include "foucault/core/hole.h"
#include "foucault/imu/burst_stamps.h"
#include "foucault/rawlog/mrpt_convert.h"
#include "mrpt_entries.h"
#include "notes_comment.h"
#include "rawlog_stream.h"

namespace foucault::rawlog {

using rawlog::LoggedObservation;

namespace {

constexpr size_t kListedGaps = 20;

/// Distribution of intervals, to 0.1 %: bins of equal ratio that know the mean of what fell in.
class Intervals {
 public:
  void add(double seconds) {
    Bin& bin = bins_[static_cast<int>(std::floor(std::log(seconds) * kBinsPerLog))];
    ++bin.count;
    bin.sum += seconds;
    ++count_;
  }

  double median() const {
    int64_t below = 0;
    for (const auto& [index, bin] : bins_) {
      below += bin.count;
      if (2 * below >= count_) return bin.sum / static_cast<double>(bin.count);
    }
    return 0;
  }

  int64_t longer_than(double seconds) const {
    int64_t count = 0;
    for (const auto& [index, bin] : bins_) {
      if (bin.sum > seconds * static_cast<double>(bin.count)) count += bin.count;
    }
    return count;
  }

 private:
  static constexpr double kBinsPerLog = 1000;
  struct Bin {
    int64_t count = 0;
    double sum = 0;
  };
  std::map<int, Bin> bins_;
  int64_t count_ = 0;
};

/// The longest intervals seen.
class LongestIntervals {
 public:
  void add(const Gap& gap) {
    if (gaps_.size() == kListedGaps && gap.length <= gaps_.back().length) return;
    const auto longer = [](const Gap& a, const Gap& b) { return a.length > b.length; };
    gaps_.insert(std::upper_bound(gaps_.begin(), gaps_.end(), gap, longer), gap);
    if (gaps_.size() > kListedGaps) gaps_.pop_back();
  }

  std::vector<Gap> in_time_order(double longer_than) const {
    std::vector<Gap> gaps;
    std::copy_if(gaps_.begin(), gaps_.end(), std::back_inserter(gaps),
                 [&](const Gap& gap) { return gap.length > longer_than; });
    std::sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.t_ns < b.t_ns; });
    return gaps;
  }

 private:
  std::vector<Gap> gaps_;  // longest first
};

/// Collects a StreamInfo.
class StreamStatistics {
 public:
  StreamStatistics(std::string label, std::string type) {
    info_.label = std::move(label);
    info_.type = std::move(type);
  }

  void add(const std::optional<int64_t>& t_ns) {
    ++info_.count;
    if (!t_ns) {
      ++info_.without_stamp;
      return;
    }
    if (last_ns_) {
      add_interval(*last_ns_, *t_ns);
      info_.first_ns = std::min(info_.first_ns, *t_ns);
      info_.last_ns = std::max(info_.last_ns, *t_ns);
    } else {
      info_.first_ns = *t_ns;
      info_.last_ns = *t_ns;
    }
    last_ns_ = t_ns;
    look_for_bursts(*t_ns);
  }

  StreamInfo result() const {
    StreamInfo info = info_;
    info.median_interval = bursts_ ? bursts_->interval_s : intervals_.median();
    info.burst_samples = bursts_ ? bursts_->samples : 0;
    const double usual = bursts_ ? bursts_->samples * bursts_->interval_s : info.median_interval;
    info.gap_count = intervals_.longer_than(kHoleIntervals * usual);
    info.longest_gaps = longest_.in_time_order(kHoleIntervals * usual);
    return info;
  }

 private:
  void look_for_bursts(int64_t t_ns) {
    constexpr size_t kLookedAt = 400;
    if (info_.type.rfind("CObservationIMU", 0) != 0) return;
    recent_.push_back(t_ns);
    if (recent_.size() < kLookedAt) return;
    if (const std::optional<imu::BurstPattern> pattern = imu::burst_pattern(recent_))
      bursts_ = pattern;
    recent_.clear();
  }

  void add_interval(int64_t before_ns, int64_t now_ns) {
    if (now_ns == before_ns) {
      ++info_.duplicates;
    } else if (now_ns < before_ns) {
      ++info_.backward;
    } else {
      const double seconds = static_cast<double>(now_ns - before_ns) * 1e-9;
      intervals_.add(seconds);
      longest_.add({before_ns, seconds});
    }
  }

  StreamInfo info_;
  Intervals intervals_;
  LongestIntervals longest_;
  std::vector<int64_t> recent_;
  std::optional<imu::BurstPattern> bursts_;
  std::optional<int64_t> last_ns_;
};

void add_sigma(const Eigen::Vector3d& sigma, bool first, GnssInfo& info) {
  info.min_sigma = first ? sigma : Eigen::Vector3d(info.min_sigma.cwiseMin(sigma));
  info.max_sigma = first ? sigma : Eigen::Vector3d(info.max_sigma.cwiseMax(sigma));
}

/// Builds a RawlogInfo, observation by observation.
class Collector {
 public:
  explicit Collector(RawlogInfo& info) : info_(info) {}

  void add(const LoggedObservation& logged) {
    info_.sensory_frames = info_.sensory_frames || logged.in_frame;
    if (!logged.imu && !logged.observation) {
      ++info_.other_records[std::string(logged.type)];
      return;
    }
    if (notes_comment(logged) != nullptr) return;
    statistics(logged).add(logged.t_ns);
    if (logged.imu) return add_imu(*logged.imu);
    const auto* gps = dynamic_cast<const mrpt::obs::CObservationGPS*>(logged.observation.get());
    if (gps != nullptr) add_gps(*gps, logged.t_ns.value_or(0));
  }

  void finish() {
    if (!imu_pose_ && gyro_pose_ && has_accel_) {
      imu_pose_ = gyro_pose_;
      info_.imu_label = gyro_label_;
      info_.mounting = state::Mounting{imu_pose_->q_v_s};
    }
    for (const auto& [key, statistics] : streams_) info_.streams.push_back(statistics.result());
    for (auto& [label, receiver] : receivers_) {
      if (imu_pose_ && receiver.antenna) set_lever_arm(*receiver.antenna, receiver.info);
      info_.receivers.push_back(receiver.info);
    }
  }

 private:
  struct Receiver {
    GnssInfo info;
    std::optional<rawlog::SensorPose> antenna;
    bool has_sigma = false;
  };

  StreamStatistics& statistics(const LoggedObservation& logged) {
    const std::string label(logged.label());
    const std::string type = std::string(logged.type) + half_of(logged.imu);
    return streams_.try_emplace({label, type}, label, type).first->second;
  }

  /// Gyroscopes and accelerometers in records of their own are streams of their own.
  static const char* half_of(const std::optional<rawlog::ImuRecord>& imu) {
    if (imu && imu->gyro_b) return " (rates)";
    return imu && imu->accel_b ? " (forces)" : "";
  }

  void add_imu(const rawlog::ImuRecord& imu) {
    has_accel_ = has_accel_ || imu.accel_b;
    if (imu.gyro_b && !gyro_pose_) {
      gyro_pose_ = rawlog::from_mrpt(rawlog::pose_of(imu.pose));
      gyro_label_ = imu.label;
    }
    if (!imu.sample) return;
    if (!imu_pose_) {
      imu_pose_ = rawlog::from_mrpt(rawlog::pose_of(imu.pose));
      info_.imu_label = imu.label;
      info_.mounting = state::Mounting{imu_pose_->q_v_s};
    }
    if (imu.sample->gyro_b.allFinite() && imu.sample->accel_b.allFinite()) return;
    if (info_.imu_not_finite++ == 0) info_.first_imu_not_finite_ns = imu.t_ns.value_or(0);
  }

  void add_gps(const mrpt::obs::CObservationGPS& gps, int64_t t_ns) {
    if (rawlog::decode_reference(gps, 0)) return;
    Receiver& receiver = receivers_[gps.sensorLabel];
    receiver.info.label = gps.sensorLabel;
    const std::optional<GnssFix> fix = rawlog::decode_fix(gps, t_ns);
    if (!fix) {
      ++receiver.info.without_position;
      return;
    }
    add_fix(*fix, receiver);
    if (!receiver.antenna) receiver.antenna = rawlog::from_mrpt(gps.sensorPose);
  }

  static void add_fix(const GnssFix& fix, Receiver& receiver) {
    GnssInfo& info = receiver.info;
    if (!std::isfinite(fix.antenna.latitude) || !std::isfinite(fix.antenna.longitude) ||
        !std::isfinite(fix.antenna.height)) {
      if (info.not_finite++ == 0) info.first_not_finite_ns = fix.t_ns;
      return;
    }
    if (info.qualities.empty()) info.first = fix.antenna;
    info.last = fix.antenna;
    ++info.qualities[fix.quality];
    if (fix.velocity_n) ++info.with_velocity;
    const Eigen::Vector3d variance = fix.position_covariance.diagonal();
    if (!variance.allFinite() || variance.minCoeff() <= 0) {
      ++info.bad_sigma;
      return;
    }
    add_sigma(variance.cwiseSqrt(), !std::exchange(receiver.has_sigma, true), info);
  }

  void set_lever_arm(const rawlog::SensorPose& antenna, GnssInfo& receiver) const {
    receiver.p_v = antenna.p_v_s - imu_pose_->p_v_s;
    receiver.p_b_a = imu_pose_->q_v_s.conjugate() * *receiver.p_v;
  }

  RawlogInfo& info_;
  std::map<std::pair<std::string, std::string>, StreamStatistics> streams_;
  std::map<std::string, Receiver> receivers_;
  std::optional<rawlog::SensorPose> imu_pose_;
  std::optional<rawlog::SensorPose> gyro_pose_;  ///< of a gyroscope without forces in its records
  std::string gyro_label_;
  bool has_accel_ = false;
};

}  // namespace

RawlogInfo mrpt_info(const std::string& path, const std::function<void(double)>& progress) {
  constexpr int64_t kObservationsPerReport = 2000;
  RawlogInfo info;
  rawlog::RawlogStream stream(path);
  Collector collector(info);
  int64_t observations = 0;
  while (const std::optional<LoggedObservation> logged = stream.next()) {
    collector.add(*logged);
    if (progress && ++observations % kObservationsPerReport == 0) progress(stream.progress());
  }
  collector.finish();
  info.path = path;
  info.file_bytes = static_cast<int64_t>(stream.file_size());
  info.compressed = stream.compressed();
  info.records = stream.records();
  info.damage = stream.damage();
  for (const auto& [type, count] : stream.other_records()) info.other_records[type] += count;
  if (progress) progress(1);
  return info;
}

}  // namespace foucault::rawlog
