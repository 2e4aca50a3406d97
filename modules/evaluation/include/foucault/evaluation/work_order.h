#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <random>
#include <vector>

#include "foucault/store/shard.h"

namespace foucault::evaluation {

/// What a worker does next, among things of which others do some at the same time.
class WorkOrder {
 public:
  /// `is_there`: whether somebody has finished one. `jobs`: how many each worker has under way.
  WorkOrder(std::size_t size, const store::Shard& shard, std::size_t jobs,
            std::function<bool(std::size_t)> is_there);

  /// Something to be done, or none any more. Blocks while others seem to be at work on what is
  /// left; `patience` tells how long that may last without anything being finished, and may throw
  /// to end it. From any thread.
  std::optional<std::size_t> next(const std::function<std::chrono::duration<double>()>& patience);

 private:
  using Clock = std::chrono::steady_clock;
  using Open = std::deque<std::size_t>;

  std::optional<std::size_t> of_own();
  std::optional<std::size_t> of_others();
  std::optional<std::size_t> from_the_end(Open& open);
  std::optional<std::size_t> given_up(std::chrono::duration<double> patience);
  bool drop_finished();

  store::Shard shard_;
  std::size_t jobs_;
  std::function<bool(std::size_t)> is_there_;
  std::mutex mutex_;
  std::size_t next_own_;
  std::size_t end_own_;
  std::vector<Open> others_;  ///< those behind this one first; what is not known to be there
  std::mt19937 random_;
  Clock::time_point last_news_ = Clock::now();
};

}  // namespace foucault::evaluation
