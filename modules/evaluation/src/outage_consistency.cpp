#include "foucault/evaluation/outage_consistency.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "foucault/evaluation/statistics.h"

namespace foucault::evaluation {
namespace {

PooledSquares pooled(const Sum& squares, int dof) {
  if (squares.count == 0) return {};
  const Band band = mean_nees_band(dof, static_cast<double>(squares.count));
  return {squares.count, squares.mean(), {band.low / dof, band.high / dof}};
}

std::optional<NormalizedDrift> normalized_drift(const MethodOutages::AtTime& time) {
  if (time.horizontal.count + time.vertical.count == 0) return std::nullopt;
  NormalizedDrift drift;
  drift.horizontal = pooled(time.horizontal, 2);
  drift.vertical = pooled(time.vertical, 1);
  drift.after_s = time.after_s.mean();
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

std::vector<MethodNormalizedDrifts> normalized_drifts(const std::vector<MethodOutages>& outages) {
  std::vector<MethodNormalizedDrifts> methods;
  for (const MethodOutages& o : outages) {
    MethodNormalizedDrifts method{o.group, o.method, {}};
    for (const MethodOutages::AtTime& time : o.normalized) {
      std::optional<NormalizedDrift> drift = normalized_drift(time);
      if (!drift) continue;
      drift->middle = &time == &o.normalized.back();
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
    if (o.returned_m2.count == 0) continue;
    PooledReturns returns;
    returns.group = o.group;
    returns.method = o.method;
    returns.outages = o.returned_m2.count;
    returns.rms_horizontal = std::sqrt(o.returned_m2.mean());
    returns.max_horizontal = o.largest_return_m;
    returns.never_settled = returns.outages - static_cast<int64_t>(o.settled_s().size());
    if (!o.settled_s().empty()) {
      returns.median_settled_s = quantile(o.settled_s(), 0.5);
      returns.max_settled_s = quantile(o.settled_s(), 1);
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
