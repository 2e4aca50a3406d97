#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "foucault/evaluation/experiment.h"
#include "settings.h"

namespace foucault::app {

/// Logs that several runs go through, each read once for all that take it alike, as far as memory
/// allows. From any thread.
class SharedLogs {
 public:
  /// Memory for logs [bytes]; one that alone takes more is read by each run, which needs none.
  explicit SharedLogs(std::uint64_t most_bytes = 400'000'000) : most_bytes_(most_bytes) {}

  /// A log from its beginning. What the reader has to say is in `remarks` once its end is reached.
  /// Throws as rawlog::RawlogSource.
  std::unique_ptr<state::Source> open(const std::string& log, const Settings& settings,
                                      std::shared_ptr<evaluation::SourceRemarks> remarks);

 private:
  class Log;
  class Reader;
  struct Entry {
    std::string key;
    std::uint64_t bytes = 0;
    std::shared_ptr<Log> log;
  };

  std::shared_ptr<Log> shared(const std::string& log, const Settings& settings);

  std::uint64_t most_bytes_;
  std::mutex mutex_;
  std::list<Entry> entries_;  ///< the last one asked for in front
};

}  // namespace foucault::app
