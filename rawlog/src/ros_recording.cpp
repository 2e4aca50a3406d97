#include "ros_recording.h"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <string_view>

#include "bag_file.h"
#include "inflate_block.h"
#include "mcap_file.h"
#include "rosbag2_database.h"
#include "rosbag2_folder.h"

namespace foucault::rawlog {

namespace {

namespace fs = std::filesystem;

/// Bytes that are enough to recognize a format.
std::vector<unsigned char> beginning_of(const std::string& path) {
  constexpr size_t kEnough = 16;
  std::vector<unsigned char> bytes;
  BinaryFile(path).read(kEnough, bytes);
  return bytes;
}

bool begins_with(const std::vector<unsigned char>& bytes, std::string_view beginning) {
  return bytes.size() >= beginning.size() &&
         std::memcmp(bytes.data(), beginning.data(), beginning.size()) == 0;
}

}  // namespace

std::string one_line(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ') c = '?';
  }
  return text;
}

bool RosRecording::is_selected(uint32_t topic) const {
  if (!selected_) return true;
  const auto found = topics_.find(topic);
  return found == topics_.end() || selected_->count(found->second.name) > 0;
}

RosTopics topics_of(const std::function<std::unique_ptr<RosRecording>()>& open) {
  const std::unique_ptr<RosRecording> index = open();
  if (index->read_index()) return index->topics();
  const std::unique_ptr<RosRecording> recording = open();
  recording->select({});
  for (bool over = false; !over;) {
    try {
      over = !recording->next();
    } catch (const RowError&) {  // told by those who read the messages
    }
  }
  return recording->topics();
}

RosLog::RosLog(std::string path) : path_(std::move(path)), folder_(fs::is_directory(path_)) {}

std::unique_ptr<RosRecording> RosLog::open() {
  if (folder_) return std::make_unique<RosbagFolder>(path_, *this);
  return open_file(path_);
}

RosTopics RosLog::topics() {
  return topics_of([this] { return open(); });
}

std::unique_ptr<RosRecording> RosLog::open_file(const std::string& path) {
  std::string plain = path;
  std::vector<unsigned char> beginning = beginning_of(path);
  if (is_zstd(bytes_of(beginning))) {
    plain = inflated(path);
    beginning = beginning_of(plain);
  }
  if (begins_with(beginning, McapFile::kMagic)) return std::make_unique<McapFile>(plain, path);
  if (begins_with(beginning, Rosbag2Database::kMagic)) {
    return std::make_unique<Rosbag2Database>(plain, path);
  }
  if (begins_with(beginning, "#ROSBAG")) return std::make_unique<BagFile>(plain, path);
  throw DataError(fmt::format(
      "'{}' begins neither as a bag of ROS 1 nor as MCAP or rosbag 2 (sqlite3); check the file",
      path));
}

/// Where it lies without zstd.
const std::string& RosLog::inflated(const std::string& path) {
  std::unique_ptr<TemporaryFile>& known = inflated_[path];
  if (!known) {
    auto file = std::make_unique<TemporaryFile>();
    inflate_zstd_file(path, file->path());
    known = std::move(file);
  }
  return known->path();
}

}  // namespace foucault::rawlog
