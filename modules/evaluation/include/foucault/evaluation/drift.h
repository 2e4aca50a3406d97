#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "foucault/evaluation/outage.h"
#include "foucault/evaluation/return_error.h"
#include "foucault/state/layout.h"
#include "foucault/state/result.h"

/// Drift: what the estimate errs by during an outage.
namespace foucault::evaluation {

/// An error squared by the covariance that was given for it, over its degrees of freedom (2 and 1):
/// 1 in the mean if that is right. Infinite where the estimate was not a number; NaN: no sigmas.
struct NormalizedSquares {
  double horizontal = std::numeric_limits<double>::quiet_NaN();
  double vertical = std::numeric_limits<double>::quiet_NaN();
};

/// Of an error in NED; NaN where the covariance is not positive definite.
NormalizedSquares normalized_squares(const Eigen::Vector3d& error_n,
                                     const Eigen::Matrix3d& covariance_n);

/// Error at one instant of an outage.
struct DriftSample {
  double since_begin_s = 0;
  Eigen::Vector3d error_n = Eigen::Vector3d::Zero();  ///< estimate minus truth, NED [m]
  NormalizedSquares normalized = {};

  double horizontal() const { return error_n.head<2>().norm(); }
  double vertical() const { return std::abs(error_n.z()); }
};

/// Infinite where the estimate was not a number.
struct DriftValue {
  double horizontal = 0;  ///< [m]
  double vertical = 0;    ///< absolute value [m]
};

struct OutageDrift {
  Outage outage;
  DriftValue maximum;  ///< horizontal and vertical need not be at the same instant
  DriftValue end;      ///< of the last sample
  /// At each of the asked times; none where the outage is shorter or nothing was sampled near.
  std::vector<std::optional<DriftValue>> at_marks;
  std::vector<DriftSample> samples;  ///< in order of time
  /// Straight line from the recording's first fix to the first one withheld [m]; NaN: unknown.
  double distance_m = std::numeric_limits<double>::quiet_NaN();
  std::optional<ReturnError> after_return;  ///< none if no fix followed
};

/// Times after the beginning of an outage at which its drift is reported [s].
const std::vector<double>& default_drift_marks_s();

/// Drift at a time after the beginning, linear between the samples on both sides if they are at
/// most 2 s apart.
std::optional<DriftValue> drift_at(const std::vector<DriftSample>& samples, double since_begin_s);

/// Maximum, end and marks of the samples; at least one sample.
OutageDrift outage_drift(const Outage& outage, std::vector<DriftSample> samples,
                         const std::vector<double>& marks_s);

/// The sample nearest to a time after the beginning, at most 1 s from it; null if there is none.
/// Not interpolated: an error between two has another covariance.
const DriftSample* sample_near(const std::vector<DriftSample>& samples, double since_begin_s);

/// An epoch against a fix of its stamp: the antenna as the estimate has it, lever arm and clocks
/// among its slow blocks included, minus the fix, NED; covariance of the former.
struct FixError {
  Eigen::Vector3d error_n = Eigen::Vector3d::Zero();       ///< [m]
  Eigen::Matrix3d covariance_n = Eigen::Matrix3d::Zero();  ///< [m^2]
};
FixError fix_error(const state::Epoch& epoch, const GnssFix& fix, const state::Layout& layout);

/// Collects the errors during outages.
class DriftCollector {
 public:
  explicit DriftCollector(std::vector<double> marks_s = default_drift_marks_s());

  /// In order of stamps.
  void add(const Outage& outage, int64_t t_ns, const Eigen::Vector3d& error_n,
           const NormalizedSquares& normalized = {});

  bool empty() const { return outages_.empty(); }

  /// Outages that ended before `until_ns`, the end of the recording, and were sampled to within
  /// 1 s or a tenth of their length of their end.
  std::vector<OutageDrift> complete(int64_t until_ns) const;

 private:
  struct Samples {
    Outage outage;
    std::vector<DriftSample> samples;
  };

  std::vector<double> marks_s_;
  std::map<int64_t, Samples> outages_;
};

/// Compares epochs with the fix of the same stamp, at the antenna: the truth where there is no
/// reference. Epochs come at any time after their fix, in order of stamps.
class FixTruth {
 public:
  using Callback = std::function<void(const Outage&, const GnssFix&, const state::Epoch&,
                                      const FixError& error)>;

  /// layout: of the epochs.
  explicit FixTruth(Callback callback, const state::Layout& layout = {});

  /// `outage`: the one that the fix belongs to.
  void add(const Outage& outage, const GnssFix& fix);
  void epoch(const state::Epoch& epoch);

 private:
  struct Truth {
    Outage outage;
    GnssFix fix;
  };

  Callback callback_;
  state::Layout layout_;
  std::deque<Truth> waiting_;
};

}  // namespace foucault::evaluation
