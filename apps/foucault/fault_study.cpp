#include "fault_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/evaluation/reference_error.h"
#include "foucault/simulation/simulated_source.h"
#include "methods.h"

namespace foucault::app {
namespace {

constexpr double kDuration = 460;
constexpr double kSettled = 60;  // [s] after the alignment
constexpr double kToTheEnd = std::numeric_limits<double>::infinity();

using Kind = FaultKind;

Fault middle(Kind kind, double length_s, double size = 0) {
  return {kind, kFaultStart, length_s, size};
}
Fault throughout(Kind kind, double size = 0) { return {kind, 0, kToTheEnd, size}; }

std::vector<FaultCase> make_cases() {
  return {
      {"none", "nothing", {}},
      {"outliers", "10 % of the fixes 5 to 50 m off", {throughout(Kind::fix_outliers, 0.1)}},
      {"ramp", "fixes drift off to 20 m in 60 s", {middle(Kind::fix_ramp, 60, 20)}},
      {"jump", "fixes 100 m off for 20 s", {middle(Kind::fix_jump, 20, 100)}},
      {"jump_back",
       "fixes 100 m off until the jump to the truth",
       {{Kind::fix_jump, 0, kFaultStart, 100}}},
      {"sigma_small", "sigmas ten times too small", {throughout(Kind::fix_sigma_scale, 0.1)}},
      {"sigma_zero", "sigmas of zero for 60 s", {middle(Kind::fix_sigma_zero, 60)}},
      {"sigma_negative", "negative variances for 60 s", {middle(Kind::fix_sigma_negative, 60)}},
      {"sigma_nan", "sigmas not a number for 60 s", {middle(Kind::fix_sigma_nan, 60)}},
      {"duplicate", "each fix twice", {throughout(Kind::fix_duplicate)}},
      {"late", "fixes 1.5 s late for 60 s", {middle(Kind::fix_late, 60, 1.5)}},
      {"swapped",
       "each pair of fixes in the wrong order for 60 s",
       {middle(Kind::fix_swapped, 60)}},
      {"another_week", "every tenth fix a week ahead", {throughout(Kind::fix_another_week, 1)}},
      {"imu_gap_sample", "one IMU sample missing", {middle(Kind::imu_gap, 0.005)}},
      {"imu_gap_3s", "no IMU for 3 s", {middle(Kind::imu_gap, 3)}},
      {"imu_gap_60s", "no IMU for 60 s", {middle(Kind::imu_gap, 60)}},
      {"imu_duplicate", "every tenth IMU sample twice", {throughout(Kind::imu_duplicate)}},
      {"imu_backward", "every tenth IMU sample after the next", {throughout(Kind::imu_backward)}},
      {"imu_jitter", "IMU stamps off by 1 ms, 1 sigma", {throughout(Kind::imu_jitter, 0.001)}},
      {"imu_nan", "every tenth IMU sample not a number for 60 s", {middle(Kind::imu_nan, 60)}},
      {"imu_clipped",
       "gyroscopes cut off at 10 deg/s for 60 s",
       {middle(Kind::imu_clipped, 60, 0.1745)}},
      {"imu_stuck", "third gyroscope stuck for 20 s", {middle(Kind::imu_stuck, 20)}},
      {"imu_half_rate",
       "IMU rate 100 instead of 200 Hz from the middle on",
       {middle(Kind::imu_half_rate, kToTheEnd)}},
      {"imu_splice",
       "0.3 s of the IMU missing under even stamps, caught up 60 s later",
       {middle(Kind::imu_splice, 60, 0.3)}},
      {"gyro_deg", "angular rates in deg/s", {throughout(Kind::imu_gyro_in_degrees)}},
      {"accel_g", "specific force in g", {throughout(Kind::imu_accel_in_g)}},
      {"axes", "IMU axes left and up for right and down", {throughout(Kind::imu_axes_turned)}},
      {"gps_utc",
       "IMU stamps in GPS time, fixes in UTC",
       {throughout(Kind::imu_stamps_offset, 18)}},
      {"week",
       "IMU stamps 1024 weeks early",
       {throughout(Kind::imu_stamps_offset, -1024 * 604800.0)}},
      {"no_overlap", "IMU stamps an hour late", {throughout(Kind::imu_stamps_offset, 3600)}},
  };
}

/// Errors and messages of one run.
class FaultObserver : public Sink {
 public:
  explicit FaultObserver(const Mounting& mounting)
      : comparison_(mounting, [this](const Epoch& epoch, const ReferenceError& error) {
          errors.push_back({epoch.t_ns, error.position_n.head<2>().norm()});
        }) {}

  void reference(const ReferencePose& reference) { comparison_.add(reference); }
  void epoch(const Epoch& epoch) override { comparison_.add(epoch); }
  void fix(const FixResult& fix) override { ++(fix.verdict == FixVerdict::used ? used : rejected); }
  void notice(const Notice& notice) override {
    if (notice.kind != NoticeKind::aligned) notices.push_back(notice.text);
  }

  struct Error {
    int64_t t_ns;
    double horizontal;
  };
  std::vector<Error> errors;
  std::vector<std::string> notices;
  int64_t used = 0, rejected = 0;

 private:
  ReferenceComparison comparison_;
};

void process(Source& source, Estimator& estimator, FaultObserver& observer) {
  while (const std::optional<Measurement> measurement = source.next()) {
    if (const auto* reference = std::get_if<ReferencePose>(&*measurement)) {
      observer.reference(*reference);
    }
    estimator.process(*measurement);
  }
  estimator.finish();
}

double end_of(const FaultCase& fault) {
  double end = 0;
  for (const Fault& f : fault.faults) {
    end = std::max(end, std::isfinite(f.length_s) ? f.start_s + f.length_s : f.start_s);
  }
  return end;
}

void add_errors(const std::vector<FaultObserver::Error>& errors, int64_t fault_end_ns,
                FaultOutcome& outcome) {
  if (errors.empty()) return;
  const int64_t settled_ns = errors.front().t_ns + nanoseconds(kSettled);
  double squares = 0;
  int64_t count = 0, last_bad_ns = fault_end_ns;
  for (const FaultObserver::Error& error : errors) {
    if (!(error.horizontal < kRecovered)) last_bad_ns = std::max(last_bad_ns, error.t_ns);
    if (error.t_ns < settled_ns) continue;
    squares += error.horizontal * error.horizontal;
    outcome.largest_m = std::max(outcome.largest_m, error.horizontal);
    ++count;
  }
  if (count > 0) outcome.rms_m = std::sqrt(squares / static_cast<double>(count));
  if (errors.back().horizontal < kRecovered) {
    outcome.recovery_s = seconds_between(fault_end_ns, last_bad_ns);
  }
}

std::string message_of(const std::vector<std::string>& notices) {
  if (notices.empty()) return "";
  if (notices.size() == 1) return notices.front();
  return fmt::format("{} (and {} more)", notices.front(), notices.size() - 1);
}

}  // namespace

const std::vector<FaultCase>& fault_cases() {
  static const std::vector<FaultCase> all = make_cases();
  return all;
}

const FaultCase& find_fault_case(const std::string& name) {
  std::string known;
  for (const FaultCase& fault : fault_cases()) {
    if (fault.name == name) return fault;
    known += (known.empty() ? "" : ", ") + fault.name;
  }
  throw UsageError(fmt::format("unknown fault '{}'; known: {}", name, known));
}

ScenarioOptions fault_scenario(int64_t seed) {
  ScenarioOptions scenario;
  scenario.duration_s = kDuration;
  scenario.seed = seed;
  return scenario;
}

FaultOutcome run_fault(const FaultCase& fault, const std::string& method, const Settings& settings,
                       int64_t seed) {
  const ScenarioOptions scenario = fault_scenario(seed);
  FaultySource source(std::make_unique<SimulatedSource>(scenario, settings.imu.noise()),
                      fault.faults, seed);
  FaultObserver observer(source.mounting());
  const std::unique_ptr<Estimator> estimator =
      find_method(method).make(settings, source.mounting(), observer);
  FaultOutcome outcome;
  outcome.fault = fault.name;
  outcome.method = method;
  outcome.seed = seed;
  try {
    process(source, *estimator, observer);
    outcome.message = message_of(observer.notices);
  } catch (const std::exception& error) {
    outcome.exit_code = 1;
    outcome.message = error.what();
  }
  outcome.used = observer.used;
  outcome.rejected = observer.rejected;
  add_errors(observer.errors, scenario.start_ns() + nanoseconds(end_of(fault)), outcome);
  return outcome;
}

TextTable fault_table(const std::vector<FaultOutcome>& outcomes) {
  TextTable table;
  table.title = "Faults";
  table.header = {"fault",       "injected",     "method",     "exit code", "RMS [m]",
                  "largest [m]", "recovery [s]", "fixes used", "rejected",  "message"};
  for (const FaultOutcome& o : outcomes) {
    const bool numbers = o.exit_code == 0;
    table.rows.push_back({o.fault, find_fault_case(o.fault).title, o.method,
                          fmt::format("{}", o.exit_code),
                          numbers ? fmt::format("{:.3f}", o.rms_m) : "",
                          numbers ? fmt::format("{:.2f}", o.largest_m) : "",
                          !numbers       ? ""
                          : o.recovery_s ? fmt::format("{:.0f}", *o.recovery_s)
                                         : "never",
                          fmt::format("{}", o.used), fmt::format("{}", o.rejected), o.message});
  }
  return table;
}

}  // namespace foucault::app
