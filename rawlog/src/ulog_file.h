#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "binary_file.h"

/// PX4 ULog as docs.px4.io describes it ("ULog File Format"): definitions and data, no meanings.
namespace foucault::rawlog {

/// One member of a message: numbers of one type, or something to be passed over.
struct UlogField {
  std::string type;  ///< as the format names it, without its length
  size_t count = 1;
  size_t offset = 0;  ///< in the message [bytes]
};

using UlogFields = std::map<std::string, UlogField>;

/// What a subscription says.
struct UlogTopic {
  std::string name;
  int instance = 0;
  UlogFields fields;
};

/// A message, until the next one is read.
class UlogMessage {
 public:
  UlogMessage(const UlogTopic& topic, Bytes bytes, const Place& place)
      : topic_(&topic), bytes_(bytes), place_(&place) {}

  const UlogTopic& topic() const { return *topic_; }
  const Place& place() const { return *place_; }
  /// One number of a field. Throws RowError if the message ends before or it is no number.
  double number(const UlogField& field, size_t index = 0) const;
  /// The same, finite.
  double finite(const UlogField& field, size_t index = 0) const;
  /// A whole number up to 2^62.
  int64_t integer(const UlogField& field) const;

 private:
  const UlogTopic* topic_;
  Bytes bytes_;
  const Place* place_;
};

/// Reads the messages of a file one after the other.
class UlogFile {
 public:
  /// Throws DataError if the file is no ULog or of a kind that cannot be read.
  explicit UlogFile(const std::string& path);

  /// The next message of a topic; none at the end. Throws RowError and goes on behind it, or ends.
  std::optional<UlogMessage> next();

  const InputFile& file() const { return file_; }
  /// Bytes of messages of no known kind, and where the first of them begins.
  int64_t unreadable() const { return unreadable_; }
  int64_t first_unreadable() const { return first_unreadable_; }
  /// Parameters so far, as they were at the start.
  const std::map<std::string, double>& parameters() const { return parameters_; }

 private:
  struct Member {
    std::string name;
    std::string type;
    size_t count = 1;
  };

  bool read_message(char& type);
  bool enter_appended(uint64_t count);
  void define(char type);
  void pass_over(char type);
  void define_flags();
  void define_format();
  void define_parameter();
  void subscribe();
  UlogMessage data() const;
  std::optional<Member> member_of(std::string_view text) const;
  UlogFields layout(const std::string& format, size_t& size);
  size_t size_of(const std::string& type, int depth);

  BinaryFile file_;
  std::vector<unsigned char> body_;
  std::vector<int64_t> appended_;  ///< where appended data begin, in order
  std::map<std::string, std::vector<Member>> formats_;
  std::map<std::string, size_t> sizes_;  ///< of formats that were needed [bytes]
  std::map<uint16_t, UlogTopic> topics_;
  std::map<std::string, double> parameters_;
  int64_t unreadable_ = 0, first_unreadable_ = 0;
};

}  // namespace foucault::rawlog
