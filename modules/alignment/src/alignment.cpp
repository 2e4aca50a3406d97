#include "foucault/alignment/alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "foucault/core/constants.h"
#include "foucault/core/error.h"
#include "foucault/core/time.h"
#include "foucault/geodesy/course.h"
#include "foucault/geodesy/local_frame.h"
#include "foucault/geodesy/reach.h"
#include "foucault/geodesy/wgs84.h"
#include "foucault/state/vehicle_attitude.h"
#include "given_start.h"
#include "heading_bank.h"
#include "initial_state.h"
#include "motion_fit.h"
#include "refinement.h"
#include "rest_detector.h"
#include "starts.h"
#include "track.h"

namespace foucault::alignment {

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kLargestHole = 0.5;  // [s]: over a longer one the attitude is lost
constexpr double kEnoughRest = 10;    // [s]: with the heading given, a rest is complete
constexpr double kStretch = 3.9;      // [s], of the first level: four of a second and their jitter
constexpr double kLongestVelocity = 10;  // [s], over which that of the start is found
constexpr int kHypotheses = 12;          // of the heading: linear over the 15 deg to either side
/// What was found is used again in the run: with three times its sigma it counts for a ninth.
constexpr double kReuse = 9;
/// The longer the vehicle has moved, the less is asked of the heading; in the end to 10 deg, which
/// a filter still takes for linear.
struct Patience {
  double seconds, sigma;
};
constexpr Patience kPatience[] = {{120, 10 * kDegree}, {60, 3 * kDegree}, {0, 1 * kDegree}};
constexpr double kLargestSigma = kPatience[0].sigma;
constexpr double kApart = 5;      // sigmas between headings that are not the same
constexpr double kHopeless = 25;  // level: five times the sigmas
constexpr int kMostLeftOut = 5;   // beginnings; then the sigmas are wrong, which others tell
/// Twice the sigmas before, by the median of half a way, that a filter has later: a sample or a
/// bunch of fixes was wrong. Where sigmas are too small, both halves show it.
constexpr double kUnsettled = 4;
constexpr int kMostFailures = 3;  // of one beginning
constexpr double kRetry = 5;      // [s] after an attempt that failed

std::optional<GivenAngle> given(const std::optional<double>& degrees, double sigma_degrees) {
  if (!degrees) return std::nullopt;
  return GivenAngle{*degrees * kDegree, sigma_degrees * kDegree};
}

GivenAngles given_angles(const AlignmentOptions& options) {
  return {given(options.roll_deg, options.roll_sigma_deg),
          given(options.pitch_deg, options.pitch_sigma_deg),
          given(options.heading_deg, options.heading_sigma_deg)};
}

void require_all(const GivenAngles& angles) {
  std::vector<std::string> missing;
  if (!angles.roll) missing.emplace_back("roll_deg");
  if (!angles.pitch) missing.emplace_back("pitch_deg");
  if (!angles.heading) missing.emplace_back("heading_deg");
  if (missing.empty()) return;
  std::string list;
  for (const std::string& key : missing) list += (list.empty() ? "" : ", ") + key;
  throw UsageError("alignment.mode=given needs alignment." + list);
}

std::string wrong_axes(const std::string& up) {
  return fmt::format(
      "gravity points the wrong way: the IMU's axes say that up is the vehicle's {} axis; correct "
      "the axes of the import{}, or give alignment.roll_deg and pitch_deg if the vehicle does "
      "stand "
      "so",
      up,
      up == "down" ? " or, if `foucault check` finds the accelerometer's sign to be the opposite, "
                     "that alone (imu.accel_sign)"
                   : "");
}

std::string describe(const state::Epoch& epoch, const Quaterniond& q_v_b) {
  const state::VehicleAttitude attitude = state::vehicle_attitude(epoch, state::Mounting{q_v_b});
  const Vector3d sigma = attitude.sigma / kDegree;
  return fmt::format(
      "roll {:.2f} deg (sigma {:.2f}), pitch {:.2f} ({:.2f}), heading {:.2f} ({:.2f})",
      attitude.euler.roll / kDegree, sigma.x(), attitude.euler.pitch / kDegree, sigma.y(),
      attitude.euler.heading / kDegree, sigma.z());
}

}  // namespace

void AlignmentOptions::fields(ConfigFields& f) {
  f.text("mode", mode, {"auto", "given"},
         "auto: from rest and the GNSS course; given: roll_deg, pitch_deg and heading_deg");
  const Range half_turn{-180, 180};
  f.optional_number("roll_deg", roll_deg, half_turn, "of the vehicle at the start");
  f.optional_number("pitch_deg", pitch_deg, {-90, 90}, "of the vehicle at the start");
  f.optional_number("heading_deg", heading_deg, {-360, 360}, "of the vehicle at the start");
  f.number("roll_sigma_deg", roll_sigma_deg, kPositive, "sigma of a given roll");
  f.number("pitch_sigma_deg", pitch_sigma_deg, kPositive, "sigma of a given pitch");
  f.number("heading_sigma_deg", heading_sigma_deg, kPositive, "sigma of a given heading");
  for (const char* gone :
       {"min_speed_m_s", "max_course_sigma_deg", "max_turn_rate_deg_s", "mounting_sigma_deg"})
    f.replaced(gone, "nothing any more: the accelerations tell the heading, whatever the course");
  f.number("min_rest_s", min_rest_s, kPositive, "shorter rests are not used");
  f.number("max_rest_s", max_rest_s, {10, 3600}, "how far back the start may lie");
}

class Aligner::Impl {
 public:
  Impl(const AlignmentOptions& options, const imu::ImuNoise& noise, const state::Mounting& mounting,
       const state::Layout& layout)
      : options_(options),
        configured_(noise),
        noise_(noise),
        layout_(layout),
        mounting_{mounting.q_v_b.normalized()},
        given_(given_angles(options)),
        rest_(options.min_rest_s, options.max_rest_s),
        track_(options.max_rest_s),
        bank_(noise, layout, mounting_) {
    if (options_.mode == "given") require_all(given_);
  }

  void add(const GnssFix& fix);
  void add(const ImuIncrement& increment);
  void finish();
  void restart() { *this = Impl(options_, configured_, mounting_, layout_); }
  int64_t earliest_start_ns() const;
  std::string why_not() const;
  std::string why_undecided() const;

  std::optional<state::Epoch> initial_;
  std::string summary_;

 private:
  bool all_given() const { return options_.mode == "given"; }
  void note_hole(const ImuIncrement& increment);
  void forget_all();
  void take(const Step& step);

  void try_to_begin();
  bool rest_teaches_more() const;
  void forget_drive();
  bool rest_is_proven() const;
  std::vector<GnssFix> fixes_at_rest() const;
  void begin(AlignmentFindings findings, bool at_rest);
  void drive_over_kept();

  void throw_if_turned_over() const;
  bool beginning_is_wrong() const;
  void leave_out_until(int64_t t_ns);
  bool prior_is_wrong() const;
  void begin_again();
  double gyro_prior() const;
  double accel_prior() const;
  void decide();
  void conclude(double largest_sigma);
  void start_by_antennas();
  std::optional<AlignmentFindings> level_findings() const;
  void start_along_course();
  void note_course();
  std::optional<state::Epoch> start_from(const state::Epoch& found, double level) const;
  std::vector<Refined> refined_candidates(double level) const;
  void accept(const state::Epoch& epoch, const std::string& how);
  std::optional<std::string> wrong_up(const Vector3d& up_b) const;
  double heading_of(const state::Epoch& epoch) const;
  double heading_sigma(const Refined& refined) const;

  AlignmentOptions options_;
  imu::ImuNoise configured_;
  imu::ImuNoise noise_;  ///< the same, or with wider priors of the biases
  state::Layout layout_;
  state::Mounting mounting_;
  GivenAngles given_;

  RestDetector rest_;
  std::optional<FoundRest> rest_found_;  ///< the drive began with it
  Track track_;
  HeadingBank bank_;
  std::optional<AlignmentFindings> first_findings_;  ///< that the bank began from
  int64_t begin_ns_ = 0;                             ///< of the bank
  int64_t next_try_ns_ = 0;                          ///< after one that failed
  std::optional<HeadingBelief> belief_;
  std::optional<state::Epoch> along_course_;  ///< the latest of which the course is known
  std::string failure_;
  int left_out_ = 0;  ///< beginnings
  int failures_ = 0;  ///< in a row, of this one
  int widened_ = 0;   ///< priors of the biases

  GivenStart given_start_;

  std::optional<int64_t> first_increment_ns_, last_increment_ns_, first_fix_ns_;
  std::optional<GnssFix> last_fix_;
};

/// A fix that no vehicle reaches from the one before it has come through FixGuard: those before it
/// were wrong.
void Aligner::Impl::add(const GnssFix& fix) {
  if (!first_fix_ns_) first_fix_ns_ = fix.t_ns;
  const bool elsewhere = last_fix_ && !geodesy::within_reach(*last_fix_, fix);
  last_fix_ = fix;
  if (initial_) return;
  if (elsewhere) forget_all();
  if (all_given()) {
    if (const auto start = given_start_.add(fix, mounting_, given_, noise_))
      accept(with_antenna_blocks(*start, layout_), "as given");
    return;
  }
  rest_.add(fix);
  track_.add(fix);
}

void Aligner::Impl::add(const ImuIncrement& increment) {
  note_hole(increment);
  if (!first_increment_ns_) first_increment_ns_ = increment.t_begin_ns;
  last_increment_ns_ = increment.t_end_ns;
  if (initial_) return;
  if (all_given()) return given_start_.add(increment);
  rest_.add(increment);
  for (const Step& step : track_.add(increment)) {
    if (!initial_) take(step);
  }
}

void Aligner::Impl::take(const Step& step) {
  const auto* fix = std::get_if<GnssFix>(&step);
  if (!bank_.started()) {
    if (fix) try_to_begin();
    return;
  }
  if (fix && rest_teaches_more()) return forget_drive();
  if (const auto* increment = std::get_if<ImuIncrement>(&step)) return bank_.propagate(*increment);
  bank_.update(*fix);
  decide();
}

void Aligner::Impl::note_hole(const ImuIncrement& increment) {
  if (!last_increment_ns_) return;
  if (seconds_between(*last_increment_ns_, increment.t_begin_ns) <= kLargestHole) return;
  if (bank_.started() && belief_ && belief_->sigma <= kLargestSigma) conclude(kLargestSigma);
  if (!initial_) forget_all();
}

void Aligner::Impl::forget_all() {
  rest_ = RestDetector(options_.min_rest_s, options_.max_rest_s);
  track_ = Track(options_.max_rest_s);
  forget_drive();
  given_start_.restart();
}

// The beginning -----------------------------------------------------------------------------------

/// After a rest the level and the bias of the gyroscopes are known well; else the first fixes and
/// the forces between them tell the level.
void Aligner::Impl::try_to_begin() {
  const bool rests = rest_.established();
  if (rests && given_.heading && rest_.means().duration() > kEnoughRest && rest_is_proven()) {
    rest_found_ = FoundRest{rest_.means(), *rest_.first_fix()};
    return begin(
        findings_at_rest(rest_found_->means, fixes_at_rest().back(), noise_, mounting_.q_v_b),
        true);
  }
  if (rests && !rest_.ended()) return;
  if (rests && rest_is_proven()) {
    rest_found_ = FoundRest{rest_.means(), *rest_.first_fix()};
    return begin(
        findings_at_rest(rest_.recent_means(), fixes_at_rest().back(), noise_, mounting_.q_v_b),
        true);
  }
  const std::vector<GnssFix> fixes = track_.first_fixes(kStretch);
  if (fixes.size() < 3 || seconds_between(fixes.front().t_ns, fixes.back().t_ns) < kStretch) return;
  begin(findings_in_motion(fixes, track_.steps(), noise_, mounting_.q_v_b), false);
}

/// Of a heading about which the drive has told nothing yet.
bool Aligner::Impl::rest_teaches_more() const {
  constexpr double kNothing = 20 * kDegree;
  return rest_.established() && !given_.heading && (!belief_ || belief_->sigma > kNothing) &&
         rest_is_proven();
}

void Aligner::Impl::forget_drive() {
  noise_ = configured_;
  widened_ = 0;
  bank_ = HeadingBank(noise_, layout_, mounting_);
  rest_found_.reset();
  belief_.reset();
  along_course_.reset();
}

std::vector<GnssFix> Aligner::Impl::fixes_at_rest() const {
  const RestMeans means = rest_.means();
  std::vector<GnssFix> fixes;
  for (const Step& step : track_.steps()) {
    const auto* fix = std::get_if<GnssFix>(&step);
    if (fix && fix->t_ns >= means.begin_ns && fix->t_ns <= means.end_ns) fixes.push_back(*fix);
  }
  return fixes;
}

/// Steady sensors are those of a train on its way as well: the fixes must not move.
bool Aligner::Impl::rest_is_proven() const {
  constexpr double kStanding = 0.1;  // [m/s], three sigmas: nothing steers so slowly
  const std::vector<GnssFix> fixes = fixes_at_rest();
  if (fixes.size() < 2 || !rest_.first_fix()) return false;
  const MotionLine line = fit_line(fixes);
  return line.sigma < kStanding && line.velocity_n.head<2>().norm() < 3 * line.sigma + kStanding;
}

/// At rest up is where the accelerometers feel it. All headings are as likely, but for what the
/// gyroscopes at rest feel of the Earth's rotation.
void Aligner::Impl::begin(AlignmentFindings findings, bool at_rest) {
  const std::optional<std::string> up = wrong_up(findings.specific_force_b);
  if (at_rest && up) throw DataError(wrong_axes(*up));
  const int count = given_.heading ? 1 : kHypotheses;
  const double gap = 2 * kPi / count;
  const double prior_variance = gyro_prior() * gyro_prior();
  first_findings_ = findings;
  findings.heading_variance = gap * gap / 4;
  std::vector<state::Epoch> starts;
  std::vector<double> log_prior;
  for (int i = 0; i < count; ++i) {
    findings.heading = so3::wrap(i * gap);
    if (given_.heading) {
      findings.heading = given_.heading->value;
      findings.heading_variance = given_.heading->sigma * given_.heading->sigma;
    }
    const Vector3d rate_b = attitude_of(findings).conjugate() *
                            geodesy::wgs84::earth_rate_n(findings.fix.antenna.latitude);
    const Vector3d variance = findings.gyro_covariance.diagonal().array() + prior_variance;
    log_prior.push_back(-0.5 *
                        (findings.gyro_b - rate_b).cwiseAbs2().cwiseQuotient(variance).sum());
    const state::Epoch start =
        with_antenna_blocks(initial_state(findings, noise_, layout_), layout_);
    starts.push_back(with_given_angles(start, mounting_.q_v_b, {given_.roll, given_.pitch, {}}));
  }
  const double most = *std::max_element(log_prior.begin(), log_prior.end());
  constexpr double kContradiction = -12.5;  // the prior is wrong then, see fuse_gyro_prior()
  for (int i = 0; i < count; ++i) {
    bank_.add(starts[i], at_rest && most > kContradiction ? log_prior[i] - most : 0);
  }
  rest_ = RestDetector(options_.min_rest_s, options_.max_rest_s);
  begin_ns_ = findings.fix.t_ns;
  drive_over_kept();
  decide();
}

/// What came after the beginning until it was known to be one.
void Aligner::Impl::drive_over_kept() {
  for (const Step& step : track_.steps()) {
    if (const auto* increment = std::get_if<ImuIncrement>(&step)) {
      if (increment->t_begin_ns >= begin_ns_) bank_.propagate(*increment);
    } else if (const GnssFix& fix = std::get<GnssFix>(step); fix.t_ns > begin_ns_) {
      bank_.update(fix);
    }
  }
}

// The decision ------------------------------------------------------------------------------------

double Aligner::Impl::heading_of(const state::Epoch& epoch) const {
  return state::vehicle_attitude(epoch, mounting_).euler.heading;
}

double Aligner::Impl::heading_sigma(const Refined& refined) const {
  return std::sqrt(refined.level) * state::vehicle_attitude(refined.end, mounting_).sigma.z();
}

/// Where the accelerometers feel up on average, if the vehicle has moved for long enough to be done
/// with any manoeuvre.
void Aligner::Impl::throw_if_turned_over() const {
  constexpr double kLongestManoeuvre = 30;  // [s]
  if (seconds_between(track_.begin_ns(), *last_increment_ns_) < kLongestManoeuvre) return;
  if (const std::optional<std::string> up = wrong_up(track_.mean_force_b()))
    throw DataError(wrong_axes(*up));
}

/// No heading agrees with the fixes, by far: the first of them may be wrong, from which all begin.
/// If it is not, sigmas are; which shows in others as well. Or something on the way was wrong.
bool Aligner::Impl::beginning_is_wrong() const {
  const bool late = seconds_between(begin_ns_, belief_->best.t_ns) > kPatience[1].seconds;
  const bool torn = late && belief_->settling > kUnsettled;
  const bool hopeless = !(belief_->level < kHopeless) || !std::isfinite(belief_->sigma);
  return (torn || hopeless) && left_out_ < kMostLeftOut;
}

/// What comes later may be better.
void Aligner::Impl::leave_out_until(int64_t t_ns) {
  ++left_out_;
  failures_ = 0;
  track_.forget_until(t_ns);
  forget_drive();
}

/// A bias that is found to be beyond what was thought possible (one in 16000) was not.
bool Aligner::Impl::prior_is_wrong() const {
  constexpr double kBeyond = 4;  // sigmas
  constexpr int kMost = 3;       // times: each shows more of it
  if (widened_ == kMost) return false;
  const state::Epoch& epoch = belief_->best;
  const auto beyond = [&](const Vector3d& bias, const Vector3d& sigma, double prior) {
    return (bias.cwiseAbs().array() > kBeyond * (prior + std::sqrt(belief_->level) * sigma.array()))
        .any();
  };
  return beyond(epoch.bias.gyro, epoch.sigma_of(state::block::gyro_bias), gyro_prior()) ||
         beyond(epoch.bias.accel, epoch.sigma_of(state::block::accel_bias), accel_prior());
}

/// From the same findings, with priors that what was found lies within. What follows may show more.
void Aligner::Impl::begin_again() {
  constexpr double kMostGyro = 0.3, kMostAccel = 5;  // [rad/s], [m/s^2]: none has more
  const state::ImuBias bias = belief_->best.bias;
  const imu::ImuNoise before = noise_;
  const int widened_before = widened_;
  const std::optional<FoundRest> rest = rest_found_;
  const RestDetector detector = rest_;
  forget_drive();
  const auto widened = [](double sigma, const Vector3d& found, double most) {
    return std::max(sigma, std::min(found.cwiseAbs().maxCoeff(), most));
  };
  noise_.gyro_turn_on_sigma = widened(before.gyro_turn_on_sigma, bias.gyro, kMostGyro);
  noise_.accel_turn_on_sigma = widened(before.accel_turn_on_sigma, bias.accel, kMostAccel);
  widened_ = widened_before + 1;
  bank_ = HeadingBank(noise_, layout_, mounting_);
  rest_found_ = rest;
  if (rest) {
    begin(*first_findings_, true);
  } else {
    const std::vector<GnssFix> fixes = track_.first_fixes(kStretch, begin_ns_);
    begin(findings_in_motion(fixes, track_.steps(), noise_, mounting_.q_v_b), false);
  }
  rest_ = detector;
}

double Aligner::Impl::gyro_prior() const {
  return std::hypot(noise_.gyro_turn_on_sigma, noise_.gyro_bias_sigma);
}
double Aligner::Impl::accel_prior() const {
  return std::hypot(noise_.accel_turn_on_sigma, noise_.accel_bias_sigma);
}

void Aligner::Impl::decide() {
  belief_ = bank_.belief();
  note_course();
  const int64_t now_ns = belief_->best.t_ns;
  const double age = seconds_between(begin_ns_, now_ns);
  if (prior_is_wrong()) return begin_again();
  if (beginning_is_wrong()) {
    return leave_out_until(age > kPatience[1].seconds ? now_ns : begin_ns_);
  }
  if (now_ns < next_try_ns_) return;
  throw_if_turned_over();
  for (const Patience& patience : kPatience) {
    if (age < patience.seconds) continue;
    if (given_.heading || belief_->sigma <= patience.sigma) conclude(patience.sigma);
    break;
  }
  if (!initial_ && age > kPatience[0].seconds) start_by_antennas();
  if (!initial_ && age > 0.95 * options_.max_rest_s) start_along_course();
  next_try_ns_ = now_ns + nanoseconds(kRetry);
}

void Aligner::Impl::finish() {
  if (initial_ || all_given()) return;
  if (bank_.started()) {
    belief_ = bank_.belief();
    if (given_.heading || belief_->sigma <= kLargestSigma) conclude(kLargestSigma);
  }
  if (!initial_) start_by_antennas();
  if (!initial_) start_along_course();
}

/// The start for an attitude that was found later: at the rest that the drive began with, else at
/// the first fix that is kept.
std::optional<state::Epoch> Aligner::Impl::start_from(const state::Epoch& found,
                                                      double level) const {
  state::Epoch epoch;
  if (rest_found_ && rest_found_->first.t_ns >= track_.begin_ns()) {  // heading as at its end
    const CarriedBack back = carried_back(found, track_.steps(), begin_ns_, noise_);
    state::Epoch turned;
    turned.q_n_b = back.q_n_b;
    turned.covariance.block<9, 9>(6, 6) = back.covariance;
    const state::VehicleAttitude attitude = state::vehicle_attitude(turned, mounting_);
    AlignmentFindings findings =
        findings_at_rest(rest_found_->means, rest_found_->first, noise_, mounting_.q_v_b);
    findings.heading = attitude.euler.heading;
    findings.heading_variance = kReuse * level * attitude.sigma.z() * attitude.sigma.z();
    epoch = initial_state(findings, noise_, layout_);
  } else {
    const std::vector<GnssFix> fixes = track_.first_fixes(kStretch);
    if (fixes.size() < 3) return std::nullopt;
    CarriedBack back = carried_back(found, track_.steps(), fixes.front().t_ns, noise_);
    back.reuse(kReuse * level, noise_);
    epoch = state_in_motion(track_.first_fixes(kLongestVelocity), track_.steps(), back);
  }
  constexpr double kStillLinear = 1;  // [rad]
  if (!(epoch.sigma_of(state::block::attitude).maxCoeff() < kStillLinear)) return std::nullopt;
  return with_given_angles(with_antenna_blocks(epoch, layout_), mounting_.q_v_b, given_);
}

std::vector<Refined> Aligner::Impl::refined_candidates(double level) const {
  constexpr std::size_t kMost = 4;
  const auto make_start = [this](const state::Epoch& found, double at) {
    return start_from(found, at);
  };
  std::vector<Refined> all;
  for (const state::Epoch& candidate : bank_.candidates()) {
    if (all.size() == kMost) break;
    const bool known = std::any_of(all.begin(), all.end(), [&](const Refined& refined) {
      return std::abs(so3::wrap(heading_of(candidate) - heading_of(refined.end))) <
             kApart * heading_sigma(refined);
    });
    if (known) continue;
    const std::optional<Refined> refined =
        refine(candidate, level, track_.steps(), noise_, layout_, make_start);
    if (refined) all.push_back(*refined);
  }
  std::sort(all.begin(), all.end(), [&](const Refined& a, const Refined& b) {
    return a.agreement.misfit(level) < b.agreement.misfit(level);
  });
  return all;
}

/// Once refined, one heading must be known well enough, and be the only one.
void Aligner::Impl::conclude(double largest_sigma) {
  constexpr double kOdds = 14;  // twice the log of one in a thousand
  const std::vector<Refined> all = refined_candidates(belief_->level);
  if (all.empty()) {
    failure_ = "no state was found from which a filter keeps to the fixes";
    if (++failures_ >= kMostFailures)
      leave_out_until(begin_ns_ + (belief_->best.t_ns - begin_ns_) / 2);
    return;
  }
  const Refined& best = all.front();
  if (left_out_ < kMostLeftOut && best.settling > kUnsettled) {
    return leave_out_until(best.start.t_ns + (best.end.t_ns - best.start.t_ns) / 2);
  }
  const double sigma = heading_sigma(best);
  failure_ = fmt::format("the heading is known to {:.0f} deg only, {:.0f} are needed",
                         sigma / kDegree, kLargestSigma / kDegree);
  if (!given_.heading && sigma > largest_sigma) return;
  for (const Refined& other : all) {
    const double apart = std::abs(so3::wrap(heading_of(other.end) - heading_of(best.end)));
    const double odds = other.agreement.misfit(best.level) - best.agreement.misfit(best.level);
    if (apart <= kApart * sigma || odds >= kOdds) continue;
    failure_ =
        fmt::format("headings that are {:.0f} deg apart agree with the fixes", apart / kDegree);
    return;
  }
  const double seconds = seconds_between(best.start.t_ns, best.end.t_ns);
  accept(
      best.start,
      fmt::format("{}from {:.0f} s of motion{}", rest_found_ ? "from rest and " : "", seconds,
                  given_.heading ? ", heading given"
                                 : fmt::format(", after which its heading was known to {:.1f} deg",
                                               sigma / kDegree)));
}

/// At the rest, else at the first fix that is kept: of a vehicle heading north.
std::optional<AlignmentFindings> Aligner::Impl::level_findings() const {
  if (rest_found_ && rest_found_->first.t_ns >= track_.begin_ns())
    return findings_at_rest(rest_found_->means, rest_found_->first, noise_, mounting_.q_v_b);
  if (!bank_.started() && rest_.established() && rest_is_proven())
    return findings_at_rest(rest_.means(), fixes_at_rest().front(), noise_, mounting_.q_v_b);
  const std::vector<GnssFix> fixes = track_.first_fixes(kStretch);
  if (fixes.size() < 3) return std::nullopt;
  return findings_in_motion(fixes, track_.steps(), noise_, mounting_.q_v_b);
}

/// The heading of two antennas, where motion tells none: they would contradict it if they were
/// wrong, and then nobody would know.
void Aligner::Impl::start_by_antennas() {
  if (given_.heading || (belief_ && belief_->sigma <= kLargestSigma)) return;
  const std::optional<AlignmentFindings> level = level_findings();
  if (!level || !level->fix.heading || wrong_up(level->specific_force_b)) return;
  const AlignmentFindings found = with_antenna_heading(*level);
  const state::Epoch start = with_baseline_block(
      with_antenna_blocks(initial_state(found, noise_, layout_), layout_), found, layout_);
  accept(with_given_angles(start, mounting_.q_v_b, {given_.roll, given_.pitch, {}}),
         "by the heading of two antennas, for motion did not tell it");
}

void Aligner::Impl::note_course() {
  constexpr double kClear = 5 * kDegree;
  const state::Epoch& epoch = belief_->best;
  const Matrix3d covariance = epoch.covariance_of(state::block::velocity);
  if (geodesy::course_sigma(covariance, epoch.velocity_n) < kClear) along_course_ = epoch;
}

/// Straight and steady motion tells nothing of the heading. Most vehicles go along their nose, some
/// with leeway: the course is taken if the fixes do not speak against it.
void Aligner::Impl::start_along_course() {
  if (!along_course_ || !(belief_->level < kHopeless)) return;
  const double course = geodesy::azimuth(along_course_->velocity_n);
  const double off = so3::wrap(course - belief_->heading);
  if (std::abs(off) > 2 * std::max(belief_->sigma, kLargestSigma)) return;
  GivenAngles along;
  along.heading = GivenAngle{course, kLargestSigma / std::sqrt(kReuse)};
  const state::Epoch found = with_given_angles(*along_course_, mounting_.q_v_b, along);
  const std::optional<state::Epoch> start = start_from(found, 1);
  if (!start) return;
  accept(*start,
         "along the course, for nothing but straight and steady motion was there to tell "
         "the heading");
}

void Aligner::Impl::accept(const state::Epoch& epoch, const std::string& how) {
  initial_ = epoch;
  summary_ = fmt::format("aligned {}: {}", how, describe(epoch, mounting_.q_v_b));
}

/// Axes named wrongly are seen in the mean over the drive: which axis of the vehicle is up instead.
std::optional<std::string> Aligner::Impl::wrong_up(const Vector3d& up_b) const {
  constexpr double kSteepest = 60 * kDegree;
  if (given_.roll || given_.pitch || !(up_b.norm() > kStandardGravity / 2)) return std::nullopt;
  const Vector3d up_v = mounting_.q_v_b * up_b.normalized();
  if (-up_v.z() > std::cos(kSteepest)) return std::nullopt;
  Eigen::Index axis = 0;
  up_v.cwiseAbs().maxCoeff(&axis);
  const bool plus = up_v[axis] > 0;
  const char* const names[] = {plus ? "forward" : "backward", plus ? "right" : "left",
                               plus ? "down" : "up"};
  return std::string(names[axis]);
}

int64_t Aligner::Impl::earliest_start_ns() const {
  if (given_start_.fix()) return given_start_.fix()->t_ns;
  if (!last_increment_ns_) {
    return last_fix_ ? last_fix_->t_ns - kNanosecondsPerSecond : INT64_MIN;
  }
  return all_given() ? *last_increment_ns_ : std::min(track_.begin_ns(), *last_increment_ns_);
}

std::string Aligner::Impl::why_undecided() const {
  const double seconds = seconds_between(begin_ns_, belief_->best.t_ns);
  if (belief_->sigma <= kLargestSigma && !failure_.empty())
    return fmt::format("after {:.0f} s of motion {}", seconds, failure_);
  return fmt::format(
      "{:.0f} s of motion tell the heading to {:.0f} deg only, {:.0f} are needed: the vehicle "
      "turned or accelerated too little for its fixes",
      seconds, belief_->sigma / kDegree, kLargestSigma / kDegree);
}

std::string Aligner::Impl::why_not() const {
  const std::string head = "no initial attitude was found: ";
  const std::string remedy =
      given_.heading ? "; see `foucault check`, or give alignment.mode=given with roll_deg and "
                       "pitch_deg, too"
                     : "; see `foucault check` for what else is wrong, then give "
                       "alignment.heading_deg, or alignment.mode=given with roll_deg, pitch_deg "
                       "and heading_deg";
  if (!first_increment_ns_) return head + "there is no IMU data";
  if (!first_fix_ns_) return head + "there is no usable GNSS fix";
  if (last_fix_->t_ns < *first_increment_ns_ || *last_increment_ns_ < *first_fix_ns_) {
    return head + fmt::format(
                      "GNSS ({} to {}) and IMU ({} to {}) do not overlap in "
                      "time; check the time systems and offsets of the import",
                      utc_text(*first_fix_ns_), utc_text(last_fix_->t_ns),
                      utc_text(*first_increment_ns_), utc_text(*last_increment_ns_));
  }
  if (all_given()) return head + "there are fewer than two fixes within the IMU data";
  if (const std::optional<std::string> up = wrong_up(track_.mean_force_b()))
    return head + wrong_axes(*up);
  if (left_out_ > 0) {
    return head + fmt::format(
                      "{} beginnings were tried, and from none does a filter keep to the "
                      "fixes: axes, the sign of the accelerometer, clocks, the lever arm or "
                      "the noise are wrong; `foucault check` names those that it can tell",
                      left_out_);
  }
  if (belief_) return head + why_undecided() + remedy;
  if (rest_.established()) {
    const double seconds = seconds_between(track_.begin_ns(), *last_increment_ns_);
    if (seconds < kEnoughRest)
      return head + fmt::format(
                        "the vehicle rested for all of {:.1f} s, which does not tell the heading; "
                        "give alignment.mode=given with roll_deg, pitch_deg and heading_deg, or "
                        "record {:.0f} s and give alignment.heading_deg",
                        seconds, kEnoughRest);
    return head + "the vehicle rested all the time, which does not tell the heading" + remedy;
  }
  return head +
         fmt::format(
             "three fixes over {:.0f} s of IMU data without a hole of {:g} s are needed, "
             "and never were there",
             kStretch, kLargestHole) +
         remedy;
}

Aligner::Aligner(const AlignmentOptions& options, const imu::ImuNoise& noise,
                 const state::Mounting& mounting, const state::Layout& layout)
    : impl_(std::make_unique<Impl>(options, noise, mounting, layout)) {}
Aligner::~Aligner() = default;
Aligner::Aligner(Aligner&&) noexcept = default;
Aligner& Aligner::operator=(Aligner&&) noexcept = default;

void Aligner::add(const GnssFix& fix) { impl_->add(fix); }
void Aligner::add(const ImuIncrement& increment) { impl_->add(increment); }
const std::optional<state::Epoch>& Aligner::initial() const { return impl_->initial_; }
std::string Aligner::summary() const { return impl_->summary_; }
int64_t Aligner::earliest_start_ns() const { return impl_->earliest_start_ns(); }
std::string Aligner::why_not() const { return impl_->why_not(); }
void Aligner::finish() { impl_->finish(); }
void Aligner::restart() { impl_->restart(); }

}  // namespace foucault::alignment
