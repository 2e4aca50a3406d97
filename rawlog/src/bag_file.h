#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "ros_recording.h"

namespace foucault::rawlog {

/// rosbag, format 2.0, as wiki.ros.org describes it ("Bags/Format/2.0"); chunks may be compressed
/// by bz2 or lz4.
class BagFile : public RosRecording {
 public:
  /// What the file begins with.
  static constexpr std::string_view kMagic = "#ROSBAG V2.0\n";

  /// Throws DataError if the file is no bag of this format. Messages name it `named`.
  BagFile(const std::string& path, const std::string& named);

  std::optional<RosMessage> next() override;
  bool read_index() override;
  const BinaryFile& file() const override { return file_; }
  const Place& place() const override { return file_; }

 private:
  using Header = std::map<std::string, Bytes>;

  bool read_record(Header& header);
  bool read_part(std::vector<unsigned char>& bytes);
  Header header_of(Bytes bytes) const;
  template <class T>
  T number(const Header& header, const std::string& key) const;
  std::optional<RosMessage> message_of(const Header& header, Bytes data);
  void connect(const Header& header, Bytes data);
  void open_chunk(const Header& header);
  std::optional<RosMessage> next_in_chunk();
  bool read_connections();

  BinaryFile file_;
  std::vector<unsigned char> header_, data_, chunk_;
  Bytes left_;  ///< of the chunk
};

}  // namespace foucault::rawlog
