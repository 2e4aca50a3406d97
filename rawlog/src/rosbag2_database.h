#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ros_recording.h"

struct sqlite3;
struct sqlite3_stmt;

namespace foucault::rawlog {

/// A file of rosbag 2 as sqlite3 stores it: tables `topics`, `messages` and, since ROS 2 Iron,
/// `message_definitions`. Places in it are told by the number of the message.
/// Source: docs.ros.org, rosbag2_storage_sqlite3.
class Rosbag2Database : public RosRecording, public InputFile, public Place {
 public:
  /// What the file begins with.
  static constexpr std::string_view kMagic = "SQLite format 3";

  /// Throws DataError if the file is no recording of this kind. Messages name it `named`.
  Rosbag2Database(const std::string& path, std::string named);

  std::optional<RosMessage> next() override;
  bool read_index() override;
  const InputFile& file() const override { return *this; }
  const Place& place() const override { return *this; }

  const std::string& path() const override { return named_; }
  int64_t position() const override { return message_; }
  std::string place(int64_t message) const override;
  double progress() const override;

 private:
  struct Close {
    void operator()(sqlite3* database) const;
    void operator()(sqlite3_stmt* statement) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Close>;

  std::string where() const override { return place(message_); }
  void open(const std::string& path);
  Statement prepare(const std::string& sql) const;
  bool step(const Statement& statement) const;
  [[noreturn]] void fail_to_open() const;
  bool has_table(const char* name) const;
  void read_topics();
  void read_definitions();
  void begin_messages();

  std::string named_;
  std::unique_ptr<sqlite3, Close> database_;
  Statement messages_;
  bool over_ = false;
  int64_t message_ = 0;
  int64_t last_ = 0;
};

}  // namespace foucault::rawlog
