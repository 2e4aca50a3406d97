#pragma once

#include <array>
#include <string>
#include <vector>

#include "table_columns.h"

/// Raw counts of a sensor as tables have them.
namespace foucault::rawlog {

enum class CountFormat {
  decimal,
  uint16,  ///< two's complement of 16 bits as 0 to 65535
  hex      ///< two's complement in hexadecimal digits: up to 4 are 16 bits, 6 are 24, 8 are 32
};

/// Of a mapping's imu.counts; none of `auto`.
std::optional<CountFormat> count_format(const std::string& name);

/// By the first 5000 rows: hex if cells begin with 0x, or all have 4 or 8 hexadecimal digits and
/// some a letter; uint16 if they are whole numbers of 0 to 65535 that are much smoother when read
/// so; else decimal.
CountFormat count_format_of(TextTable& table, const std::vector<size_t>& columns);

/// One cell. Throws RowError.
double count_of(const Row& row, size_t column, CountFormat format);

}  // namespace foucault::rawlog
