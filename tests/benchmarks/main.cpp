/// Measures and prints the tables of the README's section Speed, in Markdown, on stdout.
///   foucault_benchmarks [--program FILE] [--log RAWLOG] [--times N] [options of Google Benchmark]
/// Without --program the whole program is left out; without --log it gets a simulated trip.

#include <fmt/format.h>

#include <exception>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "best_times.h"
#include "kernels.h"
#include "methods.h"
#include "program_runs.h"
#include "reading.h"

namespace foucault::benchmarks {
namespace {

struct Options {
  std::string program;
  std::string log;
  int times = 5;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; i += 2) {
    const std::string name = argv[i];
    if (i + 1 == argc) throw std::runtime_error(name + " needs a value");
    if (name == "--program") {
      options.program = argv[i + 1];
    } else if (name == "--log") {
      options.log = argv[i + 1];
    } else if (name == "--times") {
      options.times = std::stoi(argv[i + 1]);
    } else {
      throw std::runtime_error("unknown option " + name);
    }
  }
  return options;
}

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "an unknown processor";
}

struct Row {
  std::string what;
  std::string benchmark;
  std::string elsewhere;  ///< published, measured on another machine
};

std::vector<Row> rows() {
  return {{"preintegration with covariance and Jacobians, an IMU sample", "preintegration/refined",
           "OB_GINS 5413 ns, gtsam 4.3a0 2023 ns"},
          {"the same, `rough`", "preintegration/rough", ""},
          {"the same, `full`", "preintegration/full", ""},
          {"the same by dense 15x15 products", "preintegration/dense", ""},
          {"preintegration factor, residual", "factor/residual", "OB_GINS 3460 ns"},
          {"preintegration factor, residual and Jacobians", "factor/residual and Jacobians",
           "OB_GINS 5657 ns, gtsam 1521 ns"},
          {"window of 20 s, an epoch at 1 Hz", "window/1 Hz", ""},
          {"window of 20 s, an epoch at 10 Hz", "window/10 Hz", ""},
          {"`ekf`, an IMU sample with its share of updates", "ekf", ""},
          {"`batch`, a node with its covariance", "batch", ""},
          {"rawlog, a record", "rawlog", ""}};
}

std::string duration_text(double ns) {
  if (ns < 1e4) return fmt::format("{:.0f} ns", ns);
  if (ns < 1e6) return fmt::format("{:.1f} µs", ns * 1e-3);
  return fmt::format("{:.2f} ms", ns * 1e-6);
}

void print_kernels(const BestTimes& times) {
  fmt::print("| | here | elsewhere |\n|---|---|---|\n");
  for (const Row& row : rows()) {
    if (!times.has(row.benchmark)) continue;
    fmt::print("| {} | {} | {} |\n", row.what, duration_text(times.ns(row.benchmark)),
               row.elsewhere);
  }
  if (!times.has("preintegration/dense") || !times.has("rawlog")) return;
  fmt::print(
      "\nDense products take {:.1f} times as long as structured ones; the rawlog gives "
      "{:.2f} million records a second.\n\n",
      times.ns("preintegration/dense") / times.ns("preintegration/refined"),
      1e3 / times.ns("rawlog"));
}

std::string published(const std::string& method) {
  if (method == "ekf") return "KF-GINS 4.9 s";
  if (method == "refined") return "OB_GINS 13.4 to 15.9 s";
  return "";
}

void print_whole(const ProgramRuns& program) {
  fmt::print("| whole program, CPU | here | times `gzip -d` | elsewhere |\n|---|---|---|---|\n");
  const auto row = [&](const std::string& what, double seconds, const std::string& elsewhere) {
    fmt::print("| {} | {:.2f} s | {:.1f} | {} |\n", what, seconds, seconds / program.gzip_s,
               elsewhere);
  };
  row("`gzip -d` of the rawlog", program.gzip_s, "");
  row("`foucault --version`: libraries loaded", program.start_s, "");
  for (const ProgramRun& run : program.runs) {
    row(fmt::format("`{}`, no figures", run.method), run.cpu_s, published(run.method));
  }
  fmt::print("\n");
}

std::string stage_text(const ProgramRun& run, const std::string& stage) {
  const auto found = run.stages.find(stage);
  return found == run.stages.end() ? "" : fmt::format("{:.0f}", 1e3 * found->second);
}

void print_stages(const ProgramRuns& program) {
  std::string head = "| `run --profile`, ms |", rule = "|---|";
  for (const ProgramRun& run : program.runs) {
    head += fmt::format(" `{}` |", run.method);
    rule += "---|";
  }
  fmt::print("{}\n{}\n", head, rule);
  for (const char* stage : {"start", "survey", "read", "align", "mechanize", "preintegrate",
                            "propagate", "update", "solve", "marginalize", "covariance", "smooth",
                            "statistics", "write", "draw", "other", "total"}) {
    std::string line = fmt::format("| {} |", stage);
    for (const ProgramRun& run : program.runs) line += fmt::format(" {} |", stage_text(run, stage));
    fmt::print("{}\n", line);
  }
}

void measure(const Options& options) {
  register_kernels();
  register_methods();
  register_reading();
  BestTimes times;
  benchmark::RunSpecifiedBenchmarks(&times);
  std::optional<ProgramRuns> program;
  if (!options.program.empty()) {
    program = measure_program(options.program, options.log, options.times);
  }
  fmt::print("{}, {} processors, GCC {}, Release, one thread, best of {}.\n\n", cpu_model(),
             std::thread::hardware_concurrency(), __VERSION__, options.times);
  print_kernels(times);
  if (!program) return;
  print_whole(*program);
  print_stages(*program);
}

}  // namespace
}  // namespace foucault::benchmarks

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  try {
    foucault::benchmarks::measure(foucault::benchmarks::parse(argc, argv));
  } catch (const std::exception& error) {
    fmt::print(stderr, "foucault_benchmarks: {}\n", error.what());
    return 1;
  }
  return 0;
}
