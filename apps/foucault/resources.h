#pragma once

#include <chrono>

namespace foucault::app {

/// What the process has used since a point in time.
struct Resources {
  double cpu_s = 0;  ///< of all threads, user and system
  double wall_s = 0;
  double peak_rss_mb = 0;  ///< of the process from its start on [10^6 bytes]
};

class ResourceMeter {
 public:
  ResourceMeter();
  Resources used() const;

 private:
  std::chrono::steady_clock::time_point begin_;
  double begin_cpu_s_;
};

}  // namespace foucault::app
