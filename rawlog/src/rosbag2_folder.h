#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ros_recording.h"

namespace foucault::rawlog {

/// A folder of rosbag 2: its files one after the other, in the order of its metadata.yaml. Where
/// that is missing, since the recording was cut off, all files in it, by the numbers in their
/// names.
class RosbagFolder : public RosRecording, public InputFile, public Place {
 public:
  /// Throws DataError if there is no file to read.
  RosbagFolder(const std::string& path, RosLog& log);

  std::optional<RosMessage> next() override;
  bool read_index() override;
  const InputFile& file() const override { return *this; }
  const Place& place() const override { return *this; }
  std::vector<std::string> notices() const override;

  const std::string& path() const override { return path_; }
  int64_t position() const override;
  std::string place(int64_t position) const override;
  double progress() const override;

 private:
  std::string where() const override;
  void begin_file();
  void end_file();
  void add_topics();
  uint32_t number_of(const RosTopic& topic);

  std::string path_;
  RosLog& log_;
  std::vector<std::string> files_;
  size_t at_ = 0;  ///< the file that is read
  std::unique_ptr<RosRecording> current_;
  std::map<uint32_t, uint32_t> numbers_;  ///< of topics, by those of the current file
  std::vector<std::string> notices_;
};

}  // namespace foucault::rawlog
