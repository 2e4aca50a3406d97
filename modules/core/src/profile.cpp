#include "foucault/core/profile.h"

#include <ctime>
#include <stdexcept>

namespace foucault {

const char* stage_name(Stage stage) {
  static constexpr std::array<const char*, kStages> kNames{
      "start",      "survey", "read",  "align",       "mechanize",  "preintegrate",
      "propagate",  "update", "solve", "marginalize", "covariance", "smooth",
      "statistics", "write",  "draw",  "other"};
  return kNames[static_cast<std::size_t>(stage)];
}

double process_cpu_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Profile::Profile()
    : since_(Clock::now()), window_begin_(since_), window_begin_cpu_s_(process_cpu_s()) {
  if (of_thread_ != nullptr) throw std::logic_error("a thread has one profile at a time");
  of_thread_ = this;
}

Profile::~Profile() { of_thread_ = nullptr; }

void Profile::add(Stage stage, double seconds) {
  account(stage).seconds += seconds;
  ++account(stage).entries;
}

void Profile::turn_to(Stage next) {
  const Clock::time_point now = Clock::now();
  account(running_).in_window += now - since_;
  since_ = now;
  running_ = next;
  if (now - window_begin_ > kWindow) close_window();
}

void Profile::close_window() {
  const double cpu_s = process_cpu_s();
  const std::chrono::duration<double> length = since_ - window_begin_;
  const double share = length.count() > 0 ? (cpu_s - window_begin_cpu_s_) / length.count() : 0;
  for (Account& account : accounts_) {
    account.seconds += share * std::chrono::duration<double>(account.in_window).count();
    account.in_window = {};
  }
  window_begin_ = since_;
  window_begin_cpu_s_ = cpu_s;
}

std::vector<StageTime> Profile::times() {
  turn_to(running_);
  close_window();
  std::vector<StageTime> times;
  for (std::size_t i = 0; i < kStages; ++i) {
    const Stage stage = static_cast<Stage>(i);
    const Account& of_stage = accounts_[i];
    if (of_stage.entries == 0 && stage != Stage::other) continue;
    times.push_back({stage, of_stage.seconds, of_stage.entries});
  }
  return times;
}

void StageTimer::begin(Stage stage) {
  outer_ = profile_->running_;
  profile_->turn_to(stage);
  ++profile_->account(stage).entries;
}

SolveTimer::~SolveTimer() {
  const Profile* const profile = Profile::of_thread();
  if (profile == nullptr || !profile->take_solve_) return;
  solve_.seconds = std::chrono::duration<double>(Profile::Clock::now() - begin_).count();
  profile->take_solve_(solve_);
}

}  // namespace foucault
