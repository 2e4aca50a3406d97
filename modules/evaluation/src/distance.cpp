#include "foucault/evaluation/distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "foucault/core/round_step.h"

namespace foucault::evaluation {
namespace {

constexpr std::size_t kFewestInBin = 4;
constexpr double kUsualInBin = 6;
constexpr double kFewestBins = 2;
constexpr double kMostBins = 8;

std::size_t count_finite(const std::vector<double>& values) {
  return static_cast<std::size_t>(
      std::count_if(values.begin(), values.end(), [](double v) { return std::isfinite(v); }));
}

double largest_finite(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) {
    if (std::isfinite(value)) largest = std::max(largest, value);
  }
  return largest;
}

std::vector<DistanceBin> even_bins(const std::vector<double>& distances_km, double step_km) {
  const auto count = static_cast<std::size_t>(largest_finite(distances_km) / step_km) + 1;
  std::vector<DistanceBin> bins(count);
  for (std::size_t i = 0; i < count; ++i) {
    bins[i].from_km = static_cast<double>(i) * step_km;
    bins[i].to_km = static_cast<double>(i + 1) * step_km;
  }
  for (std::size_t i = 0; i < distances_km.size(); ++i) {
    if (!std::isfinite(distances_km[i])) continue;
    bins[static_cast<std::size_t>(distances_km[i] / step_km)].outages.push_back(i);
  }
  return bins;
}

void append(DistanceBin& bin, const DistanceBin& next) {
  bin.to_km = next.to_km;
  bin.outages.insert(bin.outages.end(), next.outages.begin(), next.outages.end());
  std::sort(bin.outages.begin(), bin.outages.end());
}

/// Joins neighbours until each has enough; what is left over at the end joins the last.
std::vector<DistanceBin> joined(const std::vector<DistanceBin>& bins) {
  std::vector<DistanceBin> result;
  for (const DistanceBin& bin : bins) {
    if (!result.empty() && result.back().outages.size() < kFewestInBin) {
      append(result.back(), bin);
    } else {
      result.push_back(bin);
    }
  }
  if (result.size() > 1 && result.back().outages.size() < kFewestInBin) {
    const DistanceBin last = result.back();
    result.pop_back();
    append(result.back(), last);
  }
  return result;
}

std::vector<double> chosen(const std::vector<double>& values, const DistanceBin& bin) {
  std::vector<double> picked;
  for (const std::size_t i : bin.outages) picked.push_back(values[i]);
  return picked;
}

std::vector<double> distances_km(const MethodOutages& outages) {
  std::vector<double> distances = outages.distance_m();
  for (double& distance : distances) distance *= 1e-3;
  return distances;
}

BinDrift bin_drift(const MethodOutages& first, const MethodOutages& method,
                   const DistanceBin& bin) {
  const std::vector<double> horizontal = chosen(method.horizontal_max(), bin);
  const std::vector<double> vertical = chosen(method.vertical_max(), bin);
  BinDrift drift;
  drift.method = method.method;
  drift.horizontal_m = summarize(horizontal).rms;
  drift.vertical_m = summarize(vertical).rms;
  drift.horizontal_relative =
      compare_paired(chosen(first.horizontal_max(), bin), horizontal).relative;
  drift.vertical_relative = compare_paired(chosen(first.vertical_max(), bin), vertical).relative;
  return drift;
}

DistanceProfile profile_of(const std::vector<const MethodOutages*>& methods) {
  const std::vector<double> distances = distances_km(*methods.front());
  DistanceProfile profile{methods.front()->group, {}};
  for (const DistanceBin& bin : distance_bins(distances)) {
    ProfileBin of_bin{bin, mean(chosen(distances, bin)), {}};
    for (const MethodOutages* method : methods) {
      of_bin.methods.push_back(bin_drift(*methods.front(), *method, bin));
    }
    profile.bins.push_back(std::move(of_bin));
  }
  return profile;
}

std::string text(const Estimate& e, int decimals) {
  return fmt::format("{:.{}f} [{:.{}f}, {:.{}f}]", e.value, decimals, e.low, decimals, e.high,
                     decimals);
}

/// Three digits, from kilometres to tenths of a millimetre.
std::string metres(const Estimate& e) {
  const double decade = e.value > 0 && std::isfinite(e.value) ? std::log10(e.value) : 0;
  return text(e, std::clamp(2 - static_cast<int>(std::floor(decade)), 0, 4));
}

std::string percent(const Estimate& e) {
  const Estimate shown{100 * e.value, 100 * e.low, 100 * e.high};
  return text(shown, std::abs(shown.value) < 100 ? 2 : 0);
}

/// Methods from the `first`-th of each profile on, in order of appearance.
std::vector<std::string> methods_of(const std::vector<DistanceProfile>& profiles,
                                    std::size_t first) {
  std::vector<std::string> names;
  for (const DistanceProfile& profile : profiles) {
    const std::vector<BinDrift>& methods = profile.bins.front().methods;
    for (std::size_t m = first; m < methods.size(); ++m) {
      if (std::find(names.begin(), names.end(), methods[m].method) == names.end()) {
        names.push_back(methods[m].method);
      }
    }
  }
  return names;
}

/// What the cells of a table show of a method in a bin.
struct Shown {
  std::string (*text)(const Estimate&);
  Estimate BinDrift::*horizontal;
  Estimate BinDrift::*vertical;
};

std::string cell(const ProfileBin& bin, const std::string& method, Estimate BinDrift::*number,
                 std::string (*text)(const Estimate&)) {
  const auto found = std::find_if(bin.methods.begin(), bin.methods.end(),
                                  [&](const BinDrift& drift) { return drift.method == method; });
  return found == bin.methods.end() ? "-" : text((*found).*number);
}

TextTable table_of(const std::string& title, const std::vector<DistanceProfile>& profiles,
                   const std::string& group_header, const std::vector<std::string>& methods,
                   const Shown& shown) {
  TextTable table{title, {group_header, "Distance (km)", "Outages", "Direction"}, {}};
  table.header.insert(table.header.end(), methods.begin(), methods.end());
  for (const DistanceProfile& profile : profiles) {
    for (const ProfileBin& bin : profile.bins) {
      for (const bool horizontal : {true, false}) {
        std::vector<std::string> row{
            profile.group, fmt::format("{:g} to {:g}", bin.bin.from_km, bin.bin.to_km),
            fmt::format("{}", bin.bin.outages.size()), horizontal ? "horizontal" : "vertical"};
        for (const std::string& method : methods) {
          row.push_back(
              cell(bin, method, horizontal ? shown.horizontal : shown.vertical, shown.text));
        }
        table.rows.push_back(std::move(row));
      }
    }
  }
  return table;
}

}  // namespace

std::vector<DistanceBin> distance_bins(const std::vector<double>& distances_km) {
  const double farthest = largest_finite(distances_km);
  if (farthest < kFarKm) return {};
  const double count = static_cast<double>(count_finite(distances_km));
  const double bins = std::clamp(std::floor(count / kUsualInBin), kFewestBins, kMostBins);
  return joined(even_bins(distances_km, round_step(farthest / bins)));
}

std::vector<DistanceProfile> distance_profiles(const std::vector<MethodOutages>& outages) {
  std::vector<DistanceProfile> profiles;
  for (std::size_t i = 0; i < outages.size();) {
    std::vector<const MethodOutages*> methods;
    const std::string& group = outages[i].group;
    for (; i < outages.size() && outages[i].group == group; ++i) methods.push_back(&outages[i]);
    DistanceProfile profile = profile_of(methods);
    if (!profile.bins.empty()) profiles.push_back(std::move(profile));
  }
  return profiles;
}

TextTable distance_table(const std::vector<DistanceProfile>& profiles,
                         const std::string& group_header) {
  return table_of("RMS drift in meters by distance from the start", profiles, group_header,
                  methods_of(profiles, 0),
                  {metres, &BinDrift::horizontal_m, &BinDrift::vertical_m});
}

TextTable distance_difference_table(const std::vector<DistanceProfile>& profiles,
                                    const std::string& group_header) {
  const std::string base =
      profiles.empty() ? "" : profiles.front().bins.front().methods.front().method;
  return table_of(fmt::format("Difference of RMS drift from {} in percent", base), profiles,
                  group_header, methods_of(profiles, 1),
                  {percent, &BinDrift::horizontal_relative, &BinDrift::vertical_relative});
}

}  // namespace foucault::evaluation
