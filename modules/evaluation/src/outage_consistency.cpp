#include "foucault/evaluation/outage_consistency.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "foucault/core/time.h"
#include "foucault/evaluation/statistics.h"

namespace foucault::evaluation {
namespace {

/// A time within an outage, since its beginning [s].
using TimeOf = std::function<double(const Outage&)>;

double middle_of(const Outage& outage) {
  return seconds_between(outage.begin_ns, outage.end_ns) / 2;
}

PooledSquares pooled(const std::vector<const DriftSample*>& samples,
                     double NormalizedSquares::*component, int dof) {
  std::vector<double> squares;
  for (const DriftSample* sample : samples) {
    const double square = sample->normalized.*component;
    if (!std::isnan(square)) squares.push_back(square);
  }
  if (squares.empty()) return {};
  const Band band = mean_nees_band(dof, static_cast<double>(squares.size()));
  return {static_cast<int64_t>(squares.size()), mean(squares), {band.low / dof, band.high / dof}};
}

std::optional<NormalizedDrift> normalized_drift(const MethodOutages& outages, const TimeOf& time) {
  std::vector<const DriftSample*> samples;
  double sum_s = 0;
  for (const MethodOutages::Entry& entry : outages.entries) {
    const double at_s = time(entry.drift->outage);
    const DriftSample* sample = sample_near(entry.drift->samples, at_s);
    if (!sample) continue;
    samples.push_back(sample);
    sum_s += at_s;
  }
  NormalizedDrift drift;
  drift.horizontal = pooled(samples, &NormalizedSquares::horizontal, 2);
  drift.vertical = pooled(samples, &NormalizedSquares::vertical, 1);
  if (drift.horizontal.outages + drift.vertical.outages == 0) return std::nullopt;
  drift.after_s = sum_s / static_cast<double>(samples.size());
  return drift;
}

std::string square_text(const PooledSquares& squares) {
  if (squares.outages == 0) return "-";
  const Band& band = squares.band;
  return fmt::format("{:.2f} [{:.2f}, {:.2f}]{}", squares.mean, band.low, band.high,
                     band.holds(squares.mean)   ? ""
                     : squares.mean > band.high ? " above"
                                                : " below");
}

std::vector<std::string> normalized_row(const MethodNormalizedDrifts& method,
                                        const std::vector<std::string>& times, bool horizontal) {
  const auto squares = horizontal ? &NormalizedDrift::horizontal : &NormalizedDrift::vertical;
  std::vector<std::string> row{method.group, method.method, horizontal ? "horizontal" : "vertical",
                               fmt::format("{}", (method.times.back().*squares).outages)};
  for (const std::string& time : times) {
    const auto found =
        std::find_if(method.times.begin(), method.times.end(),
                     [&](const NormalizedDrift& drift) { return time_text(drift) == time; });
    row.push_back(found == method.times.end() ? "-" : square_text((*found).*squares));
  }
  return row;
}

std::string seconds_or_dash(const std::optional<double>& seconds) {
  return seconds ? fmt::format("{:.1f}", *seconds) : "-";
}

}  // namespace

const std::vector<double>& normalized_marks_s() {
  static const std::vector<double> marks{5, 15, 30, 60};
  return marks;
}

std::vector<MethodNormalizedDrifts> normalized_drifts(const std::vector<MethodOutages>& outages) {
  std::vector<MethodNormalizedDrifts> methods;
  for (const MethodOutages& o : outages) {
    MethodNormalizedDrifts method{o.group, o.method, {}};
    for (const double mark_s : normalized_marks_s()) {
      const auto drift = normalized_drift(o, [mark_s](const Outage&) { return mark_s; });
      if (drift) method.times.push_back(*drift);
    }
    if (std::optional<NormalizedDrift> drift = normalized_drift(o, middle_of)) {
      drift->middle = true;
      method.times.push_back(*drift);
    }
    if (!method.times.empty()) methods.push_back(std::move(method));
  }
  return methods;
}

std::string time_text(const NormalizedDrift& drift) {
  return drift.middle ? "middle" : fmt::format("{:g} s", drift.after_s);
}

std::vector<std::string> times_of(const std::vector<MethodNormalizedDrifts>& methods) {
  std::vector<std::string> times;
  for (const double mark_s : normalized_marks_s()) times.push_back(fmt::format("{:g} s", mark_s));
  times.emplace_back("middle");
  const auto unknown = [&](const std::string& time) {
    return std::none_of(methods.begin(), methods.end(), [&](const MethodNormalizedDrifts& m) {
      return std::any_of(m.times.begin(), m.times.end(),
                         [&](const NormalizedDrift& d) { return time_text(d) == time; });
    });
  };
  times.erase(std::remove_if(times.begin(), times.end(), unknown), times.end());
  return times;
}

TextTable normalized_drift_table(const std::vector<MethodNormalizedDrifts>& methods,
                                 const std::string& group_header) {
  const std::vector<std::string> times = times_of(methods);
  TextTable table{"Errors in outages over their sigmas: mean square per degree of freedom",
                  {group_header, "Method", "Direction", "Outages"},
                  {}};
  table.header.insert(table.header.end(), times.begin(), times.end());
  for (const MethodNormalizedDrifts& method : methods) {
    for (const bool horizontal : {true, false}) {
      table.rows.push_back(normalized_row(method, times, horizontal));
    }
  }
  return table;
}

std::vector<PooledReturns> pooled_returns(const std::vector<MethodOutages>& outages) {
  std::vector<PooledReturns> all;
  for (const MethodOutages& o : outages) {
    PooledReturns returns;
    returns.group = o.group;
    returns.method = o.method;
    std::vector<double> rms;
    std::vector<double> settled_s;
    for (const MethodOutages::Entry& entry : o.entries) {
      const std::optional<ReturnError>& error = entry.drift->after_return;
      if (!error) continue;
      rms.push_back(error->rms);
      returns.max_horizontal = std::max(returns.max_horizontal, error->maximum);
      if (error->settled_s) settled_s.push_back(*error->settled_s);
    }
    if (rms.empty()) continue;
    returns.outages = static_cast<int64_t>(rms.size());
    returns.rms_horizontal = root_mean_square(rms);
    returns.never_settled = static_cast<int64_t>(rms.size() - settled_s.size());
    if (!settled_s.empty()) {
      returns.median_settled_s = quantile(settled_s, 0.5);
      returns.max_settled_s = quantile(settled_s, 1);
    }
    all.push_back(returns);
  }
  return all;
}

TextTable return_table(const std::vector<PooledReturns>& returns, const std::string& group_header) {
  TextTable table{fmt::format("The first {:g} s after the return of fixes", kReturnWindowS),
                  {group_header, "Method", "Outages", "Horizontal RMS (m)", "Maximum (m)",
                   "Within 3 sigma of a fix after (s), median", "Longest (s)", "Never"},
                  {}};
  for (const PooledReturns& r : returns) {
    table.rows.push_back(
        {r.group, r.method, fmt::format("{}", r.outages), fmt::format("{:.3f}", r.rms_horizontal),
         fmt::format("{:.3f}", r.max_horizontal), seconds_or_dash(r.median_settled_s),
         seconds_or_dash(r.max_settled_s), fmt::format("{}", r.never_settled)});
  }
  return table;
}

}  // namespace foucault::evaluation
