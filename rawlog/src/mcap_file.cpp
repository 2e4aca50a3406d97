#include "mcap_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <string_view>

#include "inflate_block.h"

namespace foucault::rawlog {

namespace {

enum class McapOp : uint8_t {
  footer = 2,
  schema = 3,
  channel = 4,
  message = 5,
  chunk = 6,
  statistics = 11,
  data_end = 15
};

constexpr size_t kMcapHead = 9;     ///< kind and length of a record [bytes]
constexpr size_t kMcapFooter = 20;  ///< less its head [bytes]
constexpr uint64_t kLargestSummary = uint64_t{1} << 28;
constexpr uint64_t kLargestRecord = uint64_t{1} << 30;  ///< of those with messages
constexpr uint64_t kMcapPiece = 1U << 20;

uint32_t crc_of(Bytes bytes, uint32_t before = 0) {
  return static_cast<uint32_t>(crc32_z(before, bytes.begin, bytes.size()));
}

std::string mcap_text(RecordCursor& cursor) { return std::string(cursor.text(UINT32_MAX)); }

Bytes rest_of(const RecordCursor& cursor, Bytes content) {
  return {content.begin + cursor.position(), content.end};
}

RosEncoding mcap_encoding(const std::string& name) {
  if (name == "ros1") return RosEncoding::ros1;
  return name == "cdr" ? RosEncoding::cdr : RosEncoding::unknown;
}

bool is_op(uint8_t op, McapOp wanted) { return op == static_cast<uint8_t>(wanted); }

bool is_needed(uint8_t op) {
  for (const McapOp needed : {McapOp::footer, McapOp::schema, McapOp::channel, McapOp::message,
                              McapOp::chunk, McapOp::data_end}) {
    if (is_op(op, needed)) return true;
  }
  return false;
}

}  // namespace

McapFile::McapFile(const std::string& path, const std::string& named) : file_(path, named) {
  const bool whole = read(kMagic.size());
  if (whole &&
      std::equal(kMagic.begin(), kMagic.end(), record_.begin(),
                 [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; }))
    return;
  throw DataError(fmt::format("{}: it does not begin as MCAP of version 0 does; check the file",
                              file_.place(0)));
}

/// Into record_.
bool McapFile::read(uint64_t count) {
  const bool whole = file_.read(count, record_);
  if (crc_) crc_ = crc_of(bytes_of(record_), *crc_);
  return whole;
}

bool McapFile::skip(uint64_t count) {
  if (!crc_) return file_.skip(count);
  while (count > 0) {
    const uint64_t piece = std::min(count, kMcapPiece);
    if (!read(piece)) return false;
    count -= piece;
  }
  return true;
}

bool McapFile::read_head(Head& head) {
  file_.begin_record();
  if (!read(kMcapHead)) return false;
  RecordCursor(bytes_of(record_)).get(head.op, head.size);
  return true;
}

std::optional<RosMessage> McapFile::next() {
  try {
    while (!over_) {
      std::optional<RosMessage> message = left_.size() > 0 ? next_in_chunk() : next_in_file();
      if (message) return message;
    }
  } catch (const RecordTooShort&) {
    left_ = {};
    file_.fail("a record that is shorter than what it has to have; the file is damaged here");
  }
  return std::nullopt;
}

std::optional<RosMessage> McapFile::next_in_file() {
  const std::optional<uint32_t> crc = crc_;
  Head head;
  if (!read_head(head)) {
    over_ = true;
    if (!record_.empty())
      file_.fail("the file ends within a record, it is cut off; get the whole one");
    notice_ = "it has no end, the recording was cut off; all messages up to there were read";
    return std::nullopt;
  }
  const bool needed = is_needed(head.op) && head.size <= kLargestRecord;
  const bool whole = needed ? read(head.size) : skip(head.size);
  if (is_op(head.op, McapOp::data_end)) crc_ = crc;  // it is of what stands before
  if (whole) return needed ? take(head.op, bytes_of(record_)) : std::nullopt;
  over_ = true;
  file_.fail(
      "a record that goes on behind the end of the file, which is cut off or damaged here; get the "
      "whole one");
}

std::optional<RosMessage> McapFile::next_in_chunk() {
  RecordCursor cursor(left_);
  Head head;
  cursor.get(head.op, head.size);
  const unsigned char* const begin = cursor.take(head.size);
  left_.begin += cursor.position();
  if (is_op(head.op, McapOp::chunk)) file_.fail("a chunk within a chunk; the file is damaged here");
  return take(head.op, {begin, begin + head.size});
}

/// None of other records.
std::optional<RosMessage> McapFile::take(uint8_t op, Bytes content) {
  switch (static_cast<McapOp>(op)) {
    case McapOp::schema:
      take_schema(content);
      break;
    case McapOp::channel:
      take_channel(content);
      break;
    case McapOp::message:
      return take_message(content);
    case McapOp::chunk:
      open_chunk();
      break;
    case McapOp::data_end:
      end_of_data();
      break;
    case McapOp::footer:
      over_ = true;
      break;
    case McapOp::statistics:
      break;
  }
  return std::nullopt;
}

void McapFile::take_schema(Bytes content) {
  RecordCursor cursor(content);
  const auto id = cursor.get<uint16_t>();
  Schema& schema = schemas_[id];
  schema.name = mcap_text(cursor);
  schema.encoding = mcap_text(cursor);
  schema.text = mcap_text(cursor);
}

void McapFile::take_channel(Bytes content) {
  RecordCursor cursor(content);
  const auto id = cursor.get<uint16_t>();
  const auto schema_id = cursor.get<uint16_t>();
  RosTopic topic;
  topic.name = mcap_text(cursor);
  topic.type.encoding = mcap_encoding(mcap_text(cursor));
  const auto schema = schemas_.find(schema_id);
  if (schema != schemas_.end()) {
    topic.type.name = schema->second.name;
    const std::string& encoding = schema->second.encoding;
    if (encoding == "ros1msg" || encoding == "ros2msg") topic.type.definition = schema->second.text;
  }
  topics_[id] = topic;
}

std::optional<RosMessage> McapFile::take_message(Bytes content) {
  RecordCursor cursor(content);
  const auto channel = cursor.get<uint16_t>();
  cursor.skip(sizeof(uint32_t));  // a number of the publisher
  const auto logged = cursor.get<uint64_t>();
  cursor.skip(sizeof(uint64_t));  // when it was published, by a clock that may be another one
  if (!is_selected(channel)) return std::nullopt;
  return RosMessage{channel, static_cast<int64_t>(logged), rest_of(cursor, content)};
}

/// It has a checksum of its own.
void McapFile::open_chunk() {
  crc_.reset();
  RecordCursor cursor(bytes_of(record_));
  cursor.skip(2 * sizeof(uint64_t));  // from when to when
  const auto size = cursor.get<uint64_t>();
  const auto crc = cursor.get<uint32_t>();
  const std::string named = mcap_text(cursor);
  const std::string compression = named.empty() ? "none" : named;
  const auto packed = cursor.get<uint64_t>();
  const unsigned char* const begin = cursor.take(packed);
  if (!is_compression(compression)) {
    file_.fail(
        "a chunk that is compressed by something else than lz4 and zstd; mcap compress or mcap "
        "convert make another file");
  }
  if (!inflate_block(compression, {begin, begin + packed}, size, chunk_)) {
    file_.fail(
        fmt::format("a chunk that cannot be inflated ({}); the file is damaged here", compression));
  }
  if (crc != 0 && crc != crc_of(bytes_of(chunk_))) {
    file_.fail(
        "a chunk with a wrong checksum, none of its messages is read; the file is damaged "
        "here");
  }
  left_ = bytes_of(chunk_);
}

/// What follows are copies of what was read, and indices.
void McapFile::end_of_data() {
  over_ = true;
  const auto crc = RecordCursor(bytes_of(record_)).get<uint32_t>();
  if (crc == 0 || !crc_ || *crc_ == crc) return;
  file_.fail(
      "the checksum of all that stands before is wrong, some of it is not as it was written; "
      "get another copy");
}

std::vector<std::string> McapFile::notices() const {
  if (notice_.empty()) return {};
  return {fmt::format("{}: {}", file_.path(), notice_)};
}

bool McapFile::read_index() {
  try {
    return read_summary();
  } catch (const RowError&) {  // told by those who read the messages
  } catch (const RecordTooShort&) {
  }
  return false;
}

/// Only one that counts the messages is known to have all channels.
bool McapFile::read_summary() {
  const uint64_t behind = kMcapHead + kMcapFooter + kMagic.size();
  Head head;
  if (file_.size() < behind || !file_.go_to(file_.size() - behind) || !read_head(head))
    return false;
  if (!is_op(head.op, McapOp::footer) || head.size != kMcapFooter || !read(head.size)) return false;
  const auto begin = RecordCursor(bytes_of(record_)).get<uint64_t>();
  const uint64_t end = file_.size() - behind;
  if (begin == 0 || begin > end || end - begin > kLargestSummary || !file_.go_to(begin))
    return false;
  if (!file_.read(end - begin, chunk_)) return false;
  RecordCursor cursor(bytes_of(chunk_));
  while (cursor.position() < chunk_.size()) {
    cursor.get(head.op, head.size);
    const unsigned char* const content = cursor.take(head.size);
    if (is_op(head.op, McapOp::statistics)) return take_counts({content, content + head.size});
    take(head.op, {content, content + head.size});
  }
  return false;
}

/// False if there are channels that it does not count.
bool McapFile::take_counts(Bytes content) {
  RecordCursor cursor(content);
  cursor.skip(sizeof(uint64_t) + sizeof(uint16_t));  // messages, schemas
  const auto channels = cursor.get<uint32_t>();
  cursor.skip(3 * sizeof(uint32_t) + 2 * sizeof(uint64_t));  // attachments, ..., times
  const auto size = cursor.get<uint32_t>();
  const size_t end = cursor.position() + size;
  for (auto& [id, topic] : topics_) topic.messages = 0;
  while (cursor.position() < end) {
    const auto topic = topics_.find(cursor.get<uint16_t>());
    const auto count = cursor.get<uint64_t>();
    if (topic == topics_.end()) return false;
    topic->second.messages = count;
  }
  return channels == topics_.size() && size > 0;
}

}  // namespace foucault::rawlog
