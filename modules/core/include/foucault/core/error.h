#pragma once

#include <stdexcept>
#include <string>

/// What a user can get wrong. The message is one line that says what, where and what to do; the
/// program prints it on stderr and ends with the exit code of the class.
namespace foucault {

/// Bad data: a missing, unreadable, empty or inconsistent file. Exit code 1.
class DataError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Bad usage: an unknown option, method or config key, a value out of range. Exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace foucault
