#include "jobs/laboratory_job.h"

#include <memory>
#include <optional>
#include <variant>

#include "foucault/ekf/ekf.h"
#include "foucault/rawlog/rawlog_source.h"
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
