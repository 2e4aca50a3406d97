#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "ros_recording.h"

namespace foucault::rawlog {

/// MCAP, version 0, as mcap.dev/spec has it: channels of ROS 1 and 2, chunks plain or compressed by
/// lz4 or zstd. Checksums of chunks and of the data section are checked.
class McapFile : public RosRecording {
 public:
  /// What the file begins with.
  static constexpr std::string_view kMagic = "\x89MCAP0\r\n";

  /// Throws DataError if the file is none of this format. Messages name it `named`.
  McapFile(const std::string& path, const std::string& named);

  std::optional<RosMessage> next() override;
  bool read_index() override;
  const BinaryFile& file() const override { return file_; }
  const Place& place() const override { return file_; }
  std::vector<std::string> notices() const override;

 private:
  struct Schema {
    std::string name, encoding, text;
  };
  /// A record less its bytes.
  struct Head {
    uint8_t op = 0;
    uint64_t size = 0;
  };

  bool read(uint64_t count);
  bool skip(uint64_t count);
  bool read_head(Head& head);
  std::optional<RosMessage> next_in_file();
  std::optional<RosMessage> next_in_chunk();
  std::optional<RosMessage> take(uint8_t op, Bytes content);
  void take_schema(Bytes content);
  void take_channel(Bytes content);
  std::optional<RosMessage> take_message(Bytes content);
  void open_chunk();
  void end_of_data();
  bool read_summary();
  bool take_counts(Bytes content);

  BinaryFile file_;
  std::vector<unsigned char> record_, chunk_;
  Bytes left_;  ///< of the chunk
  std::map<uint16_t, Schema> schemas_;
  std::optional<uint32_t> crc_ = 0;  ///< of all that was read, until there is a chunk
  bool over_ = false;
  std::string notice_;
};

}  // namespace foucault::rawlog
