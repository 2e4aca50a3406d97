#include "rosbag2_database.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <filesystem>

#include "inflate_block.h"

namespace foucault::rawlog {

namespace {

constexpr const char* kSqliteRemedy =
    "get a whole copy, or save what is left by: sqlite3 FILE .recover | sqlite3 NEW.db3";

/// A path in a name of SQLite's, where some signs have a meaning.
std::string sqlite_uri(const std::string& path, bool immutable) {
  std::string uri = "file:";
  for (const char c : path) {
    uri += c == '%' || c == '?' || c == '#' ? fmt::format("%{:02X}", static_cast<int>(c))
                                            : std::string(1, c);
  }
  return uri + (immutable ? "?mode=ro&immutable=1" : "?mode=ro");
}

/// What a process that died while it recorded leaves beside the file.
bool has_unfinished(const std::string& path) {
  std::error_code not_there;
  const auto has = [&](const char* ending) {
    const auto size = std::filesystem::file_size(path + ending, not_there);
    return !not_there && size > 0;
  };
  return has("-wal") || has("-journal");
}

std::string sqlite_text(sqlite3_stmt* row, int column) {
  const unsigned char* const text = sqlite3_column_text(row, column);
  return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

}  // namespace

void Rosbag2Database::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }
void Rosbag2Database::Close::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

Rosbag2Database::Rosbag2Database(const std::string& path, std::string named)
    : named_(std::move(named)) {
  open(path);
  try {
    if (!has_table("topics") || !has_table("messages")) {
      throw DataError(fmt::format(
          "'{}' is a database without the tables of rosbag 2, topics and messages; check the file",
          named_));
    }
    read_topics();
    if (has_table("message_definitions")) read_definitions();
    const Statement last = prepare("SELECT max(id) FROM messages");
    if (step(last)) last_ = sqlite3_column_int64(last.get(), 0);
  } catch (const RowError&) {
    fail_to_open();
  }
}

/// Never writes, also not beside the file unless SQLite has to look through what is left there; and
/// does not do what a schema from elsewhere says.
void Rosbag2Database::open(const std::string& path) {
  sqlite3* database = nullptr;
  const int result = sqlite3_open_v2(sqlite_uri(path, !has_unfinished(path)).c_str(), &database,
                                     SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  database_.reset(database);
  if (result != SQLITE_OK) fail_to_open();
  sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_limit(database, SQLITE_LIMIT_LENGTH, static_cast<int>(kLargestBlock));
}

void Rosbag2Database::fail_to_open() const {
  throw DataError(fmt::format("'{}' cannot be read as a recording of rosbag 2: {}; {}", named_,
                              one_line(sqlite3_errmsg(database_.get())), kSqliteRemedy));
}

Rosbag2Database::Statement Rosbag2Database::prepare(const std::string& sql) const {
  sqlite3_stmt* statement = nullptr;
  const int result = sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &statement, nullptr);
  if (result != SQLITE_OK) fail_to_open();
  return Statement(statement);
}

/// False behind the last row.
bool Rosbag2Database::step(const Statement& statement) const {
  const int result = sqlite3_step(statement.get());
  if (result == SQLITE_ROW) return true;
  if (result == SQLITE_DONE) return false;
  fail(fmt::format("what follows cannot be read: {}; {}", one_line(sqlite3_errmsg(database_.get())),
                   kSqliteRemedy));
}

bool Rosbag2Database::has_table(const char* name) const {
  return step(prepare(fmt::format(
      "SELECT 1 FROM sqlite_master WHERE type = 'table' AND rootpage > 0 AND name = '{}'", name)));
}

void Rosbag2Database::read_topics() {
  const Statement rows = prepare("SELECT id, name, type, serialization_format FROM topics");
  while (step(rows)) {
    sqlite3_stmt* const row = rows.get();
    RosTopic& topic = topics_[static_cast<uint32_t>(sqlite3_column_int64(row, 0))];
    topic.name = sqlite_text(row, 1);
    topic.type.name = sqlite_text(row, 2);
    topic.type.encoding = sqlite_text(row, 3) == "cdr" ? RosEncoding::cdr : RosEncoding::unknown;
  }
}

void Rosbag2Database::read_definitions() {
  const Statement rows = prepare(
      "SELECT topic_type, encoded_message_definition FROM message_definitions "
      "WHERE encoding = 'ros2msg'");
  while (step(rows)) {
    const std::string type = sqlite_text(rows.get(), 0);
    const std::string definition = sqlite_text(rows.get(), 1);
    for (auto& [id, topic] : topics_) {
      if (topic.type.name == type) topic.type.definition = definition;
    }
  }
}

/// The topics are a table of their own.
bool Rosbag2Database::read_index() {
  for (auto& [id, topic] : topics_) topic.messages = 0;
  try {
    const Statement rows = prepare("SELECT topic_id, count(*) FROM messages GROUP BY topic_id");
    while (step(rows)) {
      const auto topic = topics_.find(static_cast<uint32_t>(sqlite3_column_int64(rows.get(), 0)));
      if (topic != topics_.end()) {
        topic->second.messages = static_cast<uint64_t>(sqlite3_column_int64(rows.get(), 1));
      }
    }
  } catch (const RowError&) {  // told by those who read the messages
    for (auto& [id, topic] : topics_) topic.messages.reset();
  }
  return true;
}

void Rosbag2Database::begin_messages() {
  std::string left_out;
  for (const auto& [id, topic] : topics_) {
    if (!is_selected(id)) left_out += (left_out.empty() ? "" : ", ") + std::to_string(id);
  }
  messages_ = prepare(
      fmt::format("SELECT id, topic_id, timestamp, data FROM messages WHERE topic_id NOT IN ({}) "
                  "ORDER BY id",
                  left_out));
}

std::optional<RosMessage> Rosbag2Database::next() {
  if (over_) return std::nullopt;
  if (!messages_) begin_messages();
  over_ = true;  // after an error too, SQLite would begin again
  if (!step(messages_)) return std::nullopt;
  over_ = false;
  sqlite3_stmt* const row = messages_.get();
  message_ = sqlite3_column_int64(row, 0);
  RosMessage message;
  message.topic = static_cast<uint32_t>(sqlite3_column_int64(row, 1));
  message.recorded_ns = sqlite3_column_int64(row, 2);
  const auto* const begin = static_cast<const unsigned char*>(sqlite3_column_blob(row, 3));
  message.bytes = {begin, begin + sqlite3_column_bytes(row, 3)};
  return message;
}

std::string Rosbag2Database::place(int64_t message) const {
  return fmt::format("{}: message {}", named_, message);
}

double Rosbag2Database::progress() const {
  if (last_ <= 0) return 1;
  return std::clamp(static_cast<double>(message_) / static_cast<double>(last_), 0.0, 1.0);
}

}  // namespace foucault::rawlog
