#include "foucault/evaluation/task_pool.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <numeric>
#include <thread>
#include <vector>

namespace foucault::evaluation {
namespace {

constexpr auto kProgressInterval = std::chrono::milliseconds(100);

/// Ends a task that is not wanted any more; no std::exception, so that nobody takes it for one.
struct CalledOff {};

class TaskPool {
 public:
  TaskPool(std::size_t count, const Task& task) : task_(task), stop_at_(count), parts_(count) {
    for (std::atomic<double>& part : parts_) part = 0;
  }

  void run(int threads, const std::function<void(double)>& progress) {
    running_ = threads;
    std::vector<std::thread> workers;
    for (int i = 0; i < threads; ++i) workers.emplace_back([this] { work(); });
    watch(progress);
    for (std::thread& worker : workers) worker.join();
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void work() {
    for (std::size_t index = next_++; index < stop_at_; index = next_++) run_one(index);
    const std::lock_guard<std::mutex> lock(mutex_);
    --running_;
    finished_.notify_one();
  }

  void run_one(std::size_t index) {
    const TaskProgress progress = [this, index](double part) {
      if (index >= stop_at_) throw CalledOff{};
      parts_[index] = std::clamp(part, 0.0, 1.0);
    };
    try {
      task_(index, progress);
      parts_[index] = 1;
    } catch (const CalledOff&) {
    } catch (...) {
      fail(index, std::current_exception());
    }
  }

  /// Tasks before the one that failed go on: they might fail, too, and theirs is the error to show.
  void fail(std::size_t index, const std::exception_ptr& error) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (index >= stop_at_) return;
    stop_at_ = index;
    error_ = error;
  }

  void watch(const std::function<void(double)>& progress) {
    std::unique_lock<std::mutex> lock(mutex_);
    bool called_off = false;
    while (running_ > 0) {
      finished_.wait_for(lock, kProgressInterval);
      if (!progress || called_off) continue;
      lock.unlock();
      try {
        progress(mean_part());
        lock.lock();
      } catch (...) {
        lock.lock();
        called_off = true;
        stop_at_ = 0;
        error_ = std::current_exception();
      }
    }
  }

  double mean_part() const {
    const double sum = std::accumulate(parts_.begin(), parts_.end(), 0.0);
    return sum / static_cast<double>(parts_.size());
  }

  const Task& task_;
  std::atomic<std::size_t> next_{0};
  std::atomic<std::size_t> stop_at_;  ///< tasks from this one on are called off
  std::vector<std::atomic<double>> parts_;
  std::mutex mutex_;
  std::condition_variable finished_;
  int running_ = 0;
  std::exception_ptr error_;
};

}  // namespace

void run_tasks(std::size_t count, int threads, const Task& task,
               const std::function<void(double)>& progress) {
  if (count == 0) return;
  const int most = static_cast<int>(std::min<std::size_t>(count, 1024));
  TaskPool(count, task).run(std::clamp(threads, 1, most), progress);
}

int processor_count() { return std::max(1u, std::thread::hardware_concurrency()); }

}  // namespace foucault::evaluation
