#include "foucault/evaluation/drift_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "foucault/core/time.h"

namespace foucault {
namespace {

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c;
    if (c == '"') quoted += c;
  }
  return quoted + "\"";
}

std::string markdown_row(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) {
    row += ' ';
    for (const char c : cell) row += c == '|' ? std::string("\\|") : std::string(1, c);
    row += " |";
  }
  return row + "\n";
}

/// Different values of a member, in order of appearance.
std::vector<std::string> distinct(const std::vector<MethodDrifts>& drifts,
                                  std::string MethodDrifts::*member) {
  std::vector<std::string> names;
  for (const MethodDrifts& d : drifts) {
    if (std::find(names.begin(), names.end(), d.*member) == names.end()) {
      names.push_back(d.*member);
    }
  }
  return names;
}

const MethodDrifts* find(const std::vector<MethodDrifts>& drifts, const std::string& imu,
                         const std::string& method) {
  const auto found = std::find_if(drifts.begin(), drifts.end(), [&](const MethodDrifts& d) {
    return d.imu == imu && d.method == method && !d.horizontal_max.empty();
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

void append(std::vector<std::string>& row, const DriftValue& value) {
  row.push_back(fmt::format("{:.4f}", value.horizontal));
  row.push_back(fmt::format("{:.4f}", value.vertical));
}

/// Seconds in full, without the rounding of a double.
std::string unix_seconds(int64_t t_ns) {
  return fmt::format("{}.{:09}", t_ns / kNanosecondsPerSecond, t_ns % kNanosecondsPerSecond);
}

std::vector<std::string> record_cells(const DriftRecord& record) {
  const Outage& outage = record.drift.outage;
  std::vector<std::string> row{record.recording,
                               record.imu,
                               record.method,
                               fmt::format("{}", record.shift_s),
                               fmt::format("{}", outage.index + 1),
                               unix_seconds(outage.begin_ns),
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
  return row;
}

}  // namespace

std::string to_csv(const TextTable& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    std::string text;
    for (const std::string& cell : cells) text += (&cell == &cells[0] ? "" : ",") + csv_cell(cell);
    return text + "\n";
  };
  std::string csv = line(table.header);
  for (const std::vector<std::string>& row : table.rows) csv += line(row);
  return csv;
}

std::string to_markdown(const TextTable& table) {
  std::string text = table.title.empty() ? std::string() : fmt::format("**{}**\n\n", table.title);
  text += markdown_row(table.header);
  text += "|---|";
  for (std::size_t i = 1; i < table.header.size(); ++i) text += "---:|";
  text += "\n";
  for (const std::vector<std::string>& row : table.rows) text += markdown_row(row);
  return text;
}

TextTable drift_rms_table(const std::vector<MethodDrifts>& drifts) {
  const std::vector<std::string> methods = distinct(drifts, &MethodDrifts::method);
  TextTable table{"RMSEs of horizontal and vertical drifts in meters", {"IMU"}, {}};
  for (const std::string& method : methods) {
    table.header.push_back(method + " Hor");
    table.header.push_back(method + " Ver");
  }
  for (const std::string& imu : distinct(drifts, &MethodDrifts::imu)) {
    std::vector<std::string> row{imu};
    for (const std::string& method : methods) {
      const MethodDrifts* d = find(drifts, imu, method);
      row.push_back(d ? fmt::format("{:.2f}", root_mean_square(d->horizontal_max)) : "-");
      row.push_back(d ? fmt::format("{:.2f}", root_mean_square(d->vertical_max)) : "-");
    }
    table.rows.push_back(row);
  }
  return table;
}

TextTable drift_difference_table(const std::vector<MethodDrifts>& drifts, const std::string& base,
                                 const std::string& other) {
  TextTable table{fmt::format("Horizontal-drift differences between {} and {}", base, other),
                  {"IMU"},
                  {{"Difference (m)"}, {"Percentage (%)"}, {"95 % interval (%)"}}};
  for (const std::string& imu : distinct(drifts, &MethodDrifts::imu)) {
    const MethodDrifts* a = find(drifts, imu, base);
    const MethodDrifts* b = find(drifts, imu, other);
    if (!a || !b) continue;
    const PairedComparison c = compare_paired(a->horizontal_max, b->horizontal_max);
    table.header.push_back(imu);
    table.rows[0].push_back(fmt::format("{:.2f}", c.rms_difference.value));
    table.rows[1].push_back(fmt::format("{:.2f}", 100 * c.relative.value));
    table.rows[2].push_back(
        fmt::format("[{:.2f}, {:.2f}]", 100 * c.relative.low, 100 * c.relative.high));
  }
  return table;
}

TextTable drift_statistics_table(const std::vector<MethodDrifts>& drifts) {
  TextTable table{
      "Per-outage maximum drift in meters, with 95 % bootstrap intervals",
      {"IMU", "Method", "Direction", "Outages", "RMS", "Mean", "Median", "68 %", "95 %", "Maximum"},
      {}};
  for (const MethodDrifts& d : drifts) {
    if (d.horizontal_max.empty()) continue;
    for (const bool horizontal : {true, false}) {
      const std::vector<double>& values = horizontal ? d.horizontal_max : d.vertical_max;
      std::vector<std::string> row{d.imu, d.method, horizontal ? "horizontal" : "vertical",
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
  table.header = {
      "recording",     "imu",      "method",           "shift_s",        "outage",
      "begin_unix_s",  "length_s", "max_horizontal_m", "max_vertical_m", "end_horizontal_m",
      "end_vertical_m"};
  for (const double mark_s : marks_s) {
    table.header.push_back(fmt::format("horizontal_{}s_m", mark_s));
    table.header.push_back(fmt::format("vertical_{}s_m", mark_s));
  }
  for (const DriftRecord& record : records) table.rows.push_back(record_cells(record));
  return table;
}

}  // namespace foucault
