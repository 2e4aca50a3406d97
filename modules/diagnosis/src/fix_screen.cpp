#include "foucault/diagnosis/fix_screen.h"

#include <cmath>
#include <utility>

#include "foucault/core/time.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"

namespace foucault::diagnosis {
namespace {

constexpr double kAcceleration = 8;  // [m/s^2], the grip of a road (0.8 g)
constexpr double kScreenSigmas = 5;  // three fixes' sigmas summed: one in two million at least
constexpr int kEnough = 3;           // chosen; with the next and the first, five in a row
constexpr double kLongestWait = 3;   // [s]; chosen: fixes at 1 Hz, of which one is missing

/// Distance of a fix from the line through two others, which a vehicle can explain by its
/// acceleration up to a part of it.
struct Deviation {
  double horizontal = 0;
  double explained = 0;
};

Deviation deviation(const GnssFix& fix, const GnssFix& a, const GnssFix& b) {
  const double to_a = seconds_between(a.t_ns, fix.t_ns);
  const double to_b = seconds_between(fix.t_ns, b.t_ns);
  const double share = to_a / seconds_between(a.t_ns, b.t_ns);
  const geodesy::LocalFrame frame(fix.antenna);
  const Eigen::Vector3d on_line =
      (1 - share) * frame.to_local(a.antenna) + share * frame.to_local(b.antenna);
  const double sigma = geodesy::horizontal_sigma(fix.position_covariance) +
                       std::abs(1 - share) * geodesy::horizontal_sigma(a.position_covariance) +
                       std::abs(share) * geodesy::horizontal_sigma(b.position_covariance);
  return {on_line.head<2>().norm(),
          0.5 * kAcceleration * std::abs(to_a * to_b) + kScreenSigmas * sigma};
}

bool in_line(const GnssFix& fix, const GnssFix& a, const GnssFix& b) {
  const Deviation d = deviation(fix, a, b);
  return !(d.horizontal > d.explained);
}

}  // namespace

std::optional<FixScreen::Screened> FixScreen::next(bool all) {
  if (waiting_.empty()) return std::nullopt;
  Screened screened{waiting_.front(), true};
  const auto* fix = std::get_if<GnssFix>(&screened.measurement);
  if (fix != nullptr && fix->position_covariance.allFinite()) {
    const std::optional<GnssFix> after = second_fix();
    const bool waited = seconds_between(fix->t_ns, stamp(waiting_.back())) > kLongestWait;
    if (before_ && !after && !waited && !all) return std::nullopt;
    if (before_ && after) {
      screened.plausible = in_line(*fix, *before_, *after) || doubted_agree(*fix, *after);
    }
    if (screened.plausible) believe(*fix);
  }
  waiting_.pop_front();
  return screened;
}

/// Of fixes that do not go with the last plausible one, those in a row that go with each other.
bool FixScreen::doubted_agree(const GnssFix& fix, const GnssFix& after) {
  const bool agrees = doubted_ && in_line(fix, *doubted_, after);
  agreeing_ = agrees ? agreeing_ + 1 : 0;
  doubted_ = fix;
  return agreeing_ == kEnough;
}

void FixScreen::believe(const GnssFix& fix) {
  before_ = fix;
  doubted_.reset();
}

std::optional<GnssFix> FixScreen::second_fix() const {
  for (std::size_t i = 1; i < waiting_.size(); ++i) {
    const auto* fix = std::get_if<GnssFix>(&waiting_[i]);
    if (fix != nullptr && fix->position_covariance.allFinite()) return *fix;
  }
  return std::nullopt;
}

std::deque<Measurement> FixScreen::take_all() { return std::exchange(waiting_, {}); }

void FixScreen::restart() {
  before_.reset();
  doubted_.reset();
}

}  // namespace foucault::diagnosis
