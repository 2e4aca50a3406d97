#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "foucault/rawlog/rawlog_info.h"
#include "foucault/rawlog/rawlog_source.h"
#include "foucault/rawlog/rawlog_writer.h"
#include "foucault/rawlog/recording_notes.h"

/// What speaks MRPT's classes is a library of its own, since MRPT brings 130 others: who links
/// foucault::rawlog has it, the program loads it when it first reads or writes a log.
namespace foucault::rawlog {

/// RawlogSource, as it is there.
class LogReading {
 public:
  virtual ~LogReading() = default;
  virtual std::optional<Measurement> next() = 0;
  virtual const state::Mounting& mounting() const = 0;
  virtual double progress() const = 0;
  virtual const Eigen::Vector3d& lever_arm() const = 0;
  virtual const std::string& imu_label() const = 0;
  virtual const std::string& gnss_label() const = 0;
  virtual const SourceCounts& counts() const = 0;
  virtual std::vector<state::Notice> notices() const = 0;
  virtual const std::optional<std::string>& damage() const = 0;
};

/// RawlogWriter, as it is there.
class LogWriting {
 public:
  virtual ~LogWriting() = default;
  virtual void write(const RecordingNotes& notes) = 0;
  virtual void write(const imu::ImuSample& sample) = 0;
  virtual void write(const ImuIncrement& increment) = 0;
  virtual void write(const GnssFix& fix) = 0;
  virtual void write(const ReferencePose& pose) = 0;
  virtual void write(const WheelSpeed& speed) = 0;
  virtual void finish() = 0;
};

/// Its entries.
struct MrptPart {
  std::unique_ptr<LogReading> (*reading)(const std::string& path, imu::SampleKind samples,
                                         const RawlogOptions& options);
  std::unique_ptr<LogWriting> (*writing)(const std::string& path, const state::Mounting& mounting,
                                         WrittenValues values);
  RawlogInfo (*info)(const std::string& path, const std::function<void(double)>& progress);
  RecordingNotes (*notes)(const std::string& path);
};

}  // namespace foucault::rawlog

/// Where it begins; null in a program that has yet to load it.
extern "C" [[gnu::weak, gnu::visibility("default")]] const foucault::rawlog::MrptPart*
foucault_mrpt_part();
