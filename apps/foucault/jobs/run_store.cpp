#include "jobs/run_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/loaded_part.h"
#include "foucault/store/file_hash.h"
#include "interrupt.h"
#include "version.h"

namespace fs = std::filesystem;

namespace foucault::app {
namespace {

std::string hidden_folder(const std::string& out) {
  std::error_code error;
  fs::path target = fs::absolute(out, error).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  return (target.parent_path() / ("." + target.filename().string() + ".foucault-records")).string();
}

evaluation::Executor::Options options(const StoreArguments& arguments, int threads) {
  if (!arguments.shard.empty() && arguments.no_compute) {
    throw UsageError("--shard computes and --no-compute does not; give one of them");
  }
  evaluation::Executor::Options options;
  options.threads = threads;
  options.compute = !arguments.no_compute;
  if (!arguments.shard.empty()) {
    options.shard = store::parse_shard(arguments.shard, store::process_environment());
  }
  return options;
}

/// Logs are read and looked through even where no run is to be computed, if nobody has.
evaluation::Executor::Options computing(evaluation::Executor::Options options) {
  options.compute = true;
  return options;
}

/// The number of a version stays while a program is worked on; its bytes do not, nor those of the
/// part that reads logs for it (a program linked to the readers has no such part).
std::string program_version() {
  const fs::path readers = part_file("foucault_mrpt");
  return fmt::format("{} {} {}", kVersion, store::hex(store::hash_file("/proc/self/exe")),
                     fs::exists(readers) ? store::hex(store::hash_file(readers)) : "");
}

}  // namespace

RunStore::RunStore(int threads)
    : version_(program_version()),
      records_(std::make_unique<store::MemoryRecords>()),
      runs_(*records_, {threads, std::nullopt, true}),
      preparations_(*records_, {threads, std::nullopt, true}) {}

RunStore::RunStore(const StoreArguments& arguments, const std::string& out, int threads)
    : hidden_(arguments.folder.empty() ? hidden_folder(out) : ""),
      version_(program_version()),
      records_(std::make_unique<store::RecordStore>(hidden_.empty() ? arguments.folder : hidden_)),
      on_disk_(static_cast<const store::RecordStore*>(records_.get())),
      runs_(*records_, options(arguments, threads)),
      preparations_(*records_, computing(options(arguments, threads))) {
  if (out.empty()) throw UsageError("--out is empty; name a folder for the results");
  was_there_ = fs::exists(on_disk_->folder());
  for (fs::path p = fs::path(hidden_).parent_path(); !p.empty() && !fs::exists(p);
       p = p.parent_path()) {
    new_parents_.push_back(p);
  }
  if (arguments.no_compute && !was_there_) {
    throw DataError(
        fmt::format("--no-compute: there is no store '{}'; name that of the workers "
                    "with --store",
                    on_disk_->folder()));
  }
}

RunStore::~RunStore() {
  constexpr double kWorthKeeping = 10;  // [s]
  const bool stays = stays_ || was_there_ || is_worker() || runs_.computed_s() > kWorthKeeping;
  if (!stays) remove();
}

void RunStore::remove() {
  std::error_code ignored;
  if (hidden_.empty()) return;
  fs::remove_all(hidden_, ignored);
  for (const fs::path& parent : new_parents_) fs::remove(parent, ignored);  // if it is empty
}

void RunStore::finish() {
  if (!is_worker()) remove();
}

std::vector<std::string> RunStore::contents(const std::vector<std::string>& logs,
                                            const std::function<void(const std::string&)>& check,
                                            Console& console) {
  evaluation::Batch batch;
  for (const std::string& log : logs) {
    batch.keys.push_back(store::key_of("file\n" + store::file_stamp(log)));
  }
  batch.compute = [&](std::size_t i, const evaluation::TaskProgress& progress) {
    progress(0);
    check(logs[i]);
    return store::Record{store::hex(store::hash_file(logs[i])), 0};
  };
  preparations_.complete(batch, console.progress_of("reading"));
  std::vector<std::string> contents;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    contents.push_back(preparations_.get(batch, i).content);
  }
  return contents;
}

void RunStore::keep_if_stopped(Console& console, const std::function<void()>& work) {
  try {
    work();
  } catch (const Interrupted&) {
    stays_ = runs_.computed() > 0;
    if (stays_ && !hidden_.empty()) {
      console.warn(fmt::format("{} finished runs are kept in {}; the same command goes on there",
                               runs_.computed(), hidden_));
    }
    throw;
  } catch (...) {
    say_damages(console);
    throw;
  }
}

void RunStore::say_damages(Console& console) const {
  if (on_disk_ == nullptr) return;
  for (const std::string& remark : on_disk_->remarks()) console.warn(remark);
}

void RunStore::report(std::size_t all_runs, Console& console) const {
  if (on_disk_ == nullptr) return;
  say_damages(console);
  const std::size_t computed = runs_.computed();
  if (is_worker() || all_runs > computed) {
    console.say(fmt::format("{:<10} {} runs computed, {} found in {}", "store", computed,
                            all_runs - std::min(all_runs, computed), on_disk_->folder()));
  }
}

std::string run_text(const RunStore& store, const std::string& content, const std::string& method,
                     double shift_s, bool with_track, const std::string& settings) {
  return fmt::format("run 1\n{}\n{}\n{}\n{}\n{}\n{}", store.version(), content, method, shift_s,
                     with_track ? "with track" : "without track", settings);
}

std::string settings_text(Settings settings) {
  settings.outages.shifts_s = {0};
  return dump_config(settings);
}

Settings settings_of(const std::string& text, const std::vector<double>& shifts_s) {
  Settings settings;
  load_config_text(text, "settings of a run", settings);
  settings.rawlog.fix_delay_s = settings.calibrate.time_offset_s;
  settings.outages.shifts_s = shifts_s;
  return settings;
}

}  // namespace foucault::app
