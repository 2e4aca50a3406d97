#include "foucault/evaluation/task_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace foucault::evaluation {
namespace {

TEST(TaskPool, RunsEachTaskOnce) {
  for (const int threads : {1, 2, 7}) {
    std::vector<int> times(100);
    run_tasks(times.size(), threads, [&](std::size_t i, const TaskProgress&) { ++times[i]; });
    EXPECT_EQ(times, std::vector<int>(100, 1)) << threads;
  }
}

TEST(TaskPool, NothingToDo) {
  run_tasks(0, 4, [](std::size_t, const TaskProgress&) { FAIL(); });
}

/// Task 3 fails at once, task 1 late: its error is the one of every order of events.
TEST(TaskPool, ThrowsTheFirstErrorInOrderOfTasks) {
  for (const int threads : {1, 2, 4}) {
    const Task task = [](std::size_t i, const TaskProgress&) {
      if (i == 1) std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (i % 2 == 1) throw std::runtime_error(std::to_string(i));
    };
    try {
      run_tasks(50, threads, task);
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "1") << threads;
    }
  }
}

TEST(TaskPool, AnErrorCallsLaterTasksOff) {
  std::atomic<int> begun{0};
  const Task task = [&](std::size_t i, const TaskProgress& progress) {
    ++begun;
    if (i == 0) throw std::runtime_error("no");
    while (true) {  // ends only by being called off
      progress(0.5);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  EXPECT_THROW(run_tasks(1000, 2, task), std::runtime_error);
  EXPECT_LE(begun, 3);
}

TEST(TaskPool, ProgressCanStopIt) {
  const Task task = [](std::size_t, const TaskProgress& progress) {
    while (true) {
      progress(0.25);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  double last = -1;
  const auto stop = [&](double part) {
    last = part;
    throw std::logic_error("enough");
  };
  EXPECT_THROW(run_tasks(4, 2, task, stop), std::logic_error);
  EXPECT_GE(last, 0);
  EXPECT_LE(last, 0.25);
}

}  // namespace
}  // namespace foucault::evaluation
