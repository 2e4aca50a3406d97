#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "binary_file.h"
#include "files.h"
#include "ros_layout.h"

namespace foucault::rawlog {

/// Who publishes what.
struct RosTopic {
  std::string name;
  RosType type;
  std::optional<uint64_t> messages;  ///< if the recording tells
};
/// By the number that its messages call it by.
using RosTopics = std::map<uint32_t, RosTopic>;

/// A message, until the next one is read.
struct RosMessage {
  uint32_t topic = 0;
  int64_t recorded_ns = 0;
  Bytes bytes;
};

/// What a recording says, in a message, which is one line.
std::string one_line(std::string text);

/// Messages of ROS in the order in which they were recorded, whatever the format.
class RosRecording {
 public:
  virtual ~RosRecording() = default;

  /// None at the end. Throws RowError and goes on behind it, or ends.
  virtual std::optional<RosMessage> next() = 0;
  /// Makes all topics known and ends. False if there is no index that tells them.
  virtual bool read_index() = 0;
  virtual const InputFile& file() const = 0;
  virtual const Place& place() const = 0;
  /// What was found on the way.
  virtual std::vector<std::string> notices() const { return {}; }

  /// Those known so far.
  const RosTopics& topics() const { return topics_; }
  /// From here on only messages of topics with these names come, and of those that nobody defines.
  void select(std::set<std::string> names) { selected_ = std::move(names); }

 protected:
  bool is_selected(uint32_t topic) const;

  RosTopics topics_;
  std::optional<std::set<std::string>> selected_;  ///< all if there is none
};

/// Of a whole recording, as far as it is not damaged; it is opened once or twice.
RosTopics topics_of(const std::function<std::unique_ptr<RosRecording>()>& open);

/// Where a recording lies: a file of a bag of ROS 1, MCAP or rosbag 2 (sqlite3), found out by its
/// first bytes, or a folder of rosbag 2 with files of these. Files compressed by zstd are inflated
/// into temporary ones.
class RosLog {
 public:
  /// Throws DataError.
  explicit RosLog(std::string path);

  /// To be read from the beginning; not longer than this lives. Throws DataError.
  std::unique_ptr<RosRecording> open();
  /// One file of it.
  std::unique_ptr<RosRecording> open_file(const std::string& path);
  RosTopics topics();

 private:
  const std::string& inflated(const std::string& path);

  std::string path_;
  bool folder_ = false;
  std::map<std::string, std::unique_ptr<TemporaryFile>> inflated_;  ///< by the file of zstd
};

}  // namespace foucault::rawlog
