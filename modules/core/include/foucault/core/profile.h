#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

/// Where the time of a run goes, stage by stage.
///
/// A Profile belongs to the thread that made it, for as long as it lives. Code that works for a
/// stage holds a StageTimer; timers nest, and time counts for the innermost one alone, so that the
/// stages add up to the whole. The profile is found through a pointer of the thread: a parameter
/// for it would go through every factory, estimator, navigator and sink for the sake of one option,
/// and a thread without a profile (each worker of `evaluate`) pays a load and a branch a timer.
///
/// Times are CPU times of the process. Its clock is a system call of up to microseconds, the steady
/// clock takes 20 to 100 ns: timers read the steady one, and every kWindow what they have found is
/// scaled to the CPU time that really went by, so that a busy machine changes nothing. Still, no
/// timer belongs into what runs for every IMU sample. What is done for each sample is timed by
/// difference: an outer timer over a batch of samples, less the timers in it, which run once an
/// epoch.
namespace foucault {

enum class Stage {
  start,         ///< the process before the run: loading of libraries
  survey,        ///< the log gone through before: what is wrong, clocks, noise
  read,          ///< log to measurements
  align,         ///< initial state
  mechanize,     ///< every IMU sample of a filter
  preintegrate,  ///< every IMU sample of a factor graph; its factors
  propagate,     ///< both of these, where a method does both
  update,        ///< fixes, in a filter
  solve,         ///< optimization
  marginalize,   ///< elimination along the chain, the prior it leaves
  covariance,
  smooth,      ///< backward pass
  statistics,  ///< metrics, errors against a reference
  write,       ///< solution files
  draw,        ///< report: collecting and drawing
  other,
};
constexpr std::size_t kStages = static_cast<std::size_t>(Stage::other) + 1;

/// Name in tables and files, e.g. "read".
const char* stage_name(Stage stage);

struct StageTime {
  Stage stage = Stage::other;
  double seconds = 0;
  int64_t entries = 0;  ///< how often the stage was entered
};

/// One optimization.
struct Solve {
  int64_t t_ns = 0;       ///< of the newest node
  std::size_t nodes = 0;  ///< that it was over
  int64_t iterations = 0;
  double seconds = 0;  ///< on the clock of the wall
};

/// CPU time of the process from its start on [s].
double process_cpu_s();

class Profile {
 public:
  /// The thread's profile from now on; the time counts for Stage::other until a timer starts.
  /// Throws std::logic_error if the thread has one.
  Profile();
  ~Profile();
  Profile(const Profile&) = delete;
  Profile& operator=(const Profile&) = delete;

  /// Null where nobody asked for one.
  static Profile* of_thread() { return of_thread_; }

  /// Time that was spent before or elsewhere.
  void add(Stage stage, double seconds);

  /// What there is up to now, in the order of Stage, without stages that never were.
  std::vector<StageTime> times();

  /// Called for every optimization from now on.
  void tell_solves(std::function<void(const Solve&)> take) { take_solve_ = std::move(take); }

 private:
  friend class StageTimer;
  friend class SolveTimer;
  using Clock = std::chrono::steady_clock;

  static constexpr std::chrono::milliseconds kWindow{10};

  struct Account {
    double seconds = 0;           ///< CPU time of windows that are over
    Clock::duration in_window{};  ///< steady time in the present one
    int64_t entries = 0;
  };

  Account& account(Stage stage) { return accounts_[static_cast<std::size_t>(stage)]; }
  /// The time since the last turn is the running stage's.
  void turn_to(Stage next);
  /// Scales the window's times to the CPU time that it took.
  void close_window();

  static inline thread_local Profile* of_thread_ = nullptr;

  std::array<Account, kStages> accounts_;
  Stage running_ = Stage::other;
  Clock::time_point since_;
  Clock::time_point window_begin_;
  double window_begin_cpu_s_;
  std::function<void(const Solve&)> take_solve_;
};

/// Counts the time of its life for a stage, less that of timers within.
class StageTimer {
 public:
  explicit StageTimer(Stage stage) : profile_(Profile::of_thread()) {
    if (profile_ != nullptr) begin(stage);
  }
  ~StageTimer() {
    if (profile_ != nullptr) profile_->turn_to(outer_);
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  void begin(Stage stage);

  Profile* profile_;
  Stage outer_ = Stage::other;
};

/// Lives as long as an optimization and tells the thread's profile of it, if anyone asked.
class SolveTimer {
 public:
  SolveTimer(int64_t t_ns, std::size_t nodes) : solve_{t_ns, nodes, 0, 0} {}
  ~SolveTimer();
  SolveTimer(const SolveTimer&) = delete;
  SolveTimer& operator=(const SolveTimer&) = delete;

  void iterated(int64_t times = 1) { solve_.iterations += times; }

 private:
  Solve solve_;
  Profile::Clock::time_point begin_ = Profile::Clock::now();
};

}  // namespace foucault
