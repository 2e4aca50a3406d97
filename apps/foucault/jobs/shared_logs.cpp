#include "jobs/shared_logs.h"

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <iterator>
#include <utility>
#include <vector>

#include "foucault/core/packed_measurements.h"
#include "foucault/rawlog/rawlog_source.h"

namespace foucault::app {

/// Some thousand measurements that follow each other.
struct LogPiece {
  PackedMeasurements measurements;
  double progress = 0;  ///< of the log, at its end
};

namespace {

/// What the measurements of a log take, from above, by its file, which is compressed as a rule.
std::uint64_t bytes_in_memory(const std::string& log) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(log, error);
  return error ? 0 : 2 * size;
}

}  // namespace

/// Read piece by piece, by whoever comes to the end of what is there.
class SharedLogs::Log {
 public:
  /// For one reader alone nothing is kept.
  Log(const std::string& log, const Settings& settings, bool for_many)
      : source_(std::make_unique<rawlog::RawlogSource>(log, settings.imu.sample_kind(),
                                                       settings.rawlog)),
        mounting_(source_->mounting()),
        for_many_(for_many) {}

  const state::Mounting& mounting() const { return mounting_; }

  /// None at the end. Throws what its reading threw, in every run.
  std::shared_ptr<const LogPiece> piece(std::size_t index) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!for_many_ && index > 0) pieces_[index - 1].reset();
    if (index == pieces_.size() && source_) read_piece();
    if (index < pieces_.size()) return pieces_[index];
    if (failure_) std::rethrow_exception(failure_);
    return nullptr;
  }
  /// At the end.
  const evaluation::SourceRemarks& remarks() const { return remarks_; }

 private:
  void read_piece() {
    constexpr std::size_t kMost = 4096;
    const auto piece = std::make_shared<LogPiece>();
    try {
      while (piece->measurements.size() < kMost) {
        const std::optional<Measurement> measurement = source_->next();
        if (!measurement) {
          remarks_ = {source_->notices(), source_->damage()};
          source_.reset();
          break;
        }
        piece->measurements.push_back(*measurement);
      }
    } catch (...) {
      failure_ = std::current_exception();
      source_.reset();
    }
    piece->progress = source_ ? source_->progress() : 1;
    if (piece->measurements.size() > 0) pieces_.push_back(piece);
  }

  std::mutex mutex_;
  std::unique_ptr<rawlog::RawlogSource> source_;  ///< until its end
  state::Mounting mounting_;
  bool for_many_;
  std::vector<std::shared_ptr<const LogPiece>> pieces_;
  evaluation::SourceRemarks remarks_;
  std::exception_ptr failure_;
};

/// A way through a log of one's own.
class SharedLogs::Reader final : public state::Source {
 public:
  Reader(std::shared_ptr<Log> log, std::shared_ptr<evaluation::SourceRemarks> remarks)
      : log_(std::move(log)), remarks_(std::move(remarks)) {}

  std::optional<Measurement> next() override {
    if (!piece_ || place_.at_end(piece_->measurements)) {
      piece_ = log_->piece(index_++);
      place_ = {};
    }
    progress_ = piece_ ? piece_->progress : 1;
    if (piece_) return place_.next(piece_->measurements);
    --index_;
    *remarks_ = log_->remarks();
    return std::nullopt;
  }
  const state::Mounting& mounting() const override { return log_->mounting(); }
  double progress() const override { return progress_; }

 private:
  std::shared_ptr<Log> log_;
  std::shared_ptr<evaluation::SourceRemarks> remarks_;
  std::shared_ptr<const LogPiece> piece_;
  PackedMeasurements::Place place_;
  double progress_ = 0;
  std::size_t index_ = 0;  ///< of the next piece
};

std::shared_ptr<SharedLogs::Log> SharedLogs::shared(const std::string& log,
                                                    const Settings& settings) {
  rawlog::RawlogOptions options = settings.rawlog;
  const std::string key =
      fmt::format("{}\n{}\n{}\n{}", log, static_cast<int>(settings.imu.sample_kind()),
                  options.fix_delay_s, dump_config(options));
  const std::lock_guard<std::mutex> lock(mutex_);
  for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
    if (entry->key != key) continue;
    entries_.splice(entries_.begin(), entries_, entry);
    return entry->log;
  }
  const std::uint64_t bytes = bytes_in_memory(log);
  if (bytes > most_bytes_) return std::make_shared<Log>(log, settings, false);
  entries_.push_front({key, bytes, std::make_shared<Log>(log, settings, true)});
  std::uint64_t sum = 0;
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    sum += entry->bytes;
    entry = sum > most_bytes_ ? entries_.erase(entry) : std::next(entry);
  }
  return entries_.front().log;
}

std::unique_ptr<state::Source> SharedLogs::open(
    const std::string& log, const Settings& settings,
    std::shared_ptr<evaluation::SourceRemarks> remarks) {
  return std::make_unique<Reader>(shared(log, settings), std::move(remarks));
}

}  // namespace foucault::app
