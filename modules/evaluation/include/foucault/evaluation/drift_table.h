#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foucault/evaluation/drift.h"
#include "foucault/evaluation/method_outages.h"
#include "foucault/evaluation/statistics.h"

/// The paper's tables, and drifts as text.
namespace foucault::evaluation {

/// Cells as they are shown, one header row.
struct TextTable {
  std::string title;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  ///< as long as the header
  bool ends_in_words = false;                  ///< the last column, too, is to the left in Markdown
};

/// RFC 4180: cells with commas, quotes or line ends are quoted.
std::string to_csv(const TextTable& table);
/// GitHub's Markdown, title in bold above.
std::string to_markdown(const TextTable& table);
/// For a terminal: columns in line, the first one to the left, the others to the right.
std::string to_plain_text(const TextTable& table);

/// A text without its line ends.
std::vector<std::string> text_lines(const std::string& text);

/// Table III, "RMSEs of horizontal and vertical drifts in meters": a row an IMU, two columns a
/// method; RMS of the per-outage maximum. Rows and columns in order of appearance; "-" where
/// nothing was run. `group_header` heads the column of the groups.
TextTable drift_rms_table(const std::vector<MethodOutages>& outages,
                          const std::string& group_header = "IMU");

/// Table IV, "Horizontal-drift differences from `base`": a column a group, and for each other
/// method the rows difference [m], percentage (other - base) / base, and the bootstrap interval of
/// the percentage. "-" where one of both was not run.
TextTable drift_difference_table(const std::vector<MethodOutages>& outages,
                                 const std::string& base);

/// Statistics over outages: a row a group and method; RMS, mean, median, 68 %, 95 %, maximum, each
/// with its interval.
TextTable drift_statistics_table(const std::vector<MethodOutages>& outages,
                                 const std::string& group_header = "IMU");

/// One outage by one method, for drift.csv.
struct DriftRecord {
  std::string recording;
  std::string imu;
  std::string method;
  double shift_s = 0;
  OutageDrift drift;
};

/// A row an outage and method. Columns: recording, imu, method, shift_s, outage (from 1),
/// begin_unix_s, begin_gps_week, begin_gps_s, length_s, max_horizontal_m, max_vertical_m,
/// end_horizontal_m, end_vertical_m, horizontal_<mark>s_m, vertical_<mark>s_m for each mark,
/// distance_km, and of the return (see ReturnError) return_rms_horizontal_m,
/// return_max_horizontal_m, return_settled_s ("inf": never); empty where there is no value.
/// Without a reference the errors in the return are those against fixes that the method has used:
/// centimetres there say little, metres and more are real.
TextTable drift_record_table(const std::vector<DriftRecord>& records,
                             const std::vector<double>& marks_s);

}  // namespace foucault::evaluation
