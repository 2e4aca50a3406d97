#include "foucault/evaluation/outage_join.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <tuple>
namespace foucault::evaluation {
namespace {

constexpr std::size_t kMostDrawnSamples = 500'000;  // 24 MB

const std::string& group_name(const RunName& name, Grouping grouping) {
  static const std::string all = "all recordings";
  if (grouping == Grouping::all) return all;
  return grouping == Grouping::imu ? name.imu : name.recording;
}

MethodOutages* of_method(std::vector<MethodOutages>& group, const std::string& method) {
  const auto found = std::find_if(group.begin(), group.end(),
                                  [&](const MethodOutages& o) { return o.method == method; });
  return found == group.end() ? nullptr : &*found;
}

const OutageDrift* find_outage(const ExperimentResult& result, int64_t index) {
  const std::vector<OutageDrift>& drifts = result.run.drifts;
  const auto found = std::find_if(drifts.begin(), drifts.end(), [&](const OutageDrift& drift) {
    return drift.outage.index == index;
  });
  return found == drifts.end() ? nullptr : &*found;
}

/// An outage in all of the results, in their order; empty if one of them lacks it.
std::vector<const OutageDrift*> in_all(const std::vector<const ExperimentResult*>& results,
                                       int64_t index) {
  std::vector<const OutageDrift*> drifts;
  for (const ExperimentResult* result : results) {
    const OutageDrift* drift = find_outage(*result, index);
    if (!drift) return {};
    drifts.push_back(drift);
  }
  return drifts;
}

/// FNV-1a, and a last mix: which outages are drawn has nothing to do with what they are.
uint64_t hash_of(const RunName& name, int64_t index) {
  uint64_t hash = 14695981039346656037u;
  for (const char c : fmt::format("{}\n{}\n{}", name.recording, name.shift_s, index)) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  }
  hash = (hash ^ (hash >> 33)) * 0xff51afd7ed558ccdu;
  return hash ^ (hash >> 33);
}

}  // namespace

OutageJoin::OutageJoin(const RunNames& names, Grouping grouping, bool draws)
    : grouping_(grouping), drawn_share_(draws ? ~uint64_t{0} : 0) {
  for (std::size_t i = 0; i < names.size; ++i) {
    const RunName name = names.at(i);
    const std::string& group = group_name(name, grouping);
    const auto [place, is_new] = places_.emplace(group, groups_.size());
    if (is_new) groups_.emplace_back();
    Group& methods = groups_[place->second];
    if (!of_method(methods, name.method)) methods.emplace_back(group, name.method);
  }
}

OutageJoin::Group& OutageJoin::group_of(const RunName& name) {
  return groups_[places_.at(group_name(name, grouping_))];
}

void OutageJoin::add(const std::vector<const ExperimentResult*>& compared) {
  if (compared.empty()) return;
  Group& group = group_of(*compared.front());
  for (const ExperimentResult* result : compared) {
    MethodOutages& outages = *of_method(group, result->method);
    const auto measured = static_cast<int64_t>(result->run.drifts.size());
    outages.measured += measured;
    outages.missing += std::max<int64_t>(0, result->run.scheduled - measured);
    outages.cpu_s += result->run.cpu_s;
  }
  if (compared.size() != group.size()) return;  // none of these outages has all methods
  for (const OutageDrift& drift : compared.front()->run.drifts) {
    const std::vector<const OutageDrift*> drifts = in_all(compared, drift.outage.index);
    if (!drifts.empty()) add(drifts, compared, group);
  }
}

void OutageJoin::add(const std::vector<const OutageDrift*>& drifts,
                     const std::vector<const ExperimentResult*>& results, Group& group) {
  for (std::size_t i = 0; i < drifts.size(); ++i) {
    of_method(group, results[i]->method)->add(*drifts[i]);
  }
  const RunName& name = *results.front();
  if (hash_of(name, drifts.front()->outage.index) > drawn_share_) return;
  for (std::size_t i = 0; i < drifts.size(); ++i) {
    of_method(group, results[i]->method)
        ->drawn.push_back(
            std::make_shared<DrawnOutage>(DrawnOutage{name.recording, name.shift_s, *drifts[i]}));
    drawn_samples_ += drifts[i]->samples.size();
  }
  while (drawn_samples_ > kMostDrawnSamples) thin_out();
}

/// Leaves about half of those that are drawn, the same ones for each method.
void OutageJoin::thin_out() {
  drawn_share_ /= 2;
  drawn_samples_ = 0;
  for (Group& group : groups_) {
    for (MethodOutages& outages : group) {
      auto& drawn = outages.drawn;
      const auto is_out = [&](const auto& outage) {
        const RunName name{outage->recording, "", "", outage->shift_s};
        return hash_of(name, outage->drift.outage.index) > drawn_share_;
      };
      drawn.erase(std::remove_if(drawn.begin(), drawn.end(), is_out), drawn.end());
      for (const auto& outage : drawn) drawn_samples_ += outage->drift.samples.size();
    }
  }
}

std::vector<MethodOutages> OutageJoin::take() {
  std::vector<MethodOutages> all;
  for (Group& group : groups_) {
    for (MethodOutages& outages : group) all.push_back(std::move(outages));
  }
  groups_.clear();
  return all;
}

std::vector<std::vector<const ExperimentResult*>> compared_results(
    const std::vector<ExperimentResult>& results) {
  std::map<std::tuple<std::string, std::string, double>, std::size_t> places;
  std::vector<std::vector<const ExperimentResult*>> compared;
  for (const ExperimentResult& r : results) {
    const auto [place, is_new] =
        places.emplace(std::tuple(r.recording, r.imu, r.shift_s), compared.size());
    if (is_new) compared.emplace_back();
    compared[place->second].push_back(&r);
  }
  return compared;
}

std::vector<MethodOutages> group_outages(const std::vector<ExperimentResult>& results,
                                         Grouping grouping) {
  OutageJoin join({results.size(), [&](std::size_t i) { return results[i]; }}, grouping);
  for (const auto& compared : compared_results(results)) join.add(compared);
  return join.take();
}

}  // namespace foucault::evaluation
