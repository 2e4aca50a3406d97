#include "foucault/evaluation/method_outages.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "foucault/core/time.h"

namespace foucault::evaluation {
namespace {

void add_unless_nan(double value, Sum& sum) {
  if (!std::isnan(value)) sum.add(value);
}

void add_near(const OutageDrift& drift, double at_s, MethodOutages::AtTime& to) {
  const DriftSample* sample = sample_near(drift.samples, at_s);
  if (!sample) return;
  to.after_s.add(at_s);
  add_unless_nan(sample->normalized.horizontal, to.horizontal);
  add_unless_nan(sample->normalized.vertical, to.vertical);
}

}  // namespace

const std::vector<double>& normalized_marks_s() {
  static const std::vector<double> marks{5, 15, 30, 60};
  return marks;
}

MethodOutages::MethodOutages(std::string group_name, std::string method_name,
                             std::vector<double> horizontal_max_m,
                             std::vector<double> vertical_max_m)
    : group(std::move(group_name)),
      method(std::move(method_name)),
      kept_(std::make_shared<Kept>(
          Kept{std::move(horizontal_max_m), std::move(vertical_max_m), {}, {}})) {}

void MethodOutages::add(const OutageDrift& drift) {
  const double length_s = seconds_between(drift.outage.begin_ns, drift.outage.end_ns);
  shortest_s = empty() ? length_s : std::min(shortest_s, length_s);
  longest_s = std::max(longest_s, length_s);
  kept_->horizontal_max.push_back(drift.maximum.horizontal);
  kept_->vertical_max.push_back(drift.maximum.vertical);
  kept_->distance_m.push_back(drift.distance_m);
  at_marks.resize(std::max(at_marks.size(), drift.at_marks.size()));
  for (std::size_t i = 0; i < drift.at_marks.size(); ++i) {
    if (!drift.at_marks[i]) continue;
    at_marks[i].horizontal.add(drift.at_marks[i]->horizontal * drift.at_marks[i]->horizontal);
    at_marks[i].vertical.add(drift.at_marks[i]->vertical * drift.at_marks[i]->vertical);
  }
  const std::vector<double>& marks_s = normalized_marks_s();
  for (std::size_t i = 0; i < marks_s.size(); ++i) add_near(drift, marks_s[i], normalized[i]);
  add_near(drift, length_s / 2, normalized.back());
  if (!drift.after_return) return;
  const ReturnError& error = *drift.after_return;
  returned_m2.add(error.rms * error.rms);
  largest_return_m = std::max(largest_return_m, error.maximum);
  if (error.settled_s) kept_->settled_s.push_back(*error.settled_s);
}

}  // namespace foucault::evaluation
