#include "foucault/evaluation/executor.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "foucault/evaluation/work_order.h"

namespace foucault::evaluation {
namespace {

using Seconds = std::chrono::duration<double>;

void add(std::atomic<double>& sum, double value) {
  double before = sum;
  while (!sum.compare_exchange_weak(before, before + value)) {
  }
}

void raise(std::atomic<double>& most, double value) {
  double before = most;
  while (before < value && !most.compare_exchange_weak(before, value)) {
  }
}

/// How long others are waited for.
Seconds patience(double longest_s) {
  constexpr double kUnknown = 10, kLeast = 1;  // [s]
  return Seconds(longest_s > 0 ? std::max(kLeast, 2 * longest_s) : kUnknown);
}

void require_all(std::size_t size, std::size_t missing) {
  if (missing == 0) return;
  throw store::StoreError(
      fmt::format("{} of {} runs are missing in the store; wait for the workers, or give the same "
                  "command without --no-compute",
                  missing, size));
}

}  // namespace

void Executor::complete(const Batch& batch, const std::function<void(double)>& progress) {
  const std::size_t size = batch.keys.size();
  if (!options_.compute) return require_all(size, missing(batch));
  WorkOrder order(size, options_.shard.value_or(store::Shard()),
                  static_cast<std::size_t>(options_.threads),
                  [&](std::size_t index) { return records_.has(batch.keys[index]); });
  const auto task = [&](std::size_t, const TaskProgress& part) {
    const auto index = order.next([&] {
      part(0);
      return patience(longest_s_);
    });
    if (index) compute(batch, *index, part);
  };
  run_tasks(size, options_.threads, task, progress);
}

store::Record Executor::get(const Batch& batch, std::size_t index) {
  if (std::optional<store::Record> record = records_.find(batch.keys[index])) return *record;
  if (!options_.compute) {
    throw store::StoreError(
        "a record of the store is damaged or gone; the same command without --no-compute computes "
        "it");
  }
  return compute(batch, index, [](double) {});
}

std::size_t Executor::missing(const Batch& batch) const {
  return static_cast<std::size_t>(
      std::count_if(batch.keys.begin(), batch.keys.end(),
                    [&](const store::Key& key) { return !records_.has(key); }));
}

store::Record Executor::compute(const Batch& batch, std::size_t index,
                                const TaskProgress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  store::Record record = batch.compute(index, progress);
  records_.put(batch.keys[index], record);
  const double took_s = Seconds(std::chrono::steady_clock::now() - begin).count();
  ++computed_;
  add(computed_s_, took_s);
  raise(longest_s_, took_s);
  return record;
}

}  // namespace foucault::evaluation
