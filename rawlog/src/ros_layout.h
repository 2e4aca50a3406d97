#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "record_cursor.h"

namespace foucault::rawlog {

/// How a ROS 1 message lies in its bytes, by the definition that its bag has of it
/// (wiki.ros.org/msg). Numbers in it are named by their path, as `linear_acceleration.x`; a time
/// has the two numbers `secs` and `nsecs`.
class RosLayout {
 public:
  /// Throws BadRecord if the definition cannot be followed.
  explicit RosLayout(const std::string& definition);

  /// Where read() puts the `count` numbers of a field, which may be wrapped as std_msgs does
  /// (`path.data`); none if there is no such field.
  std::optional<size_t> want(const std::string& path, size_t count = 1);

  /// What was wanted. Throws RecordTooShort or BadRecord.
  std::vector<double> read(Bytes message) const;

 private:
  struct Field {
    std::string path;
    std::string type;  ///< primitive; empty: an array of `members`
    size_t count = 1;
    bool counted = false;  ///< the number of elements stands before them
    std::vector<Field> members;
    std::optional<size_t> slot;
  };
  struct Line {
    std::string type, name;
    size_t count = 1;
    bool array = false;
    bool counted = false;
  };
  using Types = std::map<std::string, std::vector<Line>>;

  static Types types_of(const std::string& definition);
  static std::optional<Line> line_of(std::string_view text);
  static std::optional<std::string> find_type(const Types& types, const std::string& type);
  void expand(const Types& types, const std::string& type, const std::string& prefix, int depth,
              std::vector<Field>& fields);
  static void add_time(const Line& line, const std::string& path, std::vector<Field>& fields);
  std::optional<size_t> want_exactly(const std::string& path, size_t count);
  static void read_field(const Field& field, RecordCursor& cursor, size_t size,
                         std::vector<double>& values);

  std::vector<Field> fields_;
  size_t fields_made_ = 0;
  size_t wanted_ = 0;
};

}  // namespace foucault::rawlog
