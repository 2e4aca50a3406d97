#include "foucault/diagnosis/examination.h"

#include <fmt/format.h>

#include <algorithm>

#include "foucault/core/time.h"

namespace foucault::diagnosis {

Examination::Examination(const imu::ImuNoise& configured, const state::Mounting& mounting,
                         const GnssOptions& gnss)
    : configured_(configured), options_(gnss), plausibility_(mounting.q_v_b.normalized()) {}

ImuGuard::Verdict Examination::admit(const ImuIncrement& increment) {
  const std::optional<int64_t> before_ns = imu_guard_.last_end_ns();
  const ImuGuard::Verdict verdict = imu_guard_.look_at(increment);
  if (imu_guard_.last_end_ns() != before_ns) imu_.add(increment.t_end_ns);
  if (!verdict.increment) return verdict;
  rest_.add(*verdict.increment);
  commutation_.add(*verdict.increment);
  plausibility_.watch(*verdict.increment);
  return verdict;
}

FixGuard::Verdict Examination::admit(const GnssFix& given) {
  count(given);
  const FixGuard::Verdict verdict = fix_guard_.look_at(given);
  if (!verdict.fix) return verdict;
  const GnssFix& fix = *verdict.fix;
  if (!lever_arm_) {
    lever_arm_ = fix.p_b_a.norm();
    lever_arm_known_ = fix.lever_arm_known;
  }
  sigmas_.add(fix.position_covariance);
  if (!options_.allows(fix)) return verdict;
  rest_.add(fix);
  reference_.add(fix);
  velocities_.add(fix);
  plausibility_.watch(fix);
  return verdict;
}

void Examination::add(const Measurement& measurement) {
  if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) admit(*increment);
  if (const auto* fix = std::get_if<GnssFix>(&measurement)) admit(*fix);
  if (const auto* pose = std::get_if<ReferencePose>(&measurement)) admit(*pose);
}

LogFacts Examination::facts() const {
  LogFacts facts;
  facts.imu = imu_.facts();
  facts.gnss = gnss_.facts();
  facts.bad_samples = imu_guard_.summary();
  facts.bad_fixes = fix_guard_.summary();
  facts.overlap_s = seconds_between(std::max(facts.imu.first_ns, facts.gnss.first_ns),
                                    std::min(facts.imu.last_ns, facts.gnss.last_ns));
  facts.sigmas = sigmas_;
  facts.lever_arm_m = lever_arm_;
  facts.lever_arm_known = lever_arm_known_;
  facts.force = plausibility_.force();
  facts.rest = rest_.facts();
  facts.commutation = commutation_.facts();
  facts.reference = reference_.facts();
  facts.velocities = velocities_.facts();
  facts.turns = plausibility_.turns();
  facts.accelerations = plausibility_.accelerations();
  return facts;
}

std::vector<state::Notice> Examination::warnings() const {
  const LogFacts all = facts();
  std::vector<state::Notice> warnings;
  for (const Finding& finding : judge(all, configured_)) {
    if (finding.severity == Severity::ok) continue;
    if (finding.subject == kSamplesSubject || finding.subject == kFixesSubject) continue;
    warnings.push_back({all.imu.first_ns, state::NoticeKind::skipped,
                        fmt::format("{}: {} ({})", finding.subject, finding.text, finding.remedy)});
  }
  return warnings;
}

}  // namespace foucault::diagnosis
