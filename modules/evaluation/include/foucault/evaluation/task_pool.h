#pragma once

#include <cstddef>
#include <functional>

namespace foucault::evaluation {

/// Tells how far a task is, 0 to 1, and ends it by an exception if the pool has been called off;
/// cheap enough to call for every measurement.
using TaskProgress = std::function<void(double)>;
using Task = std::function<void(std::size_t index, const TaskProgress& progress)>;

/// Runs task(0) ... task(count - 1), begun in this order, on up to `threads` threads of its own.
/// `progress` is called on the calling thread, with the mean over all tasks, some ten times a
/// second.
/// Throws what a task throws: of several the one with the lowest index, whatever the number of
/// threads. Throws what `progress` throws. Either calls the other tasks off and waits for them.
void run_tasks(std::size_t count, int threads, const Task& task,
               const std::function<void(double)>& progress = {});

/// Processors of the machine, at least 1.
int processor_count();

}  // namespace foucault::evaluation
