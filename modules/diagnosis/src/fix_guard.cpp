#include "foucault/diagnosis/fix_guard.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "foucault/core/median.h"
#include "foucault/core/position.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/reach.h"

namespace foucault::diagnosis {
namespace {

/// Chosen: receivers that report a wrong place do so for seconds, until they have a fix.
constexpr double kLongestContradiction = 60;  // [s]
/// Chosen, for tables at the rate of the IMU (50 Hz) and receivers with few digits: two of ten may
/// be cut short by lost fixes. Of a receiver in motion no position comes twice.
constexpr std::size_t kRuns = 10;
constexpr int kEnoughRuns = 8;
constexpr int kOften = 3;  // fixes of one position, at rest

bool velocity_is_valid(const GnssFix& fix) {
  return fix.velocity_n->allFinite() && fix.velocity_covariance.allFinite() &&
         fix.velocity_covariance.diagonal().minCoeff() >= 0;
}

}  // namespace

FixGuard::Verdict FixGuard::look_at(const GnssFix& fix) {
  Verdict verdict;
  ++seen_;
  if (!is_position(fix.antenna) || !fix.p_b_a.allFinite()) {
    no_position_.add(fix.t_ns);
    return verdict;
  }
  if (!in_reach(fix)) {
    out_of_reach_.add(fix.t_ns);
    return verdict;
  }
  if (held_positions_.repeats(fix)) {
    held_.add(fix.t_ns);
    verdict.held = true;
    return verdict;
  }
  verdict.fix = fix;
  if (fix.velocity_n && !velocity_is_valid(fix)) {
    verdict.fix->velocity_n.reset();
    bad_velocity_.add(fix.t_ns);
  }
  return verdict;
}

bool HeldPositions::repeats(const GnssFix& fix) {
  const bool same_stamp = first_ && fix.t_ns == std::exchange(last_ns_, fix.t_ns);
  if (same_stamp) return false;  // a fix that comes twice is another matter
  const bool same = first_ && first_->antenna.latitude == fix.antenna.latitude &&
                    first_->antenna.longitude == fix.antenna.longitude;
  if (same) {
    ++fixes_;
    return is_held();
  }
  if (first_) end_run(fix);
  first_ = fix;
  last_ns_ = fix.t_ns;
  fixes_ = 1;
  return false;
}

void HeldPositions::end_run(const GnssFix& next) {
  constexpr double kWalking = 1;  // [m/s]
  const double way = geodesy::least_distance(first_->antenna, next.antenna);
  const double time = std::abs(seconds_between(first_->t_ns, next.t_ns));
  runs_.push_back({fixes_, way > kWalking * time});
  if (runs_.size() > kRuns) runs_.pop_front();
}

bool HeldPositions::is_held() const {
  if (runs_.size() < kRuns) return false;
  int moving = 0;
  std::vector<int> lengths;
  for (const Run& run : runs_) {
    moving += run.moving && run.fixes > 1 ? 1 : 0;
    lengths.push_back(run.fixes);
  }
  const int usual = median(lengths);
  const int equal = static_cast<int>(std::count(lengths.begin(), lengths.end(), usual));
  return moving >= kEnoughRuns || (usual >= kOften && equal >= kEnoughRuns);
}

void FixGuard::go_on(std::optional<Place>& place, const GnssFix& fix) {
  if (!place || !geodesy::within_reach(place->last, fix)) place = Place{fix, fix.t_ns, 0};
  place->last = fix;
  ++place->fixes;
}

bool FixGuard::in_reach(const GnssFix& fix) {
  if (!believed_ || geodesy::within_reach(believed_->last, fix)) {
    go_on(believed_, fix);
    doubted_.reset();
    return true;
  }
  go_on(doubted_, fix);
  const bool more = doubted_->fixes > believed_->fixes;
  const bool longer = seconds_between(doubted_->since_ns, fix.t_ns) > kLongestContradiction;
  if (!more && !longer) return false;
  believed_ = doubted_;
  doubted_.reset();
  return true;
}

std::vector<std::string> FixGuard::summary() const {
  std::vector<std::string> lines;
  const auto add = [&](const Tally& tally, const char* what) {
    if (tally.count == 0) return;
    lines.push_back(
        fmt::format("{} fixes {}, the first at {}", tally.count, what, utc_text(tally.first_ns)));
  };
  add(no_position_,
      "are no positions (latitude and longitude zero, not finite, or out of range) and were left "
      "out");
  add(out_of_reach_, "lie where no vehicle gets to from the others and were left out");
  if (held_.count > 0) {
    lines.push_back(
        fmt::format("{} of {} fixes repeat the position before them under a new stamp; the first "
                    "of each counts, the repeats were left out, the first at {}",
                    held_.count, seen_, utc_text(held_.first_ns)));
  }
  add(bad_velocity_, "have a velocity or a sigma of it that is no number; it is not used");
  return lines;
}

}  // namespace foucault::diagnosis
