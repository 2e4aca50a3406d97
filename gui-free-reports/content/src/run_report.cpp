#include "foucault/content/run_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "aids_section.h"
#include "calibration_section.h"
#include "consistency_section.h"
#include "figure_list.h"
#include "foucault/core/fix_quality.h"
#include "foucault/plot/text.h"
#include "processing_section.h"
#include "run_data.h"
#include "run_figures.h"
#include "run_panels.h"
#include "sensor_figures.h"
#include "statistics_tables.h"
#include "timeline_section.h"

namespace foucault::content {

using namespace plot;
using namespace page;

namespace {

Table fix_table(const RunData& data) {
  Table table;
  table.title = "GNSS fixes";
  table.header = {"", "Count"};
  for (const auto& [quality, count] : data.qualities) {
    table.rows.push_back({std::string(words_of(quality)), std::to_string(count)});
  }
  for (const auto& [verdict, count] : data.verdicts) {
    table.rows.push_back({verdict_name(verdict), std::to_string(count)});
  }
  return table;
}

std::vector<std::string> sampling_row(const char* name, const StepWatch& watch) {
  return {name,
          std::to_string(watch.stamps()),
          significant_text(watch.rate(), 4) + " Hz",
          significant_text(watch.longest()) + " s",
          std::to_string(watch.gaps()),
          significant_text(watch.gap_duration()) + " s"};
}

/// Samples that were there and left out are missing, too.
std::vector<std::string> imu_sampling_row(const RunData& data) {
  const StepFacts facts = imu_step_facts(data);
  std::vector<std::string> row = sampling_row("IMU samples", data.imu_steps);
  row[3] = significant_text(facts.longest) + " s";
  row[4] = std::to_string(facts.gaps);
  row[5] = significant_text(facts.gap_duration) + " s";
  return row;
}

Table sampling_table(const RunData& data) {
  Table table;
  table.title = "Sampling";
  table.header = {"", "Count", "Rate", "Longest interval", "Gaps", "Time in gaps"};
  if (data.imu_steps.stamps() > 1) {
    table.rows.push_back(imu_sampling_row(data));
  }
  if (data.fix_steps.stamps() > 1) {
    table.rows.push_back(sampling_row("Used GNSS fixes", data.fix_steps));
  }
  if (data.epoch_steps.stamps() > 1) {
    table.rows.push_back(sampling_row("Epochs of the solution", data.epoch_steps));
  }
  table.note =
      "A gap is longer than five usual intervals and than 0.2 s (IMU), 4 s (GNSS), 3 s "
      "(epochs); samples that were left out make one, too.";
  return table;
}

void add_if(const std::optional<Figure>& figure, Section& section) {
  if (figure) section.figures.push_back(*figure);
}

bool has_content(const Section& section) {
  return !section.tables.empty() || !section.figures.empty() || !section.details.empty();
}

}  // namespace

class RunReport::Collector {
 public:
  Collector(RunLabels run_labels, const state::Mounting& mounting, const state::Told& told)
      : labels(std::move(run_labels)), data(mounting, told) {}

  std::string subtitle() const {
    return joined({labels.recording, labels.method,
                   data.start_ns() ? "start " + clock_text(*data.start_ns()) : std::string()},
                  " · ");
  }

  Section overview() const {
    Section section{"Overview", {}, tables, {}};
    add_if(ground_track(data, subtitle()), section);
    return section;
  }

  Section gnss() const {
    Section section{"GNSS"};
    if (!data.verdicts.empty()) section.tables.push_back(fix_table(data));
    for (const Table& table : innovation_statistics(data)) section.tables.push_back(table);
    add_if(receiver_figure(data, subtitle()), section);
    add_if(innovation_figure(data, subtitle()), section);
    add_if(postfit_figure(data, subtitle()), section);
    return section;
  }

  Section health() const {
    Section section{"Data health"};
    const Table sampling = sampling_table(data);
    if (!sampling.rows.empty()) section.tables.push_back(sampling);
    add_if(data_health_figure(data, subtitle()), section);
    add_if(imu_intervals_figure(data, subtitle()), section);
    add_if(raw_imu_figure(data, subtitle()), section);
    add_if(imu_spectrum_figure(data, subtitle()), section);
    return section;
  }

  Section solution() const {
    Section section{"Solution", {}, {}, solution_figures(data, subtitle())};
    add_if(speed_figure(data, subtitle()), section);
    for (const Figure& figure : vehicle_figures(data, subtitle())) {
      section.figures.push_back(figure);
    }
    return section;
  }

  ReportPage page() const {
    ReportPage page;
    page.title = "Navigation report";
    page.subtitle = subtitle();
    page.links = labels.links;
    page.start_ns = data.start_ns();
    page.banner = banner;
    page.key_numbers = key_numbers;
    for (const Section& section :
         {overview(), timeline_section(data, subtitle()),
          Section{"Errors", error_words(data), error_statistics(data),
                  error_figures(data, subtitle())},
          Section{"Smoothed against forward", separation_words(data), separation_statistics(data),
                  separation_figures(data, subtitle())},
          consistency_section(data, subtitle()), gnss(), aids_section(data, aids, subtitle()),
          calibration_section(data, subtitle()), solution(),
          Section{"Sensor biases", {}, {}, bias_figures(data, subtitle())}, health(),
          processing_section(data, stages, subtitle())}) {
      if (has_content(section)) page.sections.push_back(section);
    }
    if (!page.sections.empty()) {
      page.sections.push_back({"Not shown", {}, {missing_figures(page, data)}});
    }
    if (!labels.command.empty()) page.listings.push_back({"Command", labels.command});
    if (!labels.config.empty()) page.listings.push_back({"Configuration", labels.config});
    page.footer = labels.version;
    return page;
  }

  RunLabels labels;
  RunData data;
  std::optional<Banner> banner;
  std::vector<KeyNumber> key_numbers;
  std::vector<Table> tables;
  std::vector<AidSummary> aids;
  std::vector<StageTime> stages;
};

RunReport::RunReport(RunLabels labels, const state::Mounting& mounting, const state::Told& told)
    : collector_(std::make_unique<Collector>(std::move(labels), mounting, told)) {}

RunReport::~RunReport() = default;

void RunReport::start(int64_t t_ns) { collector_->data.start(t_ns); }

void RunReport::start_statistics(int64_t t_ns) { collector_->data.start_statistics(t_ns); }

void RunReport::epoch(const state::Epoch& epoch) { collector_->data.add(epoch); }

void RunReport::fix(const state::FixResult& fix) { collector_->data.add(fix); }

void RunReport::observation(const state::ObservationResult& result) {
  collector_->data.add(result);
}

void RunReport::notice(const state::Notice& notice) { collector_->data.add(notice); }

void RunReport::reference_error(const state::Epoch& epoch, const state::ReferenceError& error) {
  collector_->data.add(epoch, error);
}

void RunReport::forward_epoch(const state::Epoch& epoch) { collector_->data.add_forward(epoch); }

void RunReport::separation(const state::Separation& separation) {
  collector_->data.add(separation);
}

void RunReport::normalized_square(const NormalizedSquare& square) { collector_->data.add(square); }

void RunReport::consistency(const Consistency& consistency) {
  collector_->data.consistency = consistency;
}

void RunReport::aid(const AidSummary& aid) { collector_->aids.push_back(aid); }

void RunReport::measurement(const Measurement& measurement) { collector_->data.add(measurement); }

void RunReport::imu_stamp(int64_t t_ns) { collector_->data.add_imu_stamp(t_ns); }

void RunReport::outage(int64_t begin_ns, int64_t end_ns) {
  collector_->data.add_outage(begin_ns, end_ns);
}

void RunReport::solve(const Solve& solve) { collector_->data.add(solve); }

void RunReport::stages(const std::vector<StageTime>& stages) { collector_->stages = stages; }

void RunReport::banner(const Banner& banner) { collector_->banner = banner; }

void RunReport::key_number(const KeyNumber& number) { collector_->key_numbers.push_back(number); }

void RunReport::table(const Table& table) { collector_->tables.push_back(table); }

ReportPage RunReport::page() const { return collector_->page(); }

void RunReport::write(const std::string& folder) const { write_report(page(), folder); }

}  // namespace foucault::content
