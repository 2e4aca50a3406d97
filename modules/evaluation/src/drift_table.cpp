#include "foucault/evaluation/drift_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "foucault/core/time.h"
#include "foucault/core/units.h"
#include "foucault/evaluation/csv_line.h"

namespace foucault::evaluation {
namespace {

std::string markdown_row(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) {
    row += ' ';
    for (const char c : cell) row += c == '|' ? std::string("\\|") : std::string(1, c);
    row += " |";
  }
  return row + "\n";
}

/// Different values of a member of those with outages, in order of appearance.
std::vector<std::string> distinct(const std::vector<MethodOutages>& drifts,
                                  std::string MethodOutages::*member) {
  std::vector<std::string> names;
  for (const MethodOutages& d : drifts) {
    if (d.empty()) continue;
    if (std::find(names.begin(), names.end(), d.*member) == names.end()) {
      names.push_back(d.*member);
    }
  }
  return names;
}

const MethodOutages* find(const std::vector<MethodOutages>& drifts, const std::string& imu,
                          const std::string& method) {
  const auto found = std::find_if(drifts.begin(), drifts.end(), [&](const MethodOutages& d) {
    return d.group == imu && d.method == method && !d.empty();
  });
  return found == drifts.end() ? nullptr : &*found;
}

std::string with_interval(const Estimate& e) {
  return fmt::format("{:.2f} [{:.2f}, {:.2f}]", e.value, e.low, e.high);
}

std::vector<std::string> statistics_cells(const std::vector<double>& values) {
  const Summary s = summarize(values);
  std::vector<std::string> cells;
  for (const Estimate& e : {s.rms, s.mean, s.median, s.p68, s.p95, s.max}) {
    cells.push_back(with_interval(e));
  }
  return cells;
}

/// Two decimals, without a minus before zero.
std::string hundredths(double value) {
  const std::string text = fmt::format("{:.2f}", value);
  return text == "-0.00" ? "0.00" : text;
}

/// Difference, percentage and its interval, a column an IMU.
std::vector<std::vector<std::string>> difference_rows(const std::vector<MethodOutages>& drifts,
                                                      const std::vector<std::string>& imus,
                                                      const std::string& base,
                                                      const std::string& other) {
  const std::string name = fmt::format("{} - {}", other, base);
  std::vector<std::vector<std::string>> rows{
      {name + " (m)"}, {name + " (%)"}, {"95 % interval (%)"}};
  for (const std::string& imu : imus) {
    const MethodOutages* a = find(drifts, imu, base);
    const MethodOutages* b = find(drifts, imu, other);
    if (!a || !b) {
      for (std::vector<std::string>& row : rows) row.push_back("-");
      continue;
    }
    const PairedComparison c = compare_paired(a->horizontal_max(), b->horizontal_max());
    rows[0].push_back(hundredths(c.rms_difference.value));
    rows[1].push_back(hundredths(100 * c.relative.value));
    rows[2].push_back(fmt::format("[{}, {}]", hundredths(100 * c.relative.low),
                                  hundredths(100 * c.relative.high)));
  }
  return rows;
}

void append(std::vector<std::string>& row, const DriftValue& value) {
  row.push_back(fmt::format("{:.4f}", value.horizontal));
  row.push_back(fmt::format("{:.4f}", value.vertical));
}

/// Empty without a return; "inf" where the error did not come back.
std::vector<std::string> return_cells(const std::optional<ReturnError>& error) {
  if (!error) return {"", "", ""};
  return {fmt::format("{:.4f}", error->rms), fmt::format("{:.4f}", error->maximum),
          error->settled_s ? fmt::format("{:.3f}", *error->settled_s) : "inf"};
}

std::vector<std::string> record_cells(const DriftRecord& record) {
  const Outage& outage = record.drift.outage;
  const GpsTime gps = unix_to_gps(outage.begin_ns);
  std::vector<std::string> row{record.recording,
                               record.imu,
                               record.method,
                               fmt::format("{}", record.shift_s),
                               fmt::format("{}", outage.index + 1),
                               units::format_stamp(outage.begin_ns),
                               fmt::format("{}", gps.week),
                               units::format_stamp(gps.tow_ns),
                               fmt::format("{}", seconds_between(outage.begin_ns, outage.end_ns))};
  append(row, record.drift.maximum);
  append(row, record.drift.end);
  for (const std::optional<DriftValue>& value : record.drift.at_marks) {
    if (value) {
      append(row, *value);
    } else {
      row.insert(row.end(), 2, "");
    }
  }
  const double distance_m = record.drift.distance_m;
  row.push_back(std::isfinite(distance_m) ? fmt::format("{:.3f}", distance_m * 1e-3) : "");
  const std::vector<std::string> after_return = return_cells(record.drift.after_return);
  row.insert(row.end(), after_return.begin(), after_return.end());
  return row;
}

}  // namespace

std::string to_csv(const TextTable& table) {
  std::string csv = csv_line(table.header) + "\n";
  for (const std::vector<std::string>& row : table.rows) csv += csv_line(row) + "\n";
  return csv;
}

std::string to_markdown(const TextTable& table) {
  std::string text = table.title.empty() ? std::string() : fmt::format("**{}**\n\n", table.title);
  text += markdown_row(table.header);
  text += "|---|";
  for (std::size_t i = 1; i < table.header.size(); ++i) {
    const bool words = table.ends_in_words && i + 1 == table.header.size();
    text += words ? "---|" : "---:|";
  }
  text += "\n";
  for (const std::vector<std::string>& row : table.rows) text += markdown_row(row);
  return text;
}

std::string to_plain_text(const TextTable& table) {
  std::vector<std::size_t> widths(table.header.size());
  const auto widen = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) widths[i] = std::max(widths[i], cells[i].size());
  };
  widen(table.header);
  for (const std::vector<std::string>& row : table.rows) widen(row);
  std::string text = table.title.empty() ? std::string() : table.title + "\n";
  const auto add = [&](const std::vector<std::string>& cells) {
    text += fmt::format("{:<{}}", cells[0], widths[0]);
    for (std::size_t i = 1; i < cells.size(); ++i)
      text += fmt::format("  {:>{}}", cells[i], widths[i]);
    text += "\n";
  };
  add(table.header);
  for (const std::vector<std::string>& row : table.rows) add(row);
  return text;
}

std::vector<std::string> text_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

TextTable drift_rms_table(const std::vector<MethodOutages>& drifts,
                          const std::string& group_header) {
  const std::vector<std::string> methods = distinct(drifts, &MethodOutages::method);
  TextTable table{"RMSEs of horizontal and vertical drifts in meters", {group_header}, {}};
  for (const std::string& method : methods) {
    table.header.push_back(method + " Hor");
    table.header.push_back(method + " Ver");
  }
  for (const std::string& imu : distinct(drifts, &MethodOutages::group)) {
    std::vector<std::string> row{imu};
    for (const std::string& method : methods) {
      const MethodOutages* d = find(drifts, imu, method);
      row.push_back(d ? fmt::format("{:.2f}", root_mean_square(d->horizontal_max())) : "-");
      row.push_back(d ? fmt::format("{:.2f}", root_mean_square(d->vertical_max())) : "-");
    }
    table.rows.push_back(row);
  }
  return table;
}

TextTable drift_difference_table(const std::vector<MethodOutages>& drifts,
                                 const std::string& base) {
  TextTable table{fmt::format("Horizontal-drift differences from {}", base), {"Difference"}, {}};
  const std::vector<std::string> imus = distinct(drifts, &MethodOutages::group);
  table.header.insert(table.header.end(), imus.begin(), imus.end());
  for (const std::string& other : distinct(drifts, &MethodOutages::method)) {
    if (other == base) continue;
    const std::vector<std::vector<std::string>> rows = difference_rows(drifts, imus, base, other);
    table.rows.insert(table.rows.end(), rows.begin(), rows.end());
  }
  return table;
}

TextTable drift_statistics_table(const std::vector<MethodOutages>& drifts,
                                 const std::string& group_header) {
  TextTable table{"Per-outage maximum drift in meters, with 95 % bootstrap intervals",
                  {group_header, "Method", "Direction", "Outages", "RMS", "Mean", "Median", "68 %",
                   "95 %", "Maximum"},
                  {}};
  for (const MethodOutages& d : drifts) {
    if (d.empty()) continue;
    for (const bool horizontal : {true, false}) {
      const std::vector<double>& values = horizontal ? d.horizontal_max() : d.vertical_max();
      std::vector<std::string> row{d.group, d.method, horizontal ? "horizontal" : "vertical",
                                   fmt::format("{}", values.size())};
      const std::vector<std::string> cells = statistics_cells(values);
      row.insert(row.end(), cells.begin(), cells.end());
      table.rows.push_back(row);
    }
  }
  return table;
}

TextTable drift_record_table(const std::vector<DriftRecord>& records,
                             const std::vector<double>& marks_s) {
  TextTable table;
  table.header = {"recording",      "imu",
                  "method",         "shift_s",
                  "outage",         "begin_unix_s",
                  "begin_gps_week", "begin_gps_s",
                  "length_s",       "max_horizontal_m",
                  "max_vertical_m", "end_horizontal_m",
                  "end_vertical_m"};
  for (const double mark_s : marks_s) {
    table.header.push_back(fmt::format("horizontal_{}s_m", mark_s));
    table.header.push_back(fmt::format("vertical_{}s_m", mark_s));
  }
  for (const char* name :
       {"distance_km", "return_rms_horizontal_m", "return_max_horizontal_m", "return_settled_s"}) {
    table.header.push_back(name);
  }
  for (const DriftRecord& record : records) table.rows.push_back(record_cells(record));
  return table;
}

}  // namespace foucault::evaluation
