#include "foucault/evaluation/work_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>
#include <vector>

namespace foucault::evaluation {
namespace {

using std::chrono::duration;
using testing::ElementsAre;

/// Workers in turn, one step each: what they took a step ago is finished now.
class Workers {
 public:
  Workers(std::size_t size, std::size_t count) : done_(size) {
    for (std::size_t i = 0; i < count; ++i) add({i, count});
  }

  void add(const store::Shard& shard) {
    orders_.push_back(std::make_unique<WorkOrder>(done_.size(), shard, 1,
                                                  [this](std::size_t i) { return done_[i]; }));
    open_.emplace_back();
  }

  /// What a worker takes. One that would have to wait has nothing.
  std::optional<std::size_t> step(std::size_t worker) {
    if (open_[worker]) done_[*open_[worker]] = true;
    try {
      open_[worker] = orders_[worker]->next([]() -> duration<double> { throw Waits(); });
    } catch (const Waits&) {
      open_[worker].reset();
    }
    if (open_[worker]) taken_.push_back(*open_[worker]);
    return open_[worker];
  }

  std::vector<std::size_t> all_of(std::size_t worker) {
    std::vector<std::size_t> all;
    while (const auto index = step(worker)) all.push_back(*index);
    return all;
  }

  void finish(std::size_t index) { done_[index] = true; }
  std::size_t twice() const {
    return taken_.size() - std::set<std::size_t>(taken_.begin(), taken_.end()).size();
  }
  std::size_t missing() const {
    return static_cast<std::size_t>(std::count(done_.begin(), done_.end(), false));
  }

 private:
  struct Waits {};

  std::vector<bool> done_;
  std::vector<std::unique_ptr<WorkOrder>> orders_;
  std::vector<std::optional<std::size_t>> open_;
  std::vector<std::size_t> taken_;
};

TEST(WorkOrderTest, AlonePassesThroughInOrder) {
  Workers workers(5, 1);
  workers.finish(2);
  EXPECT_THAT(workers.all_of(0), ElementsAre(0, 1, 3, 4));
}

/// Its share in order, then of those of others every third from the end, and the rest; but for the
/// first that is missing in each.
TEST(WorkOrderTest, OwnShareFirstThenThoseOfOthers) {
  Workers workers(24, 3);
  workers.finish(8);
  workers.finish(21);
  std::vector<std::size_t> all = workers.all_of(0);
  EXPECT_THAT(std::vector<std::size_t>(all.begin(), all.begin() + 10),
              ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 15, 12));
  std::sort(all.begin(), all.end());
  EXPECT_THAT(all,
              ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 10, 11, 12, 13, 14, 15, 17, 18, 19, 20, 22, 23));
}

TEST(WorkOrderTest, EightWorkersOfOneSpeedDoNothingTwice) {
  Workers workers(400, 8);
  for (int step = 0; step < 60; ++step) {
    for (std::size_t i = 0; i < 8; ++i) workers.step(i);
  }
  EXPECT_EQ(workers.missing(), 0u);
  EXPECT_EQ(workers.twice(), 0u);
}

/// The last one is gone after a third of its share; the others take it over.
TEST(WorkOrderTest, WhatADeadWorkerLeavesIsSeldomDoneTwice) {
  Workers workers(400, 8);
  for (int step = 0; step < 80; ++step) {
    for (std::size_t i = 0; i < (step < 17 ? 8u : 7u); ++i) workers.step(i);
  }
  EXPECT_LE(workers.twice(), 20u) << "5 %";
  EXPECT_EQ(workers.missing(), 1u) << "what it had under way";
}

TEST(WorkOrderTest, WhatNobodyFinishesIsTakenInTheEnd) {
  std::vector<bool> done(4);
  WorkOrder order(4, {0, 2}, 1, [&](std::size_t i) { return done[i]; });
  const auto patience = [] { return duration<double>(0.1); };
  std::vector<std::size_t> taken;
  while (const auto index = order.next(patience)) {
    taken.push_back(*index);
    done[*index] = true;
  }
  EXPECT_THAT(taken, ElementsAre(0, 1, 3, 2));
}

TEST(WorkOrderTest, WaitingEndsWhenTheOtherHasFinished) {
  std::vector<bool> done(2);
  WorkOrder order(2, {0, 2}, 1, [&](std::size_t i) { return done[i]; });
  const auto nothing = []() -> duration<double> { throw std::logic_error("waits"); };
  EXPECT_EQ(order.next(nothing), 0u);
  done[0] = true;
  EXPECT_THROW(order.next(nothing), std::logic_error);
  int asked = 0;
  const auto finished_meanwhile = [&] {
    done[1] = ++asked == 3;
    return duration<double>(60);
  };
  EXPECT_EQ(order.next(finished_meanwhile), std::nullopt);
}

}  // namespace
}  // namespace foucault::evaluation
