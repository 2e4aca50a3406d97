#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "console.h"
#include "foucault/evaluation/executor.h"
#include "settings.h"

namespace foucault::app {

/// --store, --shard and --no-compute of a subcommand.
struct StoreArguments {
  std::string folder;  ///< empty: a hidden one beside --out
  std::string shard;   ///< empty: no worker, but the one who writes the results
  bool no_compute = false;
};

/// Where the runs of a command are kept, and who computes what is not there.
class RunStore {
 public:
  /// For what need not outlive the process.
  explicit RunStore(int threads);
  /// Throws UsageError for a shard that makes no sense.
  RunStore(const StoreArguments& arguments, const std::string& out, int threads);
  /// Removes a hidden store, unless it was there before or has taken a while to compute.
  ~RunStore();
  RunStore(const RunStore&) = delete;
  RunStore& operator=(const RunStore&) = delete;

  /// Computes a share, and writes no results.
  bool is_worker() const { return runs_.options().shard.has_value(); }

  /// Of runs.
  evaluation::Executor& runs() { return runs_; }
  /// Of what comes before: contents of logs, and what they show.
  evaluation::Executor& preparations() { return preparations_; }

  /// A text for each log that its content alone decides on. A log is read once, as long as its size
  /// and time of change stay. `check` may throw what is wrong with one.
  std::vector<std::string> contents(const std::vector<std::string>& logs,
                                    const std::function<void(const std::string&)>& check,
                                    Console& console);

  /// Of this program, whatever its number says.
  const std::string& version() const { return version_; }

  /// Does the work of a command. If it is stopped, a hidden store stays, and the user is told; if
  /// it fails, of records that were damaged, too.
  void keep_if_stopped(Console& console, const std::function<void()>& work);

  /// The results are written: a hidden store has done its duty.
  void finish();

  /// How much was found and computed, and what was damaged.
  void report(std::size_t all_runs, Console& console) const;

 private:
  void remove();
  void say_damages(Console& console) const;

  std::string hidden_;                              ///< folder; empty: the user's own, or none
  std::vector<std::filesystem::path> new_parents_;  ///< folders above it that are not there yet
  bool was_there_ = false;
  bool stays_ = false;
  std::string version_;
  std::unique_ptr<store::Records> records_;
  const store::RecordStore* on_disk_ = nullptr;
  evaluation::Executor runs_;
  evaluation::Executor preparations_;
};

/// What a run depends on, as a text: program, content of the log, method, shift, settings, and
/// whether its track is kept.
std::string run_text(const RunStore& store, const std::string& content, const std::string& method,
                     double shift_s, bool with_track, const std::string& settings);

/// Settings as a text, without the list of shifts: a run has one.
std::string settings_text(Settings settings);
/// The inverse of it, with these shifts.
Settings settings_of(const std::string& text, const std::vector<double>& shifts_s);

}  // namespace foucault::app
