#include "bag_file.h"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>

#include <algorithm>
#include <string_view>

#include "foucault/core/time.h"
#include "record_cursor.h"

namespace foucault::rawlog {

namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr uint32_t kLargestChunk = 1U << 28;  ///< inflated [bytes]; rosbag makes chunks of 768 kB
constexpr size_t kPiece = 1U << 20;

/// Of the header field `op`.
enum class Op : uint8_t { message = 2, chunk = 5, connection = 7 };

std::string text_of(Bytes bytes) { return {bytes.begin, bytes.end}; }

/// Room for another piece of at most `size` bytes in all.
void grow(std::vector<unsigned char>& bytes, size_t filled, size_t size) {
  if (filled == bytes.size()) bytes.resize(std::min(size, bytes.size() + kPiece));
}

/// Fills `out` with up to `size` bytes. False if they are not to be had.
bool inflate_bz2(std::vector<unsigned char>& in, size_t size, std::vector<unsigned char>& out) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return false;
  stream.next_in = reinterpret_cast<char*>(in.data());
  stream.avail_in = static_cast<unsigned>(in.size());
  out.clear();
  size_t filled = 0;
  int result = BZ_OK;
  while (result == BZ_OK && filled < size) {
    grow(out, filled, size);
    const auto room = static_cast<unsigned>(out.size() - filled);
    stream.next_out = reinterpret_cast<char*>(out.data() + filled);
    stream.avail_out = room;
    result = BZ2_bzDecompress(&stream);
    if (stream.avail_out == room && stream.avail_in == 0) break;
    filled += room - stream.avail_out;
  }
  BZ2_bzDecompressEnd(&stream);
  return filled == size;
}

bool inflate_lz4(const std::vector<unsigned char>& in, size_t size,
                 std::vector<unsigned char>& out) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) return false;
  out.clear();
  size_t filled = 0;
  size_t used = 0;
  while (filled < size && used < in.size()) {
    grow(out, filled, size);
    size_t room = out.size() - filled;
    size_t left = in.size() - used;
    const size_t result =
        LZ4F_decompress(context, out.data() + filled, &room, in.data() + used, &left, nullptr);
    if (LZ4F_isError(result) != 0 || (room == 0 && left == 0)) break;
    filled += room;
    used += left;
  }
  LZ4F_freeDecompressionContext(context);
  return filled == size;
}

/// A part of a record: its length, then its bytes.
Bytes part_of(RecordCursor& cursor) {
  const size_t size = cursor.get<uint32_t>();
  const unsigned char* const begin = cursor.take(size);
  return {begin, begin + size};
}

}  // namespace

BagFile::BagFile(const std::string& path) : file_(path) {
  const bool whole = file_.read(kMagic.size(), header_);
  if (whole && std::equal(kMagic.begin(), kMagic.end(), header_.begin())) return;
  throw DataError(
      fmt::format("{}: it does not begin as a bag of ROS 1, format 2.0, does; check the "
                  "file (older bags: rosbag fix)",
                  file_.place(0)));
}

std::optional<BagMessage> BagFile::next() {
  try {
    while (true) {
      if (left_.size() > 0) {
        if (std::optional<BagMessage> message = next_in_chunk()) return message;
        continue;
      }
      Header header;
      if (!read_record(header)) return std::nullopt;
      if (number<uint8_t>(header, "op") == static_cast<uint8_t>(Op::chunk)) {
        open_chunk(header);
      } else if (std::optional<BagMessage> message = message_of(header, bytes_of(data_))) {
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
std::optional<BagMessage> BagFile::message_of(const Header& header, Bytes data) {
  const auto op = number<uint8_t>(header, "op");
  if (op == static_cast<uint8_t>(Op::connection)) connect(header, data);
  if (op != static_cast<uint8_t>(Op::message)) return std::nullopt;
  const auto time = number<uint64_t>(header, "time");
  const auto seconds = static_cast<int64_t>(time & 0xFFFFFFFFU);
  const auto nanoseconds = static_cast<int64_t>(time >> 32U);
  return BagMessage{number<uint32_t>(header, "conn"), seconds * kNanosecondsPerSecond + nanoseconds,
                    data};
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
  connections_[number<uint32_t>(header, "conn")] = {text_of(topic->second), text_of(type->second),
                                                    text_of(definition->second)};
}

void BagFile::open_chunk(const Header& header) {
  const auto size = number<uint32_t>(header, "size");
  const auto found = header.find("compression");
  const std::string compression = found == header.end() ? "" : text_of(found->second);
  bool whole = size <= kLargestChunk;
  if (compression == "none") {
    chunk_.swap(data_);
  } else if (compression == "bz2") {
    whole = whole && inflate_bz2(data_, size, chunk_);
  } else if (compression == "lz4") {
    whole = whole && inflate_lz4(data_, size, chunk_);
  } else {
    file_.fail(
        "a chunk that is compressed by something else than bz2 and lz4; rosbag decompress "
        "makes a plain one");
  }
  if (!whole)
    file_.fail(
        fmt::format("a chunk that cannot be inflated by {}; the bag is damaged here", compression));
  left_ = bytes_of(chunk_);
}

std::optional<BagMessage> BagFile::next_in_chunk() {
  RecordCursor cursor(left_);
  const Bytes header = part_of(cursor);
  const Bytes data = part_of(cursor);
  left_.begin += cursor.position();
  return message_of(header_of(header), data);
}

BagConnections connections_of(const std::string& path) {
  BagFile bag(path);
  try {
    while (bag.next()) {
    }
  } catch (const RowError&) {  // told by those who read the messages
  }
  return bag.connections();
}

}  // namespace foucault::rawlog
