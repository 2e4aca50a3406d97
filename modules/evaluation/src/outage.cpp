#include "foucault/evaluation/outage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::evaluation {
namespace {

bool has_position(const GnssFix& fix) {
  return std::isfinite(fix.antenna.latitude) && std::isfinite(fix.antenna.longitude) &&
         std::isfinite(fix.antenna.height);
}

}  // namespace

void OutageOptions::fields(ConfigFields& f) {
  f.number("first_s", first_s, kNotNegative, "start of the first outage, after the first fix");
  f.number("length_s", length_s, kPositive, "length of an outage");
  f.number("period_s", period_s, kPositive, "from the start of an outage to that of the next");
  f.numbers("shifts_s", shifts_s, kNotNegative,
            "each log is run once a shift, which is added to all starts");
  f.numbers("starts_s", starts_s, kNotNegative,
            "starts of the outages, instead of first_s and period_s");
}

OutageSchedule::OutageSchedule(const OutageOptions& options, double shift_s)
    : length_ns_(nanoseconds(options.length_s)) {
  std::vector<double> starts_s = options.starts_s;
  if (starts_s.empty()) {
    starts_s.push_back(options.first_s);
    period_ns_ = nanoseconds(options.period_s);
    if (period_ns_ <= length_ns_) {
      throw UsageError("outages.period_s must be longer than outages.length_s");
    }
  }
  std::sort(starts_s.begin(), starts_s.end());
  for (const double start_s : starts_s) starts_ns_.push_back(nanoseconds(start_s + shift_s));
  for (std::size_t i = 1; i < starts_ns_.size(); ++i) {
    if (starts_ns_[i] - starts_ns_[i - 1] <= length_ns_) {
      throw UsageError("outages.starts_s lie closer together than outages.length_s");
    }
  }
}

std::optional<Outage> OutageSchedule::at(int64_t first_fix_ns, int64_t t_ns) const {
  const int64_t since = t_ns - first_fix_ns - kStampToleranceNs;
  const auto after = std::lower_bound(starts_ns_.begin(), starts_ns_.end(), since);
  if (after == starts_ns_.begin()) return std::nullopt;
  int64_t index = after - starts_ns_.begin() - 1;
  int64_t start = starts_ns_[static_cast<std::size_t>(index)];
  if (period_ns_ > 0) {
    index = (since - start - 1) / period_ns_;  // a fix on the start of the next is before it
    start += index * period_ns_;
  }
  if (since > start + length_ns_) return std::nullopt;
  const int64_t begin_ns = first_fix_ns + start;
  return Outage{index, begin_ns, begin_ns + length_ns_};
}

std::optional<double> OutageSchedule::first_end_s() const {
  if (starts_ns_.empty()) return std::nullopt;
  return to_seconds(starts_ns_.front() + length_ns_);
}

OutageSource::OutageSource(std::unique_ptr<state::Source> source, OutageSchedule schedule,
                           Withheld withheld)
    : source_(std::move(source)), schedule_(std::move(schedule)), withheld_(std::move(withheld)) {}

std::optional<Measurement> OutageSource::next() {
  std::optional<Measurement> measurement = source_->next();
  if (!measurement) return std::nullopt;
  const GnssFix* fix = std::get_if<GnssFix>(&*measurement);
  if (!fix) return measurement;
  if (!first_fix_ns_) first_fix_ns_ = fix->t_ns;
  last_fix_ns_ = fix->t_ns;
  if (!first_position_ && has_position(*fix)) first_position_ = fix->antenna;
  const std::optional<Outage> outage = outage_at(fix->t_ns);
  if (!outage) return measurement;
  withheld_(*outage, *fix);
  return EpochRequest{fix->t_ns};
}

const state::Mounting& OutageSource::mounting() const { return source_->mounting(); }

double OutageSource::from_first_fix(const GnssFix& fix) const {
  if (!first_position_ || !has_position(fix)) return std::numeric_limits<double>::quiet_NaN();
  return geodesy::LocalFrame(*first_position_).to_local(fix.antenna).norm();
}

double OutageSource::progress() const { return source_->progress(); }

std::optional<Outage> OutageSource::outage_at(int64_t t_ns) const {
  if (!first_fix_ns_) return std::nullopt;
  return schedule_.at(*first_fix_ns_, t_ns);
}

}  // namespace foucault::evaluation
