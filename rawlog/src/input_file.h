#pragma once

#include <cstdint>
#include <string>

#include "foucault/core/error.h"

namespace foucault::rawlog {

/// Something wrong with one row or record; the message has file, place and remedy.
class RowError : public DataError {
 public:
  using DataError::DataError;
};

/// Where something that may be wrong was read.
class Place {
 public:
  virtual ~Place() = default;
  /// Throws a RowError "where: what".
  [[noreturn]] void fail(const std::string& what) const { throw RowError(where() + ": " + what); }

 protected:
  /// The file, and line or byte in it.
  virtual std::string where() const = 0;
};

/// A file that an importer is reading.
class InputFile {
 public:
  virtual ~InputFile() = default;
  virtual const std::string& path() const = 0;
  /// Of what was read last: line or byte.
  virtual int64_t position() const = 0;
  /// A position as messages name it, with the file.
  virtual std::string place(int64_t position) const = 0;
  /// Part of the file that is read, 0 to 1.
  virtual double progress() const = 0;
};

}  // namespace foucault::rawlog
