#include "rosbag2_folder.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>

namespace foucault::rawlog {

namespace {

constexpr int kPlaceBits = 44;  ///< of a position, for the place in a file; the file stands above
constexpr const char* kMetadata = "metadata.yaml";

namespace fs = std::filesystem;

bool is_recording(const std::string& name) {
  const auto ends = [&](const std::string& ending) {
    return name.size() > ending.size() &&
           name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
  };
  return ends(".db3") || ends(".mcap") || ends(".db3.zstd") || ends(".mcap.zstd");
}

/// Old recordings name the files with their folder before.
std::string in_folder(const fs::path& folder, const std::string& name) {
  const fs::path as_named = folder / name;
  return (fs::exists(as_named) ? as_named : folder / fs::path(name).filename()).string();
}

std::vector<std::string> files_of_metadata(const fs::path& folder) {
  std::vector<std::string> files;
  try {
    const YAML::Node root = YAML::LoadFile((folder / kMetadata).string());
    for (const YAML::Node& name : root["rosbag2_bagfile_information"]["relative_file_paths"]) {
      files.push_back(in_folder(folder, name.as<std::string>()));
    }
  } catch (const YAML::Exception& error) {
    throw DataError(fmt::format("'{}' cannot be read: {}; mend or remove it",
                                (folder / kMetadata).string(), one_line(error.what())));
  }
  return files;
}

/// a_2 before a_10.
bool by_number(const std::string& a, const std::string& b) {
  return a.size() != b.size() ? a.size() < b.size() : a < b;
}

std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (is_recording(entry.path().filename().string())) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end(), by_number);
  return files;
}

bool same(const RosTopic& a, const RosTopic& b) {
  return a.name == b.name && a.type.name == b.type.name && a.type.definition == b.type.definition &&
         a.type.encoding == b.type.encoding;
}

}  // namespace

RosbagFolder::RosbagFolder(const std::string& path, RosLog& log) : path_(path), log_(log) {
  if (fs::exists(fs::path(path) / kMetadata)) files_ = files_of_metadata(path);
  if (files_.empty()) {
    files_ = files_in(path);
    notices_.push_back(
        fmt::format("{}: no {} that names files, the recording was cut off; read all {} files by "
                    "the order of their names",
                    path, kMetadata, files_.size()));
  }
  if (files_.empty()) {
    throw DataError(fmt::format(
        "'{}' is a folder without files of rosbag 2 (.db3, .mcap); give the recording", path));
  }
}

std::optional<RosMessage> RosbagFolder::next() {
  while (at_ < files_.size()) {
    if (!current_) begin_file();
    if (std::optional<RosMessage> message = current_->next()) {
      const auto number = numbers_.find(message->topic);
      if (number == numbers_.end()) add_topics();
      const auto known = numbers_.find(message->topic);
      if (known == numbers_.end()) {
        fail(fmt::format("a message of topic {}, which nothing defines; the file is damaged here",
                         message->topic));
      }
      message->topic = known->second;
      return message;
    }
    end_file();
  }
  return std::nullopt;
}

void RosbagFolder::begin_file() {
  try {
    current_ = log_.open_file(files_[at_]);
  } catch (const DataError& error) {
    ++at_;
    throw RowError(error.what());
  }
  if (selected_) current_->select(*selected_);
  numbers_.clear();
  add_topics();
}

void RosbagFolder::end_file() {
  const std::vector<std::string> found = current_->notices();
  notices_.insert(notices_.end(), found.begin(), found.end());
  current_.reset();
  ++at_;
}

void RosbagFolder::add_topics() {
  for (const auto& [number, topic] : current_->topics()) numbers_[number] = number_of(topic);
}

uint32_t RosbagFolder::number_of(const RosTopic& topic) {
  for (const auto& [number, known] : topics_) {
    if (same(topic, known)) return number;
  }
  const auto number = static_cast<uint32_t>(topics_.size());
  topics_[number] = topic;
  topics_[number].messages.reset();
  return number;
}

bool RosbagFolder::read_index() {
  for (const std::string& file : files_) {
    RosTopics found;
    try {
      found = topics_of([&] { return log_.open_file(file); });
    } catch (const DataError&) {  // told by those who read the messages
      continue;
    }
    for (const auto& [number, topic] : found) {
      RosTopic& all = topics_[number_of(topic)];
      if (topic.messages) all.messages = all.messages.value_or(0) + *topic.messages;
    }
  }
  return true;
}

std::vector<std::string> RosbagFolder::notices() const { return notices_; }

int64_t RosbagFolder::position() const {
  const int64_t within = current_ ? current_->file().position() : 0;
  return (static_cast<int64_t>(at_) << kPlaceBits) + within;
}

std::string RosbagFolder::place(int64_t position) const {
  const auto file = static_cast<size_t>(position >> kPlaceBits);
  if (file >= files_.size()) return path_;
  if (file != at_ || !current_) return files_[file];
  return current_->file().place(position & ((int64_t{1} << kPlaceBits) - 1));
}

std::string RosbagFolder::where() const { return place(position()); }

double RosbagFolder::progress() const {
  const double within = current_ ? current_->file().progress() : 0;
  return (static_cast<double>(at_) + within) / static_cast<double>(files_.size());
}

}  // namespace foucault::rawlog
