#include "resources.h"

#include <sys/resource.h>

namespace foucault::app {
namespace {

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

rusage process_usage() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage;
}

double cpu_seconds(const rusage& usage) {
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

ResourceMeter::ResourceMeter()
    : begin_(std::chrono::steady_clock::now()), begin_cpu_s_(cpu_seconds(process_usage())) {}

Resources ResourceMeter::used() const {
  const rusage usage = process_usage();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin_;
  const double peak_mb = static_cast<double>(usage.ru_maxrss) * 1024e-6;  // kept in KiB
  return {cpu_seconds(usage) - begin_cpu_s_, wall.count(), peak_mb};
}

}  // namespace foucault::app
