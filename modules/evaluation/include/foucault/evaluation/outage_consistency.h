#pragma once

#include <optional>
#include <string>
#include <vector>

#include "foucault/core/consistency.h"
#include "foucault/evaluation/drift_table.h"
#include "foucault/evaluation/method_outages.h"

/// What methods say of their errors in outages, and how they come back from them, pooled over
/// outages.
namespace foucault::evaluation {

/// Mean over outages of NormalizedSquares at one time of each.
struct PooledSquares {
  int64_t outages = 0;
  double mean = 0;  ///< 1 if the covariances are right
  /// Holds the mean with 95 % if they are and the outages are independent. Nearly so are outages
  /// that do not overlap: noise of the IMU makes their drift, what it starts from (biases,
  /// attitude) lasts from one to the next.
  Band band;
};

/// The normalized error at one time of the outages.
struct NormalizedDrift {
  /// In the middle of each outage, where errors of a smoother are largest; else at a mark.
  bool middle = false;
  double after_s = 0;  ///< since the beginning of the outage; of the middles: their mean
  PooledSquares horizontal;
  PooledSquares vertical;
};

/// Those of one method on one group of outages: the marks that outages reach, then the middle.
struct MethodNormalizedDrifts {
  std::string group;
  std::string method;
  std::vector<NormalizedDrift> times;
};

/// An entry a place of a table. Outages without an error within 1 s of a time, or without sigmas,
/// are not counted there. Covariances of withheld fixes are added; a reference counts as exact.
std::vector<MethodNormalizedDrifts> normalized_drifts(const std::vector<MethodOutages>& outages);

/// "30 s" or "middle".
std::string time_text(const NormalizedDrift& drift);

/// The times of all of them, marks first, in order.
std::vector<std::string> times_of(const std::vector<MethodNormalizedDrifts>& methods);

/// A row a group, method and direction, a column a time: the mean, its band and on which side of
/// it the mean lies if not inside.
TextTable normalized_drift_table(const std::vector<MethodNormalizedDrifts>& methods,
                                 const std::string& group_header);

/// The returns of one method from the outages of one group.
struct PooledReturns {
  std::string group;
  std::string method;
  int64_t outages = 0;        ///< that fixes follow
  double rms_horizontal = 0;  ///< [m]; root of the mean over outages of the mean square in each
  double max_horizontal = 0;  ///< [m]
  int64_t never_settled = 0;
  /// Of those that settled [s], see ReturnError; none if none did.
  std::optional<double> median_settled_s, max_settled_s;
};

/// Those without any return are left out.
std::vector<PooledReturns> pooled_returns(const std::vector<MethodOutages>& outages);

TextTable return_table(const std::vector<PooledReturns>& returns, const std::string& group_header);

}  // namespace foucault::evaluation
