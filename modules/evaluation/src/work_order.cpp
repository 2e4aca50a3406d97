#include "foucault/evaluation/work_order.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <thread>
#include <tuple>
#include <utility>

namespace foucault::evaluation {

WorkOrder::WorkOrder(std::size_t size, const store::Shard& shard, std::size_t jobs,
                     std::function<bool(std::size_t)> is_there)
    : shard_(shard),
      jobs_(jobs),
      is_there_(std::move(is_there)),
      random_(static_cast<std::mt19937::result_type>(shard.index)) {
  std::tie(next_own_, end_own_) = shard.range(size);
  for (std::size_t k = 1; k < shard.count; ++k) {
    const auto [begin, end] =
        store::Shard{(shard.index + k) % shard.count, shard.count}.range(size);
    Open open(end - begin);
    std::iota(open.begin(), open.end(), begin);
    others_.push_back(std::move(open));
  }
}

std::optional<std::size_t> WorkOrder::next(
    const std::function<std::chrono::duration<double>()>& patience) {
  constexpr auto kPause = std::chrono::milliseconds(50);
  while (true) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (const auto own = of_own()) return own;
      if (const auto other = of_others()) return other;
      if (drop_finished()) return std::nullopt;
    }
    const std::chrono::duration<double> most = patience();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (const auto left = given_up(most)) return left;
    }
    std::this_thread::sleep_for(kPause);
  }
}

std::optional<std::size_t> WorkOrder::of_own() {
  while (next_own_ < end_own_) {
    last_news_ = Clock::now();
    const std::size_t index = next_own_++;
    if (!is_there_(index)) return index;
  }
  return std::nullopt;
}

/// But for the first ones that are missing, which their worker is likely to have under way.
std::optional<std::size_t> WorkOrder::of_others() {
  for (Open& open : others_) {
    while (open.size() > jobs_) {
      if (is_there_(open.front())) {
        open.pop_front();
      } else if (const auto index = from_the_end(open)) {
        return index;
      }
    }
  }
  return std::nullopt;
}

/// Takes one out, and gives it if it is missing. Workers with nothing left of their own come to the
/// same ones: each has its own every so many, from the end backwards, and takes any afterwards (in
/// one order all would do the same at the same time).
std::optional<std::size_t> WorkOrder::from_the_end(Open& open) {
  const auto first = open.begin() + static_cast<std::ptrdiff_t>(jobs_);
  const auto mine = std::find_if(open.rbegin(), std::make_reverse_iterator(first),
                                 [&](auto i) { return i % shard_.count == shard_.index; });
  const auto at = mine.base() != first
                      ? mine.base() - 1
                      : first + static_cast<std::ptrdiff_t>(random_() % (open.size() - jobs_));
  const std::size_t index = *at;
  open.erase(at);
  last_news_ = Clock::now();
  if (is_there_(index)) return std::nullopt;
  return index;
}

/// True if nothing is left.
bool WorkOrder::drop_finished() {
  bool none_left = true;
  for (Open& open : others_) {
    const std::size_t before = open.size();
    open.erase(std::remove_if(open.begin(), open.end(), is_there_), open.end());
    if (open.size() != before) last_news_ = Clock::now();
    none_left = none_left && open.empty();
  }
  return none_left;
}

/// Whoever had it under way is gone, it seems.
std::optional<std::size_t> WorkOrder::given_up(std::chrono::duration<double> patience) {
  if (Clock::now() - last_news_ < patience) return std::nullopt;
  for (std::size_t k = 0; k < others_.size(); ++k) {
    Open& open = others_[(shard_.index + k) % others_.size()];
    if (open.empty()) continue;
    const std::size_t index = open.back();
    open.pop_back();
    return index;
  }
  return std::nullopt;
}

}  // namespace foucault::evaluation
