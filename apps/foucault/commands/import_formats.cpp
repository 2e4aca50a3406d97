#include "import_formats.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "arguments.h"
#include "foucault/core/fix_quality.h"
#include "foucault/core/time.h"
#include "texts/rawlog_summary.h"

namespace foucault::app {
namespace {

std::string stream_line(const std::string& name, const rawlog::ImportStream& s) {
  std::string line = fmt::format("{:<10} {} from {}, {} .. {} ({:.1f} s)", name, s.written, s.file,
                                 utc_text(s.first_ns), utc_text(s.last_ns),
                                 seconds_between(s.first_ns, s.last_ns));
  if (s.without_fix > 0) {
    line += fmt::format(", {} rows without {}", s.without_fix, name == "GNSS" ? "a fix" : "values");
  }
  return line;
}

void report_stream(Console& console, const std::string& name, const rawlog::ImportStream& s) {
  console.say(stream_line(name, s));
  if (s.skipped > 0) {
    console.warn(
        fmt::format("{}: skipped {} bad rows, the first: {}", s.file, s.skipped, s.first_skipped));
  }
  for (const std::string& notice : s.notices) console.warn(notice);
}

}  // namespace

void report_import(Console& console, const rawlog::ImportSummary& summary, const std::string& out) {
  if (!summary.imu.file.empty()) report_stream(console, "IMU", summary.imu);
  report_stream(console, "GNSS", summary.gnss);
  if (summary.reference) report_stream(console, "reference", *summary.reference);
  std::string qualities;
  for (const auto& [quality, count] : summary.qualities) {
    qualities += fmt::format("{}{} {}", qualities.empty() ? "" : ", ", count, name_of(quality));
  }
  console.say(
      fmt::format("{:<10} {}; {} with velocity", "fixes", qualities, summary.with_velocity));
  if (summary.wheel) {
    report_stream(console, "wheels", *summary.wheel);
  } else if (summary.wheel_speeds > 0) {
    console.say(fmt::format("{:<10} {}", "wheels", summary.wheel_speeds));
  }
  if (!summary.imu.file.empty()) {
    const Eigen::Vector3d arm = summary.lever_arm_v.value_or(Eigen::Vector3d::Zero());
    console.say(fmt::format("{:<10} forward {:.3f}, right {:.3f}, down {:.3f} m{}", "lever arm",
                            arm.x(), arm.y(), arm.z(),
                            summary.lever_arm_v ? "" : " (not known: give --lever-arm)"));
  }
  console.say(fmt::format("{:<10} {}", "written", out));
}

void add_import_options(CLI::App& app, rawlog::ImportOptions& options) {
  add_output_option(app, options.out, "Rawlog to write")->required();
  app.add_flag("--skip-bad-rows", options.skip_bad_rows,
               "Leave out rows that are wrong, and count them, instead of stopping");
}

}  // namespace foucault::app
