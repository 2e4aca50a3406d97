#include "jobs/laboratory_job.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "foucault/ekf/ekf.h"
#include "foucault/rawlog/rawlog_source.h"
#include "foucault/store/archive.h"
#include "jobs/simulation_job.h"
#include "methods.h"

namespace foucault::app {
namespace {

void write(const laboratory::FaultCase& fault, const Settings& settings, int64_t seed,
           const std::string& log) {
  SimulationSettings simulation;
  simulation.imu = settings.imu;
  simulation.scenario = laboratory::fault_scenario(seed);
  Console quiet(true);
  write_simulation(simulation, fault, log, quiet);
}

/// What `foucault run` does with a log, and says.
std::optional<std::string> process(const std::string& log, const std::string& method,
                                   const Settings& settings, laboratory::FaultObserver& observer) {
  rawlog::RawlogSource source(log, settings.imu.sample_kind(), settings.rawlog);
  observer.place(source.mounting());
  const std::unique_ptr<state::Estimator> estimator =
      methods::find(method).make(method_options(settings, source.mounting()), observer);
  while (const std::optional<Measurement> measurement = source.next()) {
    if (const auto* reference = std::get_if<ReferencePose>(&*measurement)) {
      observer.reference(*reference);
    }
    estimator->process(*measurement);
  }
  estimator->finish();
  observer.judge();
  for (const state::Notice& notice : source.notices()) observer.notice(notice);
  return source.damage();
}

template <class Archive, class Outcome>
void fault_fields(Archive& archive, Outcome& o) {
  archive.field(o.fault);
  archive.field(o.method);
  archive.field(o.seed);
  store::integral(archive, o.exit_code);
  archive.field(o.message);
  archive.field(o.used);
  archive.field(o.rejected);
  store::optional(archive, o.trust, [&](auto& trust) {
    store::integral(archive, trust.trustworthy);
    store::list(archive, trust.reasons, [&](auto& reason) { archive.field(reason); });
  });
  archive.field(o.errors);
  archive.field(o.rms_m);
  archive.field(o.largest_m);
  store::optional(archive, o.recovery_s, [&](auto& recovery_s) { archive.field(recovery_s); });
}

std::string content_of(const std::vector<laboratory::FaultOutcome>& outcomes) {
  store::Recorder recorder;
  store::list(recorder, outcomes, [&](auto& outcome) { fault_fields(recorder, outcome); });
  return recorder.bytes();
}

std::vector<laboratory::FaultOutcome> outcomes_of(const std::string& content) {
  store::Player player(content);
  std::vector<laboratory::FaultOutcome> outcomes;
  store::list(player, outcomes, [&](auto& outcome) { fault_fields(player, outcome); });
  player.finish();
  return outcomes;
}

/// A fault on the trip of a seed, by all methods.
struct FaultTask {
  std::string fault;
  int64_t seed;
};

std::vector<FaultTask> fault_tasks(const FaultStudy& study) {
  for (const std::string& method : study.methods) methods::find(method);
  std::vector<FaultTask> tasks;
  for (const std::string& name : study.faults) {
    laboratory::find_fault_case(name);
    for (const int64_t seed : study.seeds) tasks.push_back({name, seed});
  }
  return tasks;
}

}  // namespace

std::vector<laboratory::FaultOutcome> run_fault(const laboratory::FaultCase& fault,
                                                const std::vector<std::string>& methods,
                                                const Settings& settings, int64_t seed,
                                                const std::string& log) {
  laboratory::FaultProgram program;
  program.write = [&](const laboratory::FaultCase& what, int64_t of_trip, const std::string& path) {
    write(what, settings, of_trip, path);
  };
  program.process = [&](const std::string& path, const std::string& method,
                        laboratory::FaultObserver& observer) {
    return process(path, method, settings, observer);
  };
  return laboratory::run_fault(fault, methods, seed, log, program);
}

std::vector<laboratory::FaultOutcome> study_faults(const FaultStudy& study, RunStore& store,
                                                   const std::filesystem::path& folder,
                                                   Console& console) {
  const std::vector<FaultTask> tasks = fault_tasks(study);
  evaluation::Batch batch;
  for (const FaultTask& task : tasks) {
    batch.keys.push_back(store::key_of(
        fmt::format("fault 1\n{}\n{}\n{}\n{}\n{}", store.version(), task.fault, task.seed,
                    fmt::join(study.methods, ","), settings_text(Settings()))));
  }
  batch.compute = [&](std::size_t i, const evaluation::TaskProgress& progress) {
    progress(0);
    const auto& [fault, seed] = tasks[i];
    const std::filesystem::path log = folder / fmt::format("{}-{}.rawlog", fault, seed);
    return store::Record{content_of(run_fault(laboratory::find_fault_case(fault), study.methods,
                                              Settings(), seed, log.string())),
                         0};
  };
  store.runs().complete(batch, console.progress_of("faults"));
  std::vector<laboratory::FaultOutcome> outcomes;
  for (std::size_t i = 0; i < tasks.size() && !store.is_worker(); ++i) {
    for (laboratory::FaultOutcome& outcome : outcomes_of(store.runs().get(batch, i).content)) {
      outcomes.push_back(std::move(outcome));
    }
  }
  store.report(tasks.size(), console);
  return outcomes;
}

laboratory::ReturnOutcome study_return(const laboratory::ReturnCase& what,
                                       const Settings& settings) {
  laboratory::ReturnProgram program;
  program.outages = settings.outages;
  program.noise = settings.imu.noise();
  program.open = [&](const std::string& log) {
    return std::make_unique<rawlog::RawlogSource>(log, settings.imu.sample_kind(), settings.rawlog);
  };
  program.method = [&](const laboratory::ReturnCase& of_case, bool gate) {
    Settings configured = settings;
    configured.imu = settings.imu.scaled(of_case.noise);
    if (!gate) configured.gnss.gate_false_alarm = 0;
    const methods::Method& method = methods::find(of_case.method);
    const auto make = [make = method.make, configured](const state::Mounting& mounting,
                                                       state::Sink& sink) {
      return make(method_options(configured, mounting), sink);
    };
    return laboratory::ReturnMethod{make, method.keep_references_s};
  };
  return laboratory::study_return(what, program);
}

laboratory::StartOutcome study_start(int64_t seed, const Settings& settings) {
  laboratory::StartProgram program;
  program.filter = [&](const imu::ImuNoise& noise) {
    return std::make_unique<ekf::EkfNavigator>(noise, state::Layout(), settings.ekf);
  };
  program.run = [&](const std::string& imu, const state::Mounting& mounting, state::Sink& sink) {
    Settings configured = settings;
    configured.imu.preset = imu;
    configured.aids.gnss_velocity = "on";
    return methods::find("ekf").make(method_options(configured, mounting), sink);
  };
  return laboratory::study_start(seed, program);
}

}  // namespace foucault::app
