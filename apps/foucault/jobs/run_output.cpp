#include "jobs/run_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "foucault/core/profile.h"
#include "foucault/core/time.h"
#include "foucault/core/units.h"
#include "foucault/evaluation/statistics.h"

namespace foucault::app {
namespace {

evaluation::ReferenceComparisonOptions comparison_options(double keep_s) {
  evaluation::ReferenceComparisonOptions options;
  options.keep_s = keep_s;
  return options;
}

}  // namespace

RunOutput::RunOutput(const std::filesystem::path& folder, const state::Mounting& mounting,
                     const OutputOptions& options, double keep_references_s,
                     content::RunReport* report, Console& console)
    : mounting_(mounting),
      statistics_from_s_(options.statistics_from_s),
      solution_(folder, mounting),
      reference_(folder / "reference.tum"),
      comparison_(
          mounting,
          [this](const state::Epoch& epoch, const state::ReferenceError& error) {
            reference_error(epoch, error);
          },
          comparison_options(keep_references_s)),
      forward_(mounting,
               [this](const state::Separation& separation) {
                 if (report_ != nullptr) report_->separation(separation);
               }),
      facts_(mounting),
      report_(report),
      console_(console) {}

void RunOutput::measurement(const Measurement& measurement) {
  if (!start_ns_) start(stamp(measurement));
  facts_.measurement(measurement);
  if (report_ != nullptr) report_->measurement(measurement);
  if (const auto* fix = std::get_if<GnssFix>(&measurement)) {
    if (!metrics_) start_metrics(fix->t_ns);
    reference_.fix();
  } else if (const auto* reference = std::get_if<ReferencePose>(&measurement)) {
    comparison_.add(*reference);
    forward_.reference(*reference);
    reference_.add(*reference);
  }
}

void RunOutput::start(int64_t t_ns) {
  start_ns_ = t_ns;
  if (report_ != nullptr) report_->start(t_ns);
}

void RunOutput::start_metrics(int64_t first_fix_ns) {
  const int64_t from_ns = first_fix_ns + nanoseconds(statistics_from_s_);
  forward_.start(from_ns);
  if (report_ != nullptr && statistics_from_s_ > 0) report_->start_statistics(from_ns);
  metrics_.emplace(mounting_, from_ns, [this](const NormalizedSquare& square) {
    if (report_ != nullptr) report_->normalized_square(square);
  });
}

void RunOutput::epoch(const state::Epoch& epoch) {
  last_epoch_ = epoch;
  facts_.epoch(epoch);
  write(epoch);
  collect(epoch);
  const StageTimer timer(Stage::statistics);
  if (metrics_) metrics_->epoch(epoch);
  comparison_.add(epoch);
  forward_.smoothed(epoch);
}

void RunOutput::forward_epoch(const state::Epoch& epoch) {
  forward_.epoch(epoch);
  if (report_ == nullptr) return;
  const StageTimer timer(Stage::draw);
  report_->forward_epoch(epoch);
}

void RunOutput::write(const state::Epoch& epoch) {
  const StageTimer timer(Stage::write);
  solution_.epoch(epoch);
  reference_.origin(epoch.position);
}

void RunOutput::collect(const state::Epoch& epoch) {
  if (report_ == nullptr) return;
  const StageTimer timer(Stage::draw);
  report_->epoch(epoch);
}

void RunOutput::fix(const state::FixResult& fix) {
  if (report_ != nullptr) report_->fix(fix);
  if (metrics_) metrics_->fix(fix);
  forward_.fix(fix);
}

void RunOutput::observation(const state::ObservationResult& result) {
  if (report_ != nullptr) report_->observation(result);
  if (metrics_) metrics_->observation(result);
}

void RunOutput::prediction(const state::PredictionResult& prediction) {
  if (metrics_) metrics_->prediction(prediction);
}

void RunOutput::catching_up(std::size_t left) {
  most_left_ = left == 0 ? 0 : std::max(most_left_, left);
  if (left > 0) {
    console_.progress("catching up",
                      1 - static_cast<double>(left) / static_cast<double>(most_left_));
  }
}

void RunOutput::notice(const state::Notice& notice) {
  facts_.notice(notice);
  if (report_ != nullptr) report_->notice(notice);
  if (notice.kind == state::NoticeKind::aligned) {
    console_.say_once(fmt::format("start      {}, {}", utc_text(notice.t_ns), notice.text));
  } else {
    console_.warn(fmt::format("{}: {}", utc_text(notice.t_ns), notice.text));
  }
}

void RunOutput::remark(const std::string& text) {
  const state::Notice notice{start_ns_.value_or(0), state::NoticeKind::skipped, text};
  facts_.notice(notice);
  if (report_ != nullptr) report_->notice(notice);
}

void RunOutput::damage(const std::string& text) {
  if (report_ != nullptr) report_->notice({last_epoch_.t_ns, state::NoticeKind::skipped, text});
}

void RunOutput::reference_error(const state::Epoch& epoch, const state::ReferenceError& error) {
  if (report_ != nullptr) report_->reference_error(epoch, error);
  if (metrics_) metrics_->reference_error(epoch, error);
}

evaluation::RunMetrics RunOutput::finish() {
  const StageTimer timer(Stage::write);
  solution_.finish();
  reference_.finish();
  if (!metrics_) return {};
  const evaluation::RunMetrics metrics = metrics_->metrics();
  if (report_ == nullptr) return metrics;
  report_->consistency(metrics.consistency);
  for (const auto& [name, aid] : metrics.aids) {
    report_->aid({name, aid.dimension, aid.used, aid.rejected, aid.mean_nis(),
                  evaluation::mean_nees_band(aid.dimension, 1)});
  }
  return metrics;
}

}  // namespace foucault::app
