#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "record_cursor.h"

namespace foucault::rawlog {

/// How messages are put into bytes: as ROS 1 does (wiki.ros.org/msg), or as ROS 2 does, by the
/// plain CDR of XCDR1 behind four bytes that tell the order of bytes (OMG DDS-XTypes 1.3, 7.4.3).
enum class RosEncoding { ros1, cdr, unknown };

/// A message type as its recording tells it.
struct RosType {
  std::string name;        ///< sensor_msgs/Imu, sensor_msgs/msg/Imu
  std::string definition;  ///< its text and those of the types within; empty: not told
  RosEncoding encoding = RosEncoding::ros1;
};

/// Of a type: less the "msg/" that ROS 2 puts behind the package.
std::string package_and_type(std::string name);

/// How a message lies in its bytes, by the definition that its recording has of it; types that it
/// lacks are looked up among those that ship with ROS (ros_builtin_types). Numbers in it are named
/// by their path, as `linear_acceleration.x`; a time has the two numbers `sec` and `nanosec`.
class RosLayout {
 public:
  /// Throws BadRecord if the definition cannot be followed.
  explicit RosLayout(const RosType& type);

  /// Where read() puts the `count` numbers of a field, which may be wrapped as std_msgs does
  /// (`path.data`); none if there is no such field.
  std::optional<size_t> want(const std::string& path, size_t count = 1);
  bool has(const std::string& path) const;
  /// Of a text read() gives two numbers: where it begins in the message, and its length.
  std::optional<size_t> want_text(const std::string& path);

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

  static void add_types(std::string_view definition, const std::string& name, Types& types);
  static std::optional<Line> line_of(std::string_view text);
  static void take_brackets(Line& line);
  static std::optional<std::string> find_type(const Types& types, const std::string& name,
                                              const std::string& within);
  void expand(const Types& types, const std::string& type, const std::string& prefix, int depth,
              std::vector<Field>& fields);
  void expand_line(const Types& types, const std::string& within, const Line& line,
                   const std::string& path, int depth, std::vector<Field>& fields);
  static void add_time(const Line& line, const std::string& path, std::vector<Field>& fields);
  std::optional<size_t> want_exactly(const std::string& path, size_t count);

  RosEncoding encoding_;
  std::vector<Field> fields_;
  size_t fields_made_ = 0;
  size_t wanted_ = 0;

  friend class RosFieldReader;
};

}  // namespace foucault::rawlog
