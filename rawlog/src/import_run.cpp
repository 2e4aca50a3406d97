#include "import_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <deque>
#include <filesystem>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/hole.h"
#include "foucault/core/time.h"
#include "foucault/core/time_mismatch.h"
#include "foucault/rawlog/rawlog_writer.h"

namespace foucault::rawlog {

namespace {

/// An input with the records that come next, its bad rows dealt with. Behind a jump of the stamps
/// some wait: the rows that follow tell whether there is a hole, or the stamps were wrong.
class Input {
 public:
  /// `wheels_alone`: it has nothing but wheel speeds.
  Input(std::unique_ptr<RecordReader> reader, bool skip_bad_rows, bool wheels_alone = false)
      : reader_(std::move(reader)), skip_bad_rows_(skip_bad_rows), wheels_alone_(wheels_alone) {
    summary_.file = reader_->table().path();
    fill();
  }

  /// Null at the end.
  const Record* head() const { return ahead_.empty() ? nullptr : &ahead_.front().record; }
  double progress() const { return reader_->table().progress(); }

  Record take() {
    Record record = std::move(ahead_.front().record);
    ahead_.pop_front();
    if (!is_beside(record)) count(stamp(record));
    fill();
    return record;
  }

  ImportStream summary() const {
    ImportStream summary = summary_;
    summary.without_fix = reader_->without_fix();
    summary.notices = reader_->notices();
    return summary;
  }

 private:
  struct Ahead {
    Record record;
    int64_t position = 0;
  };

  void fill() {
    while (!over_ && (ahead_.empty() || (since_jump_ && ahead_.size() <= kMostRowsAhead))) {
      try {
        read_one();
      } catch (const RowError& error) {
        skip(error.what());
      }
    }
  }

  void read_one() {
    std::optional<Record> record = reader_->next();
    over_ = !record;
    if (over_) return;
    const int64_t t_ns = stamp(*record);
    while (!ahead_.empty() && stamp(ahead_.back().record) > t_ns) skip_last(t_ns);
    if (newest_ns_ && StampOrder::is_jump(*newest_ns_, t_ns)) {
      since_jump_ = 0;
    } else if (since_jump_ && ++*since_jump_ > kMostRowsAhead) {
      since_jump_.reset();
    }
    newest_ns_ = t_ns;
    ahead_.push_back({std::move(*record), reader_->table().position()});
  }

  /// Of a record whose stamp lies ahead of one that follows.
  void skip_last(int64_t follows_ns) {
    const Ahead last = std::move(ahead_.back());
    ahead_.pop_back();
    if (is_beside(last.record)) return;
    skip(fmt::format(
        "{}: the stamp {} lies ahead of one that follows, {}; correct or remove the row",
        reader_->table().place(last.position), utc_text(stamp(last.record)), utc_text(follows_ns)));
  }

  /// A wheel speed whose row has another record, which counts.
  bool is_beside(const Record& record) const {
    return !wheels_alone_ && std::holds_alternative<WheelSpeed>(record);
  }

  void skip(const std::string& why) {
    if (!skip_bad_rows_) throw DataError(why + ", or skip bad rows (--skip-bad-rows)");
    if (summary_.skipped++ == 0) summary_.first_skipped = why;
  }

  void count(int64_t t_ns) {
    if (summary_.written++ == 0) summary_.first_ns = t_ns;
    summary_.last_ns = t_ns;
  }

  std::unique_ptr<RecordReader> reader_;
  bool skip_bad_rows_;
  bool wheels_alone_;
  bool over_ = false;
  std::deque<Ahead> ahead_;
  std::optional<int64_t> newest_ns_;
  std::optional<int> since_jump_;  ///< rows
  ImportStream summary_;
};

/// Finishing touches and statistics on the way to the writer.
class Output {
 public:
  Output(const std::string& path, const ImportInputs& inputs)
      : writer_(path, inputs.mounting),
        p_b_a_(inputs.mounting.q_v_b.conjugate() *
               inputs.lever_arm_v.value_or(Eigen::Vector3d::Zero())) {
    summary_.lever_arm_v = inputs.lever_arm_v;
    RecordingNotes notes;
    notes.lever_arm = inputs.lever_arm_v ? "given" : "unknown";
    notes.imu = inputs.sensor;
    writer_.write(notes);
  }

  void write(Record record) {
    if (auto* fix = std::get_if<GnssFix>(&record)) {
      fix->p_b_a = p_b_a_;
      ++summary_.qualities[fix->quality];
      if (fix->velocity_n) ++summary_.with_velocity;
    } else if (std::holds_alternative<WheelSpeed>(record)) {
      ++summary_.wheel_speeds;
    }
    writer_.write(record);
  }

  void finish() { writer_.finish(); }
  ImportSummary& summary() { return summary_; }

 private:
  RawlogWriter writer_;
  Eigen::Vector3d p_b_a_;
  ImportSummary summary_;
};

/// None without a reader.
std::optional<Input> optional_input(std::unique_ptr<RecordReader> reader, bool skip_bad_rows,
                                    bool wheels_alone = false) {
  if (!reader) return std::nullopt;
  return Input(std::move(reader), skip_bad_rows, wheels_alone);
}

/// The files, opened in this order.
struct Inputs {
  std::optional<Input> imu;
  Input gnss;
  std::optional<Input> reference, wheel;

  Inputs(ImportInputs& from, bool skip_bad_rows)
      : imu(optional_input(std::move(from.imu), skip_bad_rows)),
        gnss(std::move(from.gnss), skip_bad_rows),
        reference(optional_input(std::move(from.reference), skip_bad_rows)),
        wheel(optional_input(std::move(from.wheel), skip_bad_rows, true)) {}

  /// With the record that comes next; null at the end.
  Input* earliest() {
    Input* first = nullptr;
    const auto of = [](std::optional<Input>& input) { return input ? &*input : nullptr; };
    for (Input* input : {&gnss, of(reference), of(wheel), of(imu)}) {
      if (input == nullptr || input->head() == nullptr) continue;
      if (first == nullptr || stamp(*input->head()) < stamp(*first->head())) first = input;
    }
    return first;
  }

  void summarize(ImportSummary& summary) const {
    if (imu) summary.imu = imu->summary();
    summary.gnss = gnss.summary();
    if (reference) summary.reference = reference->summary();
    if (wheel) summary.wheel = wheel->summary();
  }
};

void check_not_empty(const ImportStream& stream, const char* what, const char* missing = "values") {
  if (stream.written > 0) return;
  throw DataError(fmt::format(
      "'{}' has no usable {} row ({} skipped, {} without {}){}{}", stream.file, what,
      stream.skipped, stream.without_fix, missing,
      stream.first_skipped.empty() ? "; check the file" : "; the first: ", stream.first_skipped));
}

void check_overlap(const ImportStream& imu, const ImportStream& other, const char* what) {
  if (other.first_ns <= imu.last_ns && imu.first_ns <= other.last_ns) return;
  throw DataError(
      fmt::format("IMU ({} to {}) and {} ({} to {}) do not overlap: '{}' begins {} ('{}')",
                  utc_text(imu.first_ns), utc_text(imu.last_ns), what, utc_text(other.first_ns),
                  utc_text(other.last_ns), other.file,
                  describe_mismatch(seconds_between(imu.first_ns, other.first_ns)), imu.file));
}

/// Many rows in no time are of a clock in another unit.
void check_rate(const ImportStream& stream) {
  constexpr int64_t kFew = 100;
  constexpr int64_t kShortestStepNs = 1000;
  const int64_t length_ns = stream.last_ns - stream.first_ns;
  if (stream.written < kFew || length_ns >= kShortestStepNs * stream.written) return;
  throw DataError(
      fmt::format("{} rows of '{}' lie within {:.3g} s; check unit and system of its time",
                  stream.written, stream.file, seconds_between(stream.first_ns, stream.last_ns)));
}

void check_wheel(const ImportSummary& summary) {
  const ImportStream& wheel = *summary.wheel;
  check_not_empty(wheel, "wheel speed");
  check_rate(wheel);
  if (!summary.imu.file.empty()) check_overlap(summary.imu, wheel, "wheel speeds");
  if (summary.wheel_speeds == wheel.written) return;
  throw UsageError(
      fmt::format("'{}' and '{}' both have wheel speeds; leave out the columns of the one "
                  "(in a mapping imu.columns.wheel_speed) or the file of the other",
                  summary.imu.file, wheel.file));
}

void check(const ImportSummary& summary) {
  const bool has_imu = !summary.imu.file.empty();
  if (has_imu) check_not_empty(summary.imu, "IMU");
  check_not_empty(summary.gnss, "GNSS", "a position");
  if (has_imu) check_rate(summary.imu);
  check_rate(summary.gnss);
  if (has_imu) check_overlap(summary.imu, summary.gnss, "GNSS");
  if (summary.reference) {
    check_not_empty(*summary.reference, "reference");
    if (has_imu) check_overlap(summary.imu, *summary.reference, "reference");
  }
  if (summary.wheel) check_wheel(summary);
}

/// The recording itself is what must not get lost.
void check_not_an_input(const std::string& out, const ImportInputs& inputs) {
  std::vector<std::string> paths{inputs.mapping};
  for (const RecordReader* reader :
       {inputs.imu.get(), inputs.gnss.get(), inputs.reference.get(), inputs.wheel.get()}) {
    if (reader != nullptr) paths.push_back(reader->table().path());
  }
  for (const std::string& path : paths) {
    std::error_code not_there;
    if (!std::filesystem::equivalent(path, out, not_there) || not_there) continue;
    throw UsageError(fmt::format("--out {} is an input of the import; give another name", out));
  }
}

}  // namespace

void StampOrder::check(const Place& row, int64_t t_ns, bool may_equal) {
  const bool equal = last_ns_ && t_ns == *last_ns_;
  const bool follows = !last_ns_ || t_ns > *last_ns_ || (equal && may_equal);
  const bool goes_on = before_jump_ns_ && !equal && t_ns > *before_jump_ns_;
  if (!follows && !goes_on) {
    row.fail(
        fmt::format("the stamp {} does not come after the one before it, {}; sort the file "
                    "by time and remove repeated rows",
                    utc_text(t_ns), utc_text(*last_ns_)));
  }
  if (!follows) before_jump_ns_.reset();
  follow(t_ns);
}

void StampOrder::follow(int64_t t_ns) {
  if (last_ns_ && is_jump(*last_ns_, t_ns)) {
    before_jump_ns_ = last_ns_;
    since_jump_ = 0;
  } else if (++since_jump_ > kMostRowsAhead) {
    before_jump_ns_.reset();
  }
  last_ns_ = t_ns;
}

int64_t RollingTime::unrolled(int64_t time_ns) {
  constexpr int64_t kMostPeriods = 1000;  // keeps sums in range
  if (last_ns_) {
    const int64_t next = ends(*last_ns_) && begins(time_ns)   ? periods_ + 1
                         : begins(*last_ns_) && ends(time_ns) ? periods_ - 1
                                                              : periods_;
    if (std::abs(next) <= kMostPeriods) periods_ = next;
  }
  last_ns_ = time_ns;
  return time_ns + periods_ * period_ns_;
}

std::optional<int64_t> IntervalLengths::ending_at(int64_t t_ns) {
  const std::optional<int64_t> last_ns = last_ns_;
  last_ns_ = t_ns;
  if (!last_ns) return std::nullopt;
  const int64_t interval_ns = t_ns - *last_ns;
  if (nominal_ns_ == 0) nominal_ns_ = interval_ns;
  const bool hole = interval_ns <= 0 || is_hole(interval_ns, nominal_ns_);
  if (!hole) nominal_ns_ = interval_ns;
  return nominal_ns_;
}

ImportSummary run_import(const ImportOptions& options, ImportInputs inputs) {
  constexpr int64_t kRecordsPerReport = 2000;
  check_not_an_input(options.out, inputs);
  Inputs files(inputs, options.skip_bad_rows);
  Output output(options.out, inputs);
  int64_t records = 0;
  while (Input* input = files.earliest()) {
    output.write(input->take());
    if (options.progress && ++records % kRecordsPerReport == 0)
      options.progress((files.imu ? *files.imu : files.gnss).progress());
  }
  ImportSummary& summary = output.summary();
  files.summarize(summary);
  check(summary);
  output.finish();
  if (options.progress) options.progress(1);
  return summary;
}

Geodetic checked_position(const Place& row, double latitude, double longitude, double height) {
  if (std::abs(latitude) > kPi / 2 || std::abs(longitude) > 2 * kPi) {
    row.fail(
        fmt::format("latitude {:.9g} deg, longitude {:.9g} deg are no place on Earth; check "
                    "columns and units, correct or remove the row",
                    latitude / kDegree, longitude / kDegree));
  }
  return {latitude, longitude, height};
}

int64_t checked_stamp(const Place& row, int64_t t_ns) {
  if (!in_range_of_stamps(t_ns)) {
    row.fail(
        "its time is none of the years 1950 to 2150; check column, unit and system of the "
        "time, correct or remove the row");
  }
  return t_ns;
}

std::optional<int64_t> midnight_ns(const std::string& date, const char* format) {
  std::tm utc{};
  const char* end = strptime(date.c_str(), format, &utc);
  if (end == nullptr || *end != '\0' || utc.tm_year < 50 || utc.tm_year > 250) return std::nullopt;
  return static_cast<int64_t>(timegm(&utc)) * kNanosecondsPerSecond;
}

GpsTime checked_gps_time(const Place& row, int64_t week, int64_t tow_ns) {
  constexpr int64_t kLastWeek = 10'000;
  int64_t weeks = tow_ns / kNanosecondsPerWeek;
  if (tow_ns % kNanosecondsPerWeek < 0) --weeks;
  const int64_t full_week = week + weeks;
  if (full_week < 0 || full_week > kLastWeek) {
    row.fail(fmt::format("GPS week {} lies outside 0 to {}; correct or remove the row", full_week,
                         kLastWeek));
  }
  return {static_cast<int>(full_week), tow_ns - weeks * kNanosecondsPerWeek};
}

int64_t gps_stamp(const Place& row, int64_t week, int64_t tow_ns) {
  return checked_stamp(row, gps_to_unix_ns(checked_gps_time(row, week, tow_ns)));
}

}  // namespace foucault::rawlog
