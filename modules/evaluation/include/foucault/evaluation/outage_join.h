#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "foucault/evaluation/experiment.h"
#include "foucault/evaluation/method_outages.h"

namespace foucault::evaluation {

/// The names of runs that are to be joined, made when they are needed: they may be a million. Those
/// that are compared (all methods on one recording with one shift) follow each other.
struct RunNames {
  std::size_t size = 0;
  std::function<RunName(std::size_t index)> at;
};

/// What runs are joined by: those of one IMU, of one recording, or all.
enum class Grouping { imu, recording, all };

/// Joins the outages of runs as tables show them, while results come and go. An outage that a
/// method of a group misses is left out for all of them.
class OutageJoin {
 public:
  /// draws: gives MethodOutages::drawn, too; half a million samples at most, 24 MB.
  OutageJoin(const RunNames& names, Grouping grouping, bool draws = true);

  /// All runs that are compared, with one recording and shift.
  void add(const std::vector<const ExperimentResult*>& compared);

  /// Groups and methods in order of appearance, groups first.
  std::vector<MethodOutages> take();

 private:
  using Group = std::vector<MethodOutages>;  ///< a method each

  Group& group_of(const RunName& name);
  void add(const std::vector<const OutageDrift*>& drifts,
           const std::vector<const ExperimentResult*>& results, Group& group);
  void thin_out();

  Grouping grouping_;
  std::vector<Group> groups_;
  std::map<std::string, std::size_t> places_;  ///< of groups, by name
  std::size_t drawn_samples_ = 0;
  uint64_t drawn_share_;  ///< of the hashes of outages, from 0 on
};

/// Those with one recording and shift together, in order of appearance.
std::vector<std::vector<const ExperimentResult*>> compared_results(
    const std::vector<ExperimentResult>& results);

/// Of results in any order.
std::vector<MethodOutages> group_outages(const std::vector<ExperimentResult>& results,
                                         Grouping grouping);

}  // namespace foucault::evaluation
