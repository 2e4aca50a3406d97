#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "files.h"
#include "foucault/core/error.h"
#include "foucault/core/position.h"
#include "foucault/core/time.h"
#include "foucault/rawlog/mrpt_convert.h"
#include "gz_archive.h"
#include "mrpt_entries.h"
#include "notes_comment.h"

namespace foucault::rawlog {

namespace {

void require_stamp(int64_t t_ns) {
  if (rawlog::in_range_of_stamps(t_ns)) return;
  throw DataError(
      fmt::format("the stamp {} is none of the years 1950 to 2150; check "
                  "the time system of the input",
                  utc_text(t_ns)));
}

/// Increment over the interval between the stamps as MRPT holds them.
imu::ImuSample mean_rates(const ImuIncrement& increment) {
  require_stamp(increment.t_begin_ns);
  require_stamp(increment.t_end_ns);
  const int64_t begin_ns = rawlog::quantized(increment.t_begin_ns);
  const int64_t end_ns = rawlog::quantized(increment.t_end_ns);
  if (end_ns <= begin_ns) {
    throw DataError(
        fmt::format("the IMU interval that ends at {} is shorter than 100 ns; remove it",
                    utc_text(increment.t_end_ns)));
  }
  const double dt = static_cast<double>(end_ns - begin_ns) * 1e-9;
  return {end_ns, increment.dtheta_b / dt, increment.dvel_b / dt};
}

}  // namespace

class MrptWriting final : public LogWriting {
 public:
  MrptWriting(const std::string& path, const state::Mounting& mounting, WrittenValues values)
      : file_(path), archive_(file_), mounting_(mounting), values_(values) {
    imu_.sensorLabel = "IMU";
    imu_.sensorPose = rawlog::to_mrpt({mounting.q_v_b, Eigen::Vector3d::Zero()});
    gnss_.sensorLabel = "GNSS";
    reference_.sensorLabel = "REFERENCE";
    heading_.sensorLabel = kHeadingLabel;
    odometry_.sensorLabel = "ODOMETRY";
    odometry_.hasVelocities = true;
  }

  void write(const RecordingNotes& told) override {
    RecordingNotes notes = told;  // its fields are visited
    notes_.emplace();
    notes_->sensorLabel = "FOUCAULT";
    notes_->text = kNotesTitle + dump_config(notes);
  }

  void write(const imu::ImuSample& sample) override {
    require_stamp(sample.t_ns);
    require(sample.gyro_b.allFinite() && sample.accel_b.allFinite(), "the IMU sample", sample.t_ns);
    rawlog::encode_imu(sample, imu_);
    put(imu_);
    imu_begun_ = true;
  }

  void write(const ImuIncrement& increment) override {
    const imu::ImuSample sample = mean_rates(increment);
    if (!imu_begun_) write(imu::ImuSample{increment.t_begin_ns, sample.gyro_b, sample.accel_b});
    write(sample);
  }

  void write(const GnssFix& fix) override {
    require_stamp(fix.t_ns);
    require(is_finite(fix.antenna) && fix.position_covariance.allFinite() &&
                (!fix.velocity_n ||
                 (fix.velocity_n->allFinite() && fix.velocity_covariance.allFinite())) &&
                (!fix.heading || std::isfinite(fix.heading->azimuth + fix.heading->sigma)) &&
                fix.p_b_a.allFinite(),
            "the GNSS fix", fix.t_ns);
    if (!lever_arm_ || *lever_arm_ != fix.p_b_a) set_lever_arm(fix.p_b_a);
    gnss_.timestamp = rawlog::to_mrpt(fix.t_ns);
    gnss_.originalReceivedTimestamp = gnss_.timestamp;
    rawlog::encode_fix(fix, gnss_);
    if (fix.heading) {
      heading_.timestamp = gnss_.timestamp;
      rawlog::encode_heading(*fix.heading, heading_);
      put(heading_);
    }
    put(gnss_);
  }

  void write(const ReferencePose& pose) override {
    require_stamp(pose.t_ns);
    require(is_finite(pose.position), "the reference pose", pose.t_ns);
    reference_.timestamp = rawlog::to_mrpt(pose.t_ns);
    reference_.originalReceivedTimestamp = reference_.timestamp;
    rawlog::encode_reference(pose, reference_);
    put(reference_);
  }

  void write(const WheelSpeed& speed) override {
    require_stamp(speed.t_ns);
    require(std::isfinite(speed.forward), "the wheel speed", speed.t_ns);
    odometry_.timestamp = rawlog::to_mrpt(speed.t_ns);
    odometry_.velocityLocal.vx = speed.forward;
    put(odometry_);
  }

  void finish() override {
    archive_.close();
    file_.commit();
  }

 private:
  /// Notes take the stamp of what they precede.
  void put(const mrpt::obs::CObservation& observation) {
    if (notes_) {
      notes_->timestamp = observation.timestamp;
      archive_.put(*notes_);
      notes_.reset();
    }
    archive_.put(observation);
  }

  void require(bool ok, const char* what, int64_t t_ns) const {
    if (ok || values_ == WrittenValues::any) return;
    throw DataError(
        fmt::format("{} at {} is not finite; remove it from the input", what, utc_text(t_ns)));
  }

  void set_lever_arm(const Eigen::Vector3d& p_b_a) {
    const Eigen::Quaterniond forward_left_up(0, 1, 0, 0);  // an antenna has no axes of its own
    gnss_.sensorPose = rawlog::to_mrpt({forward_left_up, mounting_.q_v_b * p_b_a});
    lever_arm_ = p_b_a;
  }

  rawlog::PendingFile file_;
  rawlog::GzWriteArchive archive_;
  state::Mounting mounting_;
  WrittenValues values_;
  mrpt::obs::CObservationIMU imu_;
  mrpt::obs::CObservationGPS gnss_;
  mrpt::obs::CObservationGPS reference_;
  mrpt::obs::CObservationRobotPose heading_;
  mrpt::obs::CObservationOdometry odometry_;
  std::optional<mrpt::obs::CObservationComment> notes_;  ///< still to be written
  std::optional<Eigen::Vector3d> lever_arm_;
  bool imu_begun_ = false;
};

std::unique_ptr<LogWriting> mrpt_writing(const std::string& path, const state::Mounting& mounting,
                                         WrittenValues values) {
  return std::make_unique<MrptWriting>(path, mounting, values);
}

}  // namespace foucault::rawlog
