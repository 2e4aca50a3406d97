#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "foucault/evaluation/task_pool.h"
#include "foucault/store/record_store.h"
#include "foucault/store/shard.h"

/// The one who computes what is not in a store yet; perhaps one of many, on many machines, who know
/// of each other only what they find there.
namespace foucault::evaluation {

/// Things to be computed, in an order in which neighbours share what they read.
struct Batch {
  std::vector<store::Key> keys;
  /// Of keys[index]; on several threads at once.
  std::function<store::Record(std::size_t index, const TaskProgress&)> compute;
};

class Executor {
 public:
  struct Options {
    int threads = 1;
    std::optional<store::Shard> shard;  ///< none: all of it, waiting for nobody
    bool compute = true;                ///< else what is missing is an error
  };

  Executor(store::Records& records, const Options& options)
      : records_(records), options_(options) {}

  /// All of a batch is in the store when this returns. Who has a share begins with it, takes what
  /// is missing in those of others then, and at last waits for what others seem to have under way,
  /// for twice as long as its own longest took. Throws what `compute` and `progress` throw, as
  /// run_tasks() does, and StoreError if something is missing that may not be computed.
  void complete(const Batch& batch, const std::function<void(double)>& progress = {});

  /// One of a batch that is complete; one that was damaged meanwhile is computed again.
  store::Record get(const Batch& batch, std::size_t index);

  std::size_t missing(const Batch& batch) const;

  const Options& options() const { return options_; }
  /// How many this one has computed, and what they took [s].
  std::size_t computed() const { return computed_; }
  double computed_s() const { return computed_s_; }

 private:
  store::Record compute(const Batch& batch, std::size_t index, const TaskProgress& progress);

  store::Records& records_;
  Options options_;
  std::atomic<std::size_t> computed_{0};
  std::atomic<double> computed_s_{0};
  std::atomic<double> longest_s_{0};
};

}  // namespace foucault::evaluation
