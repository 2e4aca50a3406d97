#include "timeline_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "foucault/core/time.h"
#include "foucault/plot/text.h"
#include "run_panels.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

constexpr std::array<state::FixVerdict, 5> kRejections{
    state::FixVerdict::gated, state::FixVerdict::corrected, state::FixVerdict::low_quality,
    state::FixVerdict::bad_sigma, state::FixVerdict::out_of_order};
constexpr double kLaneHeight = 8.5;  // [mm]

struct EventStyle {
  state::NoticeKind kind;
  std::string_view lane;
  const char* name;
  Shape shape;
  Ink ink;
};

constexpr std::string_view kNotices = "notices";
constexpr std::string_view kAlignment = "alignment";

/// Later ones are drawn over earlier ones.
constexpr std::array<EventStyle, 5> kEvents{{
    {state::NoticeKind::skipped, kNotices, "notice", Shape::diamond, Ink::gray},
    {state::NoticeKind::fix_rejected, kNotices, "fix rejected", Shape::cross, Ink::vermillion},
    {state::NoticeKind::imu_gap, kNotices, "IMU gap", Shape::square, Ink::purple},
    {state::NoticeKind::aligned, kAlignment, "aligned", Shape::triangle, Ink::green},
    {state::NoticeKind::realigned, kAlignment, "aligned again", Shape::triangle, Ink::orange},
}};

std::string notice_name(state::NoticeKind kind) {
  for (const EventStyle& event : kEvents) {
    if (event.kind == kind) return event.name;
  }
  return {};
}

size_t count_of(const RunData& data, state::FixVerdict verdict) {
  const auto found = data.verdicts.find(verdict);
  return found == data.verdicts.end() ? 0 : found->second;
}

size_t fixes(const RunData& data) {
  size_t sum = 0;
  for (const auto& [verdict, count] : data.verdicts) sum += count;
  return sum;
}

// ---- words

std::string plural(size_t count, const std::string& one, const std::string& more) {
  return fmt::format("{} {}", number_text(static_cast<double>(count), 0), count == 1 ? one : more);
}

struct VerdictName {
  state::FixVerdict verdict;
  const char* brief;
  const char* whole;
};

constexpr std::array<VerdictName, 6> kVerdicts{
    {{state::FixVerdict::used, "used", "used"},
     {state::FixVerdict::bad_sigma, "bad sigma", "rejected: bad sigma"},
     {state::FixVerdict::gated, "gated", "rejected: too far from the prediction"},
     {state::FixVerdict::corrected, "corrected", "used less an error that lasts"},
     {state::FixVerdict::low_quality, "low quality", "rejected: quality too low"},
     {state::FixVerdict::out_of_order, "out of order", "rejected: out of order"}}};

const VerdictName& name_of(state::FixVerdict verdict) {
  return *std::find_if(kVerdicts.begin(), kVerdicts.end() - 1,
                       [verdict](const VerdictName& name) { return name.verdict == verdict; });
}

size_t rejected_fixes(const RunData& data) {
  return fixes(data) - count_of(data, state::FixVerdict::used) -
         count_of(data, state::FixVerdict::corrected);
}

std::string rejection_text(const RunData& data) {
  std::vector<std::string> kinds;
  for (const state::FixVerdict verdict : kRejections) {
    const size_t count = count_of(data, verdict);
    if (count > 0 && verdict != state::FixVerdict::corrected)
      kinds.push_back(fmt::format("{} {}", count, name_of(verdict).brief));
  }
  const size_t rejected = rejected_fixes(data);
  return fmt::format("{} of {} rejected ({})", rejected, plural(fixes(data), "fix", "fixes"),
                     joined(kinds, ", "));
}

/// Gaps between used fixes that were not asked for.
std::vector<Interval> unasked_gaps(const RunData& data) {
  std::vector<Interval> gaps;
  for (const Shade& shade : time_shades(data)) {
    if (shade.ink == Ink::orange) gaps.push_back({shade.begin, shade.end});
  }
  return gaps;
}

double total_length(const std::vector<Interval>& intervals) {
  double sum = 0;
  for (const Interval& interval : intervals) sum += interval.length();
  return sum;
}

size_t notices_of(const RunData& data, state::NoticeKind kind) {
  return static_cast<size_t>(
      std::count_if(data.notices.begin(), data.notices.end(),
                    [kind](const state::Notice& n) { return n.kind == kind; }));
}

std::vector<std::string> happenings(const RunData& data) {
  std::vector<std::string> parts;
  if (rejected_fixes(data) > 0) parts.push_back(rejection_text(data));
  if (const size_t count = count_of(data, state::FixVerdict::corrected); count > 0) {
    parts.push_back(plural(count, "fix", "fixes") + " used less an error that lasts");
  }
  const std::vector<Interval> gaps = unasked_gaps(data);
  if (!gaps.empty()) {
    parts.push_back(fmt::format("{} s without a usable fix in {}",
                                significant_text(total_length(gaps)),
                                plural(gaps.size(), "stretch", "stretches")));
  }
  if (const ImuGaps imu = data.imu_gaps(); imu.count > 0) {
    parts.push_back(fmt::format("{} s without IMU in {}", significant_text(imu.duration),
                                plural(imu.count, "hole", "holes")));
  }
  const size_t realigned = notices_of(data, state::NoticeKind::realigned);
  if (realigned > 0) parts.push_back(plural(realigned, "new alignment", "new alignments"));
  const size_t others = data.notices_seen - realigned -
                        notices_of(data, state::NoticeKind::aligned) -
                        notices_of(data, state::NoticeKind::imu_gap);
  if (others > 0) parts.push_back(plural(others, "notice", "notices"));
  return parts;
}

std::string summary(const RunData& data) {
  const std::vector<std::string> parts = happenings(data);
  if (!parts.empty()) return joined(parts, "; ") + ".";
  return fmt::format(
      "Nothing happened: all {} were used, none was missing, and the IMU has no hole.",
      plural(fixes(data), "fix", "fixes"));
}

Table notice_table(const RunData& data) {
  Table table;
  table.title = "What happened on the way";
  table.of_words = true;
  table.header = {"Time since start", "Event", "Detail", "UTC", "GPS second"};
  std::vector<state::Notice> notices = data.notices;
  std::stable_sort(notices.begin(), notices.end(),
                   [](const state::Notice& a, const state::Notice& b) { return a.t_ns < b.t_ns; });
  for (const state::Notice& notice : notices) {
    const double t = seconds_between(data.start_ns().value_or(notice.t_ns), notice.t_ns);
    table.rows.push_back({number_text(t, 2) + " s", notice_name(notice.kind), notice.text,
                          utc_text(notice.t_ns), gps_second_text(notice.t_ns)});
  }
  if (data.notices_seen > data.notices.size()) {
    table.note = fmt::format("{} more.", data.notices_seen - data.notices.size());
  }
  return table;
}

// ---- lanes

/// From what is below to what is above.
std::vector<Lane> lanes(const RunData& data) {
  std::vector<Lane> result;
  for (auto verdict = kRejections.rbegin(); verdict != kRejections.rend(); ++verdict) {
    const size_t count = count_of(data, *verdict);
    if (count == 0) continue;
    result.push_back({fmt::format("{} ({})", name_of(*verdict).brief, count),
                      name_of(*verdict).brief, Ink::vermillion,
                      data.verdict_stretches.at(*verdict).intervals()});
  }
  const size_t used = count_of(data, state::FixVerdict::used);
  if (used > 0) {
    result.push_back({fmt::format("fixes used ({})", used), "used", Ink::blue,
                      data.verdict_stretches.at(state::FixVerdict::used).intervals()});
  }
  return result;
}

/// The stretches between the holes.
std::vector<Interval> imu_stretches(const RunData& data) {
  const StepWatch& imu = data.imu_steps;
  std::vector<Interval> stretches;
  double begin = imu.first();
  for (const Interval& gap : data.imu_gaps().longest) {
    stretches.push_back({begin, gap.begin});
    begin = gap.end;
  }
  stretches.push_back({begin, imu.last()});
  return stretches;
}

/// Notices from outside the recording are drawn at its ends.
Series event_marks(const RunData& data, const EventStyle& style, const Interval& whole,
                   double level) {
  Series marks = points(style.name, style.ink, 8.5, {}, {});
  marks.shape = style.shape;
  for (const state::Notice& notice : data.notices) {
    if (notice.kind != style.kind) continue;
    const double t = seconds_between(data.start_ns().value_or(notice.t_ns), notice.t_ns);
    marks.x.push_back(std::clamp(t, whole.begin, whole.end));
    marks.y.push_back(level);
  }
  return marks;
}

void add_events(const RunData& data, std::string_view lane, const Interval& whole, Panel& panel) {
  const double level = static_cast<double>(panel.y.categories.size());
  bool any = false;
  for (const EventStyle& style : kEvents) {
    if (style.lane != lane) continue;
    Series marks = event_marks(data, style, whole, level);
    if (marks.x.empty()) continue;
    panel.series.push_back(std::move(marks));
    any = true;
  }
  if (any) panel.y.categories.emplace_back(lane);
}

/// Holes of the IMU are seen in its lane.
void remove_imu_shades(Panel& panel) {
  panel.shades.erase(std::remove_if(panel.shades.begin(), panel.shades.end(),
                                    [](const Shade& shade) { return shade.ink == Ink::purple; }),
                     panel.shades.end());
}

std::optional<Figure> timeline_figure(const RunData& data, const std::string& subtitle) {
  const Interval whole = whole_run(data);
  if (!(whole.length() > 0)) return std::nullopt;
  Panel panel = time_panel(data, {});
  remove_imu_shades(panel);
  panel.y.kind = AxisKind::category;
  for (const std::string_view lane : {kNotices, kAlignment}) add_events(data, lane, whole, panel);
  for (const Lane& lane : lanes(data)) add_lane(lane, panel);
  if (data.imu_steps.stamps() > 1) {
    add_lane({"IMU", "IMU", Ink::gray, imu_stretches(data)}, panel);
  }
  Figure figure{
      "timeline", "Timeline", subtitle,
      "What there was and what became of it: IMU samples, fixes that were used and, if any, those "
      "that were left out, by reason; below, what was noticed (see the table). A healthy recording "
      "shows bars without gaps and nothing in vermillion. Of more than a thousand stretches of a "
      "lane those next to each other are drawn as one."};
  figure.height_mm = 36 + kLaneHeight * static_cast<double>(panel.y.categories.size());
  figure.panels = {std::move(panel)};
  return figure;
}

}  // namespace

std::string verdict_name(state::FixVerdict verdict) { return name_of(verdict).whole; }

Section timeline_section(const RunData& data, const std::string& subtitle) {
  Section section{"Timeline"};
  if (std::optional<Figure> figure = timeline_figure(data, subtitle)) {
    section.paragraphs.push_back(summary(data));
    section.figures.push_back(std::move(*figure));
  }
  if (!data.notices.empty()) section.details.push_back(notice_table(data));
  return section;
}

}  // namespace foucault::content
