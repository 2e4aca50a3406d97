#include "aligning.h"

#include <utility>

#include "foucault/core/profile.h"

namespace foucault::navigation {

Aligning::Aligning(alignment::Aligner aligner, const diagnosis::GnssOptions& options)
    : aligner_(std::move(aligner)), options_(options) {}

std::optional<Start> Aligning::take(const Measurement& measurement) {
  if (options_.gate_false_alarm == 0) return add({measurement, true});
  screen_.add(measurement);
  return look_through_screen(false);
}

std::optional<Start> Aligning::finish() {
  if (std::optional<Start> start = look_through_screen(true)) return start;
  if (aligner_.initial()) return std::nullopt;
  aligner_.finish();
  if (!aligner_.initial()) return std::nullopt;
  return start();
}

void Aligning::restart() {
  aligner_.restart();
  screen_.restart();
  held_.clear();
}

std::optional<Start> Aligning::look_through_screen(bool all) {
  while (const std::optional<diagnosis::FixScreen::Screened> screened = screen_.next(all)) {
    if (std::optional<Start> start = add(*screened)) return start;
  }
  return std::nullopt;
}

std::optional<Start> Aligning::add(const diagnosis::FixScreen::Screened& screened) {
  held_.push_back(screened.measurement);
  show_aligner(screened);
  if (aligner_.initial()) return start();
  drop_what_no_start_needs();
  return std::nullopt;
}

void Aligning::show_aligner(const diagnosis::FixScreen::Screened& screened) {
  const StageTimer timer(Stage::align);
  if (const auto* increment = std::get_if<ImuIncrement>(&screened.measurement)) {
    aligner_.add(*increment);
  }
  if (const auto* fix = std::get_if<GnssFix>(&screened.measurement)) {
    if (screened.plausible && options_.allows(*fix)) aligner_.add(options_.weighted(*fix));
  }
}

Start Aligning::start() {
  Start start{*aligner_.initial(), {}};
  for (Measurement& waiting : screen_.take_all()) held_.push_back(std::move(waiting));
  for (Measurement& held : held_) {
    if (stamp(held) > start.initial.t_ns) start.since.push_back(std::move(held));
  }
  held_.clear();
  return start;
}

void Aligning::drop_what_no_start_needs() {
  const int64_t earliest_ns = aligner_.earliest_start_ns();
  while (!held_.empty() && stamp(held_.front()) < earliest_ns) held_.pop_front();
}

}  // namespace foucault::navigation
