#include "run_data.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>
#include <variant>

#include "foucault/core/constants.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/state/vehicle_attitude.h"
#include "foucault/state/vehicle_velocity.h"

namespace foucault::content {

using namespace plot;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 1 / kDegree;
constexpr double kDegreesPerHour = kDegrees * 3600;
constexpr double kMilligal = 1e5;  // a m/s^2
constexpr size_t kMostGaps = 64;
constexpr size_t kMostNotices = 200;
constexpr size_t kMostOutages = 1000;
constexpr size_t kMostStretches = 1000;

Eigen::Vector3d sigma_of(const Eigen::Matrix3d& covariance) {
  return covariance.diagonal().cwiseMax(0).cwiseSqrt();
}

Eigen::Vector3d degrees(const so3::Euler& euler) {
  return kDegrees * Eigen::Vector3d(euler.roll, euler.pitch, euler.heading);
}

Eigen::VectorXd slow_values(const state::Epoch& epoch, const state::SlowBlock& slow) {
  return epoch.slow.segment(slow.index, slow.block.size);
}

Eigen::VectorXd slow_sigmas(const state::Epoch& epoch, const state::SlowBlock& slow) {
  return state::part(epoch.covariance.diagonal(), slow).cwiseMax(0).cwiseSqrt();
}

/// Notices are words: the length of a gap stands in them, "... for 1.480 s ..." [s]; zero if not.
double told_length(const std::string& text) {
  constexpr std::string_view kBefore = " for ";
  const size_t at = text.find(kBefore);
  if (at == std::string::npos) return 0;
  double length = 0;
  const char* const begin = text.data() + at + kBefore.size();
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), length);
  return error == std::errc() && std::string_view(end).substr(0, 2) == " s" ? length : 0;
}

std::vector<double> joined_rows(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  std::vector<double> row(a.begin(), a.end());
  row.insert(row.end(), b.begin(), b.end());
  return row;
}

std::vector<double> six(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return {a.x(), a.y(), a.z(), b.x(), b.y(), b.z()};
}

}  // namespace

void AxisStatistics::add(const Eigen::Vector3d& value, const Eigen::Vector3d& sigma) {
  if (!value.allFinite()) return;
  keep(value.cwiseAbs());
  ++count_;
  sum_ += value.array();
  largest_ = largest_.max(value.array().abs());
  sum_of_squares_ += value.array().square();
  inside_ += (value.array().abs() <= 3 * sigma.array()).cast<double>();
}

void AxisStatistics::keep(const Eigen::Vector3d& magnitude) {
  constexpr size_t kMost = 20000;
  if (count_ % every_ != 0) return;
  kept_.push_back(magnitude);
  if (kept_.size() < kMost) return;
  for (size_t i = 0; 2 * i < kept_.size(); ++i) kept_[i] = kept_[2 * i];
  kept_.resize((kept_.size() + 1) / 2);
  every_ *= 2;
}

Eigen::Vector3d AxisStatistics::mean() const {
  return sum_ / std::max<double>(1, static_cast<double>(count_));
}

Eigen::Vector3d AxisStatistics::quantile(double share) const {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  if (kept_.empty()) return result;
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(kept_.size() - 1));
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(kept_.size());
    for (const Eigen::Vector3d& each : kept_) values.push_back(each[axis]);
    std::nth_element(values.begin(), values.begin() + place, values.end());
    result[axis] = values[static_cast<size_t>(place)];
  }
  return result;
}

Eigen::Vector3d AxisStatistics::rms() const {
  return (sum_of_squares_ / std::max<double>(1, static_cast<double>(count_))).sqrt();
}

Eigen::Vector3d AxisStatistics::inside_3_sigma() const {
  return inside_ / std::max<double>(1, static_cast<double>(count_));
}

void Triad::add(double t, const Eigen::Vector3d& value, const Eigen::Vector3d& sigma) {
  rows.add(t, six(value, sigma));
  if (t >= statistics_from) statistics.add(value, sigma);
}

void Stretches::begin(double t) {
  if (!intervals_.empty()) {
    const double pause = t - intervals_.back().end;
    if (pause >= 0 && pause <= shortest_pause_) return extend(t);
  }
  intervals_.push_back({t, t});
  if (intervals_.size() > kMostStretches) join_closest();
}

void Stretches::extend(double t) {
  if (!intervals_.empty()) intervals_.back().end = std::max(intervals_.back().end, t);
}

std::vector<Interval> Stretches::intervals() const {
  std::vector<Interval> sorted = intervals_;
  std::sort(sorted.begin(), sorted.end(),
            [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
  return sorted;
}

/// At least half of them.
void Stretches::join_closest() {
  intervals_ = intervals();
  std::vector<double> pauses;
  for (size_t i = 1; i < intervals_.size(); ++i) {
    pauses.push_back(intervals_[i].begin - intervals_[i - 1].end);
  }
  std::vector<double> sorted = pauses;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  shortest_pause_ = std::max(0.0, *middle);
  std::vector<Interval> joined{intervals_.front()};
  for (size_t i = 1; i < intervals_.size(); ++i) {
    if (pauses[i - 1] <= shortest_pause_) {
      joined.back().end = std::max(joined.back().end, intervals_[i].end);
    } else {
      joined.push_back(intervals_[i]);
    }
  }
  intervals_ = std::move(joined);
}

std::optional<double> StepWatch::observe(double t) {
  last_was_gap_ = false;
  if (stamps_++ == 0) {
    first_ = last_ = t;
    return std::nullopt;
  }
  const double step = t - last_;
  recent_[(stamps_ - 2) % kMemory] = step;
  longest_ = std::max(longest_, step);
  last_was_gap_ = step > longest_usual();
  if (last_was_gap_) keep_gap({last_, t});
  steps_.add(last_, {step});
  last_ = t;
  return step;
}

double StepWatch::longest_usual() const {
  return stamps_ > 1 ? std::max(least_gap_, 5 * median_step()) : least_gap_;
}

double StepWatch::median_step() const {
  std::array<double, kMemory> steps = recent_;
  const size_t known = std::min(stamps_ - 1, kMemory);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(known / 2);
  std::nth_element(steps.begin(), middle, steps.begin() + static_cast<std::ptrdiff_t>(known));
  return *middle;
}

void StepWatch::keep_gap(const Interval& gap) {
  ++gap_count_;
  gap_duration_ += gap.length();
  gaps_.push_back(gap);
  if (gaps_.size() <= kMostGaps) return;
  gaps_.erase(std::min_element(gaps_.begin(), gaps_.end(), [](const auto& a, const auto& b) {
    return a.length() < b.length();
  }));
}

double StepWatch::rate() const {
  const double covered = duration() - gap_duration_;
  return covered > 0 ? static_cast<double>(stamps_ - 1 - gap_count_) / covered : 0;
}

std::vector<Interval> StepWatch::longest_gaps() const { return gaps_; }

void IntervalHistogram::add(double interval) {
  if (!(interval > 0)) return;
  const double bin = std::floor(kPerDecade * std::log10(interval / kShortest));
  const double last = static_cast<double>(counts_.size() - 1);
  ++counts_[static_cast<size_t>(std::clamp(bin, 0.0, last))];
}

IntervalHistogram::Bins IntervalHistogram::bins() const {
  const auto filled = [](int64_t count) { return count > 0; };
  const auto first = std::find_if(counts_.begin(), counts_.end(), filled);
  const auto last = std::find_if(counts_.rbegin(), counts_.rend(), filled).base();
  Bins bins;
  if (first == counts_.end()) return bins;
  bins.count.assign(first, last);
  const auto from = static_cast<double>(first - counts_.begin());
  for (size_t i = 0; i <= bins.count.size(); ++i) {
    bins.corner.push_back(kShortest * std::pow(10, (from + static_cast<double>(i)) / kPerDecade));
  }
  return bins;
}

Eigen::Vector3d StartPlane::north_east_up(const Geodetic& place) const {
  const double middle = (start_.latitude + place.latitude) / 2;
  const double meridian = geodesy::wgs84::meridian_radius(middle);
  const double transverse = geodesy::wgs84::transverse_radius(middle);
  return {(meridian + start_.height) * (place.latitude - start_.latitude),
          (transverse + start_.height) * std::cos(middle) *
              so3::wrap(place.longitude - start_.longitude),
          place.height - start_.height};
}

RunData::RunData(const state::Mounting& mounting, const state::Told& told)
    : mounting_(mounting), told_(told) {
  const state::Epoch prior = state::prior_as_users_know(told);
  for (const state::SlowBlock& slow : told.layout.slow()) {
    const auto columns = static_cast<size_t>(2 * slow.block.size);
    blocks.push_back({slow,
                      slow_values(prior, slow),
                      slow_sigmas(prior, slow),
                      {},
                      {},
                      DecimatedTable(columns),
                      DecimatedTable(columns)});
  }
}

void RunData::start_statistics(int64_t t_ns) {
  statistics_from_ = seconds(t_ns);
  for (Triad* triad : {&position_error, &velocity_error, &attitude_error, &position_separation,
                       &velocity_separation, &attitude_separation, &innovation, &postfit}) {
    triad->statistics_from = statistics_from_;
  }
}

double RunData::seconds(int64_t t_ns) {
  if (!start_ns_) start_ns_ = t_ns;
  return seconds_between(*start_ns_, t_ns);
}

Eigen::Vector3d RunData::place(const Geodetic& geodetic) {
  if (!plane_) plane_.emplace(geodetic);
  return plane_->north_east_up(geodetic);
}

void RunData::mark_gap() {
  track.add_gap();
  speed_and_height.add_gap();
  for (Triad* triad : {&position, &velocity, &attitude, &vehicle_velocity, &gyro_bias, &accel_bias,
                       &position_error, &velocity_error, &attitude_error, &position_separation,
                       &velocity_separation, &attitude_separation}) {
    triad->rows.add_gap();
  }
  for (BlockHistory& block : blocks) block.rows.add_gap();
  for (DecimatedTable* nees : {&position_nees, &velocity_nees, &attitude_nees}) nees->add_gap();
}

void RunData::add(const state::Epoch& epoch) {
  const double t = seconds(epoch.t_ns);
  epoch_steps.observe(t);
  if (epoch_steps.last_was_gap()) mark_gap();

  const Eigen::Vector3d p = place(epoch.position);
  track.add(t, {p.x(), p.y()});
  position.add(t, p, epoch.sigma_of(state::block::position));
  speed_and_height.add(t, {epoch.velocity_n.norm(), epoch.position.height});
  velocity.add(t, epoch.velocity_n, epoch.sigma_of(state::block::velocity));
  gyro_bias.add(t, kDegreesPerHour * epoch.bias.gyro,
                kDegreesPerHour * epoch.sigma_of(state::block::gyro_bias));
  accel_bias.add(t, kMilligal * epoch.bias.accel,
                 kMilligal * epoch.sigma_of(state::block::accel_bias));

  const state::VehicleVelocity along = state::vehicle_velocity(epoch, told_);
  vehicle_velocity.add(t, along.velocity_v, sigma_of(along.covariance_v));
  if (!blocks.empty()) add_blocks(t, state::as_users_know(epoch, told_));

  const state::VehicleAttitude vehicle = state::vehicle_attitude(epoch, mounting_);
  so3::Euler euler = vehicle.euler;
  if (last_heading_) euler.heading = *last_heading_ + so3::wrap(euler.heading - *last_heading_);
  last_heading_ = euler.heading;
  attitude.add(t, degrees(euler), kDegrees * vehicle.sigma);
}

void RunData::add_blocks(double t, const state::Epoch& epoch) {
  for (BlockHistory& block : blocks) {
    block.last = slow_values(epoch, block.slow);
    block.last_sigma = slow_sigmas(epoch, block.slow);
    block.rows.add(t, joined_rows(block.last, block.last_sigma));
  }
}

void RunData::add_forward(const state::Epoch& epoch) {
  if (blocks.empty()) return;
  const double t = seconds(epoch.t_ns);
  const state::Epoch known = state::as_users_know(epoch, told_);
  for (BlockHistory& block : blocks) {
    block.forward.add(t,
                      joined_rows(slow_values(known, block.slow), slow_sigmas(known, block.slow)));
  }
}

void RunData::add(const state::ObservationResult& result) {
  auto found = aids.find(result.name);
  if (found == aids.end()) found = aids.try_emplace(std::string(result.name)).first;
  DecimatedTable& table = result.used ? found->second.used : found->second.rejected;
  table.add(seconds(result.t_ns), {result.normalized_square / result.dimension});
}

void RunData::add(const state::FixResult& fix) {
  const double t = seconds(fix.t_ns);
  const bool used = fix.verdict == state::FixVerdict::used;
  ++qualities[fix.quality];
  ++verdicts[fix.verdict];
  watch(t, fix);
  if (!plane_) origin_ = "first fix";
  const Eigen::Vector3d p = place(fix.antenna);
  const Eigen::Vector3d sigma = sigma_of(fix.innovation_covariance);
  if (used) {
    fix_steps.observe(t);
    if (fix_steps.last_was_gap()) {
      nis.add_gap();
      innovation.rows.add_gap();
      postfit.rows.add_gap();
    }
    fix_places.add(t, {p.x(), p.y(), static_cast<double>(fix.quality)});
    innovation.add(t, fix.innovation_n, sigma);
    postfit.add(t, fix.postfit_n, sigma);
  } else {
    rejected_places.add(t, {p.x(), p.y()});
    rejected_innovation.add(t, fix.innovation_n, sigma);
  }
}

/// A stretch goes on as long as all fixes fare alike and none is missing.
void RunData::watch(double t, const state::FixResult& fix) {
  const double step = t - last_fix_;
  const bool none_missing = step >= 0 && step <= all_fix_steps_.longest_usual();
  verdict_stretches[fix.verdict].extend_or_begin(t, none_missing && last_verdict_ == fix.verdict);
  quality_stretches[fix.quality].extend_or_begin(t, none_missing && last_quality_ == fix.quality);
  if (fix.verdict != state::FixVerdict::out_of_order) all_fix_steps_.observe(t);
  last_verdict_ = fix.verdict;
  last_quality_ = fix.quality;
  last_fix_ = t;
}

void RunData::add(const NormalizedSquare& square) {
  const double t = seconds(square.t_ns);
  switch (square.kind) {
    case NormalizedKind::innovation:
      if (!square.used) return rejected_nis.add(t, {square.value});
      return nis.add(t, {square.value, square.running_mean.value_or(kNaN)});
    case NormalizedKind::position:
      return position_nees.add(t, {square.value});
    case NormalizedKind::velocity:
      return velocity_nees.add(t, {square.value});
    case NormalizedKind::attitude:
      return attitude_nees.add(t, {square.value});
  }
}

void RunData::add(const Solve& solve) {
  const auto nodes = static_cast<double>(solve.nodes);
  const auto iterations = static_cast<double>(solve.iterations);
  SolveTotals& totals = solve_totals;
  ++totals.count;
  totals.nodes += nodes;
  totals.most_nodes = std::max(totals.most_nodes, nodes);
  totals.iterations += iterations;
  totals.most_iterations = std::max(totals.most_iterations, iterations);
  totals.seconds += solve.seconds;
  totals.longest = std::max(totals.longest, solve.seconds);
  solves.add(seconds(solve.t_ns), {iterations, 1000 * solve.seconds});
}

void RunData::add(const state::Notice& notice) {
  ++notices_seen;
  if (notices.size() < kMostNotices) notices.push_back(notice);
}

void RunData::add(const state::Epoch& epoch, const state::ReferenceError& error) {
  const double t = seconds(error.t_ns);
  position_error.add(t, error.position_n, epoch.sigma_of(state::block::position));
  if (error.velocity_n) {
    velocity_error.add(t, *error.velocity_n, epoch.sigma_of(state::block::velocity));
  }
  if (error.euler) {
    attitude_error.add(t, kDegrees * *error.euler,
                       kDegrees * vehicle_attitude(epoch, mounting_).sigma);
  }
}

void RunData::add(const state::Separation& s) {
  const double t = seconds(s.t_ns);
  position_separation.add(t, s.position_n, s.position_sigma);
  velocity_separation.add(t, s.velocity_n, s.velocity_sigma);
  attitude_separation.add(t, kDegrees * s.euler, kDegrees * s.euler_sigma);
}

void RunData::add(const Measurement& measurement) {
  if (const auto* fix = std::get_if<GnssFix>(&measurement)) add_fix(*fix);
  if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) add_increment(*increment);
}

void RunData::add_fix(const GnssFix& fix) {
  const double t = seconds(fix.t_ns);
  const Eigen::Vector3d sigma = sigma_of(fix.position_covariance);
  fix_sigmas.add(t, {sigma.x(), sigma.y(), sigma.z()});
  const FixDetails& told = fix.details;
  if (!told.satellites && !told.hdop && !told.correction_age) return;
  fix_details.add(t, {told.satellites ? *told.satellites : kNaN, told.hdop.value_or(kNaN),
                      told.correction_age.value_or(kNaN)});
}

void RunData::add_increment(const ImuIncrement& increment) {
  add_imu_stamp(increment.t_end_ns);
  const double dt = increment.dt();
  if (!(dt > 0)) return;
  const double t = seconds(increment.t_end_ns);
  ImuSpectrum::Sample rates;
  rates << kDegrees / dt * increment.dtheta_b, increment.dvel_b / dt;
  if (imu_steps.last_was_gap()) imu_rates.add_gap();
  imu_rates.add(t, {rates.begin(), rates.end()});
  const double step = last_imu_ ? t - *last_imu_ : dt;
  if (last_imu_) imu_intervals.add(step);
  imu_spectrum.add(step, rates);
  last_imu_ = t;
}

ImuGaps RunData::imu_gaps() const {
  ImuGaps gaps{imu_steps.longest_gaps(), imu_steps.gaps(), imu_steps.gap_duration()};
  for (const state::Notice& notice : notices) {
    if (notice.kind != state::NoticeKind::imu_gap) continue;
    const double length = told_length(notice.text);
    if (!(length > 0)) continue;
    const double end = seconds_between(start_ns_.value_or(notice.t_ns), notice.t_ns);
    const Interval told{end - length, end};
    const bool known = std::any_of(
        gaps.longest.begin(), gaps.longest.end(),
        [&](const Interval& gap) { return gap.begin < told.end && told.begin < gap.end; });
    if (known) continue;
    gaps.longest.push_back(told);
    ++gaps.count;
    gaps.duration += told.length();
  }
  std::sort(gaps.longest.begin(), gaps.longest.end(),
            [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
  return gaps;
}

void RunData::add_imu_stamp(int64_t t_ns) { imu_steps.observe(seconds(t_ns)); }

void RunData::add_outage(int64_t begin_ns, int64_t end_ns) {
  if (outages_.size() < kMostOutages) outages_.push_back({begin_ns, end_ns});
}

std::vector<Interval> RunData::outages() const {
  std::vector<Interval> intervals;
  if (!start_ns_) return intervals;
  for (const Stretch& outage : outages_) {
    intervals.push_back(
        {seconds_between(*start_ns_, outage.begin_ns), seconds_between(*start_ns_, outage.end_ns)});
  }
  return intervals;
}

std::string RunData::not_used_name() const {
  return verdicts.count(state::FixVerdict::corrected) > 0 ? "rejected or corrected" : "rejected";
}

}  // namespace foucault::content
