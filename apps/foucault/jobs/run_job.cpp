#include "jobs/run_job.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "foucault/content/run_report.h"
#include "foucault/core/error.h"
#include "foucault/core/profile.h"
#include "foucault/export/text_file.h"
#include "foucault/rawlog/rawlog_source.h"
#include "jobs/run_output.h"
#include "jobs/survey.h"
#include "methods.h"
#include "output_directory.h"
#include "pages/run_page.h"
#include "texts/profile_text.h"
#include "texts/run_text.h"
#include "version.h"

namespace foucault::app {
namespace {

/// An estimator does not know where its measurements come from, and that they ended too early;
/// whoever reads its errors should.
template <class Work>
void naming(const std::string& log, const rawlog::RawlogSource& source, Work work) {
  try {
    work();
  } catch (const exports::WriteError&) {
    throw;
  } catch (const DataError& error) {
    const std::string of = source.damage().value_or(fmt::format("'{}'", log));
    throw DataError(fmt::format("{}: {}", of, error.what()));
  }
}

/// So many that a profile need not look at the clock for each measurement.
constexpr std::size_t kBatch = 64;

/// Empty at the end of the log.
void read_batch(rawlog::RawlogSource& source, std::vector<Measurement>& batch) {
  const StageTimer timer(Stage::read);
  batch.clear();
  while (batch.size() < kBatch) {
    std::optional<Measurement> measurement = source.next();
    if (!measurement) return;
    batch.push_back(std::move(*measurement));
  }
}

void process_batch(const std::vector<Measurement>& batch, state::Estimator& estimator,
                   RunOutput& output) {
  for (const Measurement& measurement : batch) {
    output.measurement(measurement);
    estimator.process(measurement);
  }
}

void process(const std::string& log, rawlog::RawlogSource& source, state::Estimator& estimator,
             Stage per_sample, RunOutput& output, Console& console) {
  std::vector<Measurement> batch;
  batch.reserve(kBatch);
  for (read_batch(source, batch); !batch.empty(); read_batch(source, batch)) {
    const StageTimer timer(per_sample);
    naming(log, source, [&] { process_batch(batch, estimator, output); });
    console.progress("processing", source.progress());
  }
  naming(log, source, [&] { estimator.finish(); });
  for (const state::Notice& notice : source.notices()) output.notice(notice);
  if (source.damage()) output.damage(*source.damage());
}

content::RunLabels labels(const RunJob& job, const std::string& config) {
  return {std::filesystem::path(job.log).filename().string(),
          job.method,
          fmt::format("foucault {}", kVersion),
          job.command_line,
          config,
          job.links};
}

state::Told told(const Settings& settings, const rawlog::RawlogSource& source) {
  return {settings.calibrate.layout(), settings.calibrate.time_offset_s, source.lever_arm(),
          source.mounting().q_v_b};
}

void write_report(const RunResult& result, content::RunReport& report,
                  const std::filesystem::path& folder, Console& console) {
  const StageTimer timer(Stage::draw);
  console.progress("drawing", 0);
  report.banner(verdict_banner(result));
  for (const page::KeyNumber& number : key_numbers(result)) report.key_number(number);
  for (const page::Table& table : metrics_tables(result)) report.table(table);
  report.stages(Profile::of_thread()->times());
  report.write((folder / "report").string());
}

/// One way of a log through an estimator.
struct RunPass {
  RunPass(const RunJob& job, const Settings& settings, const std::string& config,
          const std::filesystem::path& folder, Console& console)
      : source(job.log, settings.imu.sample_kind(), settings.rawlog),
        known(told(settings, source)) {
    const methods::Method& method = methods::find(job.method);
    const state::Mounting mounting = source.mounting().with(known.layout);
    if (job.report) {
      report.emplace(labels(job, config), mounting, known);
      Profile::of_thread()->tell_solves([this](const Solve& solve) { report->solve(solve); });
    }
    output.emplace(folder, mounting, settings.output, method.keep_references_s,
                   report ? &*report : nullptr, console);
    const std::unique_ptr<state::Estimator> estimator =
        method.make(method_options(settings, source.mounting()), *output);
    process(job.log, source, *estimator, method.per_sample, *output, console);
  }

  rawlog::RawlogSource source;
  state::Told known;
  std::optional<content::RunReport> report;
  std::optional<RunOutput> output;
};

/// A log that was smoothed in parts is gone through again, with what is known at its end.
bool goes_again(fgo::BatchPasses& passes, Console& console) {
  if (passes.is_final()) return false;
  console.say("smoothing  in parts (batch.memory_mb): a second pass, with what the first found");
  passes = {passes.most_nodes, std::move(passes.found), {}, false};
  return true;
}

/// Not a number of it was changed.
bool is_of_preset(const Settings& settings) {
  Settings preset = settings;
  preset.imu = {};
  preset.imu.preset = settings.imu.preset;
  return noise_text(preset) == noise_text(settings);
}

/// Writes all but what the report draws.
RunResult result_of(RunPass& pass, const RunJob& job, const Settings& settings) {
  RunResult result;
  result.method = job.method;
  result.command_line = job.command_line;
  result.noise = is_of_preset(settings) ? settings.imu.preset : noise_text(settings);
  result.log = std::filesystem::path(job.log).filename().string();
  result.out = job.out;
  result.report = job.report;
  result.statistics_from_s = settings.output.statistics_from_s;
  result.metrics = pass.output->finish();
  result.forward = pass.output->forward(forward_method(job.method, settings));
  if (result.forward) {
    evaluation::judge_separation(result.metrics.trust, result.forward->separation);
  }
  result.facts = pass.output->facts();
  result.damage = pass.source.damage();
  if (result.metrics.epochs == 0) {
    if (result.damage) throw DataError(*result.damage);
    throw DataError(fmt::format("'{}': no epoch came out of the data", job.log));
  }
  result.calibration = evaluation::calibrated_blocks(
      state::as_users_know(pass.output->last_epoch(), pass.known), pass.known.layout);
  result.told =
      evaluation::calibrated_blocks(state::prior_as_users_know(pass.known), pass.known.layout);
  return result;
}

}  // namespace

RunResult run_into(const RunJob& job, const std::filesystem::path& folder, Console& console) {
  const ResourceMeter meter;
  const double started_cpu_s = process_cpu_s();
  Surveyor surveyor(console);
  Settings settings = surveyor.complete(job.log, settings_for(job.log, job.settings));
  // The filters of a survey have stages of their own, which are not those of the run.
  const double surveyed_cpu_s = process_cpu_s() - started_cpu_s;
  std::optional<Profile> profile;
  if (job.profile || job.report) {
    profile.emplace();
    profile->add(Stage::survey, surveyed_cpu_s);
  }
  if (job.profile) profile->add(Stage::start, started_cpu_s);
  if (job.settings.imu.preset == "auto" && settings.imu.arw_deg_sqrt_h)  // else it warned
    console.say(fmt::format("{:<10} {}; nearest preset {}", "noise", noise_text(settings),
                            settings.imu.preset));
  const std::string config = dump_config(settings);
  settings.passes = std::make_shared<fgo::BatchPasses>();
  settings.passes->most_nodes = settings.batch.most_nodes(settings.calibrate.layout());
  std::optional<RunPass> pass;
  do {
    pass.emplace(job, settings, config, folder, console);
  } while (goes_again(*settings.passes, console));

  for (const std::string& warning : surveyor.warnings(job.log)) pass->output->remark(warning);
  RunResult result = result_of(*pass, job, settings);
  result.resources = meter.used();
  if (pass->report) write_report(result, *pass->report, folder, console);
  if (job.profile) result.profile = profile->times();
  exports::write_text_file(folder / "metrics.json", metrics_json(result));
  exports::write_text_file(folder / "config.yaml", config);
  return result;
}

RunResult run(const RunJob& job, Console& console) {
  methods::find(job.method);
  job.settings.imu.noise();
  OutputDirectory out(job.out);
  for (const char* name : {"report", "reference.tum"}) out.withdraw(name);
  const RunResult result = run_into(job, out.staging(), console);
  out.commit();
  return result;
}

std::vector<std::string> summary_lines(const RunResult& result) {
  std::vector<std::string> lines = metrics_lines(result);
  for (const std::string& line : profile_lines(result.profile)) lines.push_back(line);
  for (const std::string& line : written_lines(result.out, result.report)) lines.push_back(line);
  lines.push_back(verdict_line(result));
  return lines;
}

}  // namespace foucault::app
