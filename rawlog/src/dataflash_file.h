#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "binary_file.h"

/// ArduPilot's DataFlash logs as ardupilot.org and AP_Logger's LogStructure describe them, binary
/// (.bin) and as text (.log): messages that FMT messages define. No meanings.
namespace foucault::rawlog {

struct DataflashField {
  char type = 0;  ///< letter of the format
  size_t index = 0;
  size_t offset = 0;  ///< in the message [bytes]
};

struct DataflashFormat {
  std::string name;
  size_t length = 0;  ///< with its header [bytes]
  std::map<std::string, DataflashField, std::less<>> fields;
};

/// A message, until the next one is read.
class DataflashMessage {
 public:
  DataflashMessage(const DataflashFormat& format, Bytes bytes, const Place& place)
      : format_(&format), bytes_(bytes), place_(&place) {}
  DataflashMessage(const DataflashFormat& format, const std::vector<std::string_view>& texts,
                   const Place& place)
      : format_(&format), texts_(&texts), place_(&place) {}

  const std::string& name() const { return format_->name; }
  const Place& place() const { return *place_; }
  bool has(std::string_view field) const { return format_->fields.count(field) > 0; }
  /// In its unit: hundredths and degrees of 1e-7 become whole ones. None without such a field.
  /// Throws RowError if it is no number or not finite.
  std::optional<double> number(std::string_view field) const;
  /// The same, of one that must be there.
  double needed(std::string_view field) const;
  std::string text(std::string_view field) const;

 private:
  double value(const DataflashField& field) const;
  std::string_view text_of(const DataflashField& field) const;

  const DataflashFormat* format_;
  Bytes bytes_;                                           ///< of binary logs
  const std::vector<std::string_view>* texts_ = nullptr;  ///< of text logs
  const Place* place_;
};

/// Reads the messages of a file one after the other. Bytes that are no message are passed over and
/// counted.
class DataflashFile {
 public:
  /// Throws DataError if the file cannot be opened or is no such log.
  explicit DataflashFile(const std::string& path);

  /// The next message that is no definition.
  std::optional<DataflashMessage> next();

  const InputFile& file() const { return file_; }
  /// Parameters so far, as they were first.
  const std::map<std::string, double>& parameters() const { return parameters_; }
  int64_t damages() const { return damages_; }  ///< runs of bytes that are no message
  int64_t damaged_bytes() const { return damaged_bytes_; }
  int64_t first_damage() const { return first_damage_; }  ///< [byte]

 private:
  std::optional<DataflashMessage> next_binary();
  std::optional<DataflashMessage> next_line();
  bool read_line();
  const DataflashFormat* format_at(Bytes window) const;
  bool follows(Bytes window, size_t length) const;
  std::optional<size_t> begins_within(Bytes window, size_t length) const;
  void define(const std::string& name, const std::string& types, const std::string& columns,
              size_t type, size_t length);
  void define_binary();
  void define_text();
  bool is_definition(const DataflashMessage& message);
  void pass_over(uint64_t count);

  BinaryFile file_;
  bool is_text_ = false;
  std::map<size_t, DataflashFormat> formats_;         ///< by type
  std::map<std::string, size_t, std::less<>> types_;  ///< by name
  std::vector<unsigned char> body_;
  std::vector<std::string_view> texts_;
  std::map<std::string, double> parameters_;
  bool lost_ = false;  ///< where messages begin
  int64_t damages_ = 0;
  int64_t damaged_bytes_ = 0;
  int64_t first_damage_ = 0;
};

}  // namespace foucault::rawlog
