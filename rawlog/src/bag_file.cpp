#include "bag_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "foucault/core/time.h"
#include "inflate_block.h"
#include "record_cursor.h"

namespace foucault::rawlog {

namespace {

/// Of the header field `op`.
enum class BagOp : uint8_t { message = 2, bag = 3, chunk = 5, connection = 7 };

std::string text_of(Bytes bytes) { return {bytes.begin, bytes.end}; }

/// A part of a record: its length, then its bytes.
Bytes part_of(RecordCursor& cursor) {
  const size_t size = cursor.get<uint32_t>();
  const unsigned char* const begin = cursor.take(size);
  return {begin, begin + size};
}

}  // namespace

BagFile::BagFile(const std::string& path, const std::string& named) : file_(path, named) {
  const bool whole = file_.read(kMagic.size(), header_);
  if (whole && std::equal(kMagic.begin(), kMagic.end(), header_.begin())) return;
  throw DataError(
      fmt::format("{}: it does not begin as a bag of ROS 1, format 2.0, does; check the "
                  "file (older bags: rosbag fix)",
                  file_.place(0)));
}

std::optional<RosMessage> BagFile::next() {
  try {
    while (true) {
      if (left_.size() > 0) {
        if (std::optional<RosMessage> message = next_in_chunk()) return message;
        continue;
      }
      Header header;
      if (!read_record(header)) return std::nullopt;
      if (number<uint8_t>(header, "op") == static_cast<uint8_t>(BagOp::chunk)) {
        open_chunk(header);
      } else if (std::optional<RosMessage> message = message_of(header, bytes_of(data_))) {
        return message;
      }
    }
  } catch (const RecordTooShort&) {
    left_ = {};
    file_.fail("a record that is longer than what it lies in; the bag is damaged here");
  }
}

/// False at the end of the file.
bool BagFile::read_record(Header& header) {
  file_.begin_record();
  if (file_.at_end()) return false;
  if (!read_part(header_) || !read_part(data_)) {
    file_.fail("the file ends within a record, it is cut off; get the whole one");
  }
  header = header_of(bytes_of(header_));
  return true;
}

bool BagFile::read_part(std::vector<unsigned char>& bytes) {
  if (!file_.read(sizeof(uint32_t), bytes)) return false;
  const auto size = RecordCursor(bytes_of(bytes)).get<uint32_t>();
  return file_.read(size, bytes);
}

/// Fields "name=value", each with its length.
BagFile::Header BagFile::header_of(Bytes bytes) const {
  Header header;
  RecordCursor cursor(bytes);
  while (cursor.position() < bytes.size()) {
    const Bytes field = part_of(cursor);
    const unsigned char* const sign = std::find(field.begin, field.end, '=');
    if (sign == field.end) file_.fail("a header field without a name; the bag is damaged here");
    header[std::string(field.begin, sign)] = {sign + 1, field.end};
  }
  return header;
}

template <class T>
T BagFile::number(const Header& header, const std::string& key) const {
  const auto found = header.find(key);
  if (found == header.end() || found->second.size() != sizeof(T)) {
    file_.fail(fmt::format("a record without its field '{}'; the bag is damaged here", key));
  }
  return RecordCursor(found->second).get<T>();
}

/// None of other records.
std::optional<RosMessage> BagFile::message_of(const Header& header, Bytes data) {
  const auto op = number<uint8_t>(header, "op");
  if (op == static_cast<uint8_t>(BagOp::connection)) connect(header, data);
  if (op != static_cast<uint8_t>(BagOp::message)) return std::nullopt;
  const auto topic = number<uint32_t>(header, "conn");
  if (!is_selected(topic)) return std::nullopt;
  const auto time = number<uint64_t>(header, "time");
  const auto seconds = static_cast<int64_t>(time & 0xFFFFFFFFU);
  const auto nanoseconds = static_cast<int64_t>(time >> 32U);
  return RosMessage{topic, seconds * kNanosecondsPerSecond + nanoseconds, data};
}

void BagFile::connect(const Header& header, Bytes data) {
  const auto topic = header.find("topic");
  if (topic == header.end()) file_.fail("a connection without a topic; the bag is damaged here");
  const Header about = header_of(data);
  const auto type = about.find("type");
  const auto definition = about.find("message_definition");
  if (type == about.end() || definition == about.end()) {
    file_.fail("a connection without a message definition; the bag is damaged here");
  }
  topics_[number<uint32_t>(header, "conn")] = {
      text_of(topic->second),
      {text_of(type->second), text_of(definition->second), RosEncoding::ros1},
      {}};
}

void BagFile::open_chunk(const Header& header) {
  const auto size = number<uint32_t>(header, "size");
  const auto found = header.find("compression");
  const std::string compression = found == header.end() ? "" : text_of(found->second);
  if (!is_compression(compression)) {
    file_.fail(
        "a chunk that is compressed by something else than bz2 and lz4; rosbag decompress "
        "makes a plain one");
  }
  if (!inflate_block(compression, bytes_of(data_), size, chunk_)) {
    file_.fail(
        fmt::format("a chunk that cannot be inflated by {}; the bag is damaged here", compression));
  }
  left_ = bytes_of(chunk_);
}

std::optional<RosMessage> BagFile::next_in_chunk() {
  RecordCursor cursor(left_);
  const Bytes header = part_of(cursor);
  const Bytes data = part_of(cursor);
  left_.begin += cursor.position();
  return message_of(header_of(header), data);
}

/// A bag that was closed has its connections once more behind the chunks.
bool BagFile::read_index() {
  try {
    return read_connections();
  } catch (const RowError&) {  // told by those who read the messages
  } catch (const RecordTooShort&) {
  }
  return false;
}

bool BagFile::read_connections() {
  Header header;
  if (!read_record(header) || number<uint8_t>(header, "op") != static_cast<uint8_t>(BagOp::bag)) {
    return false;
  }
  const auto index = number<uint64_t>(header, "index_pos");
  const auto count = number<uint32_t>(header, "conn_count");
  if (index == 0 || !file_.go_to(index)) return false;
  while (topics_.size() < count && read_record(header)) {
    if (number<uint8_t>(header, "op") != static_cast<uint8_t>(BagOp::connection)) return false;
    connect(header, bytes_of(data_));
  }
  return topics_.size() == count;
}

}  // namespace foucault::rawlog
