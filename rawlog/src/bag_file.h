#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "binary_file.h"

/// rosbag, format 2.0, as wiki.ros.org describes it ("Bags/Format/2.0"): connections and messages.
namespace foucault::rawlog {

/// Who publishes what.
struct BagConnection {
  std::string topic;
  std::string type;        ///< e.g. sensor_msgs/Imu
  std::string definition;  ///< text of the message type and of those within
};
using BagConnections = std::map<uint32_t, BagConnection>;

/// A message, until the next one is read.
struct BagMessage {
  uint32_t connection = 0;
  int64_t recorded_ns = 0;
  Bytes bytes;
};

/// Reads the messages of a bag one after the other; chunks may be compressed by bz2 or lz4.
class BagFile {
 public:
  /// Throws DataError if the file is no bag of this format.
  explicit BagFile(const std::string& path);

  /// None at the end. Throws RowError and goes on behind it, or ends.
  std::optional<BagMessage> next();

  const BinaryFile& file() const { return file_; }
  /// Those read so far.
  const BagConnections& connections() const { return connections_; }

 private:
  using Header = std::map<std::string, Bytes>;

  bool read_record(Header& header);
  bool read_part(std::vector<unsigned char>& bytes);
  Header header_of(Bytes bytes) const;
  template <class T>
  T number(const Header& header, const std::string& key) const;
  std::optional<BagMessage> message_of(const Header& header, Bytes data);
  void connect(const Header& header, Bytes data);
  void open_chunk(const Header& header);
  std::optional<BagMessage> next_in_chunk();

  BinaryFile file_;
  std::vector<unsigned char> header_, data_, chunk_;
  Bytes left_;  ///< of the chunk
  BagConnections connections_;
};

/// The connections of a whole bag, good up to its first damage.
BagConnections connections_of(const std::string& path);

}  // namespace foucault::rawlog
