#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foucault/core/consistency.h"
#include "foucault/core/measurement.h"
#include "foucault/core/profile.h"
#include "foucault/plot/decimation.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/result.h"
#include "foucault/state/separation.h"
#include "foucault/state/told_blocks.h"
#include "imu_spectrum.h"

/// What a run report keeps of a run, in bounded memory. Times in seconds since the first stamp.
namespace foucault::content {

/// What numbers amount to, by axis, and how many are inside three sigma. Quantiles are of the
/// magnitudes: of all of them, of very many of every second, fourth ... one.
class AxisStatistics {
 public:
  void add(const Eigen::Vector3d& value, const Eigen::Vector3d& sigma);

  size_t count() const { return count_; }
  Eigen::Vector3d mean() const;
  Eigen::Vector3d largest() const { return largest_; }
  Eigen::Vector3d quantile(double share) const;
  Eigen::Vector3d rms() const;
  Eigen::Vector3d inside_3_sigma() const;  ///< 0 to 1

 private:
  void keep(const Eigen::Vector3d& magnitude);

  size_t count_ = 0;
  size_t every_ = 1;
  std::vector<Eigen::Vector3d> kept_;
  Eigen::Array3d sum_ = Eigen::Array3d::Zero();
  Eigen::Array3d largest_ = Eigen::Array3d::Zero();
  Eigen::Array3d sum_of_squares_ = Eigen::Array3d::Zero();
  Eigen::Array3d inside_ = Eigen::Array3d::Zero();
};

/// Three components and their standard deviations over time: columns 0-2 and 3-5.
struct Triad {
  plot::DecimatedTable rows{6};
  AxisStatistics statistics;
  double statistics_from = 0;  ///< [s]

  void add(double t, const Eigen::Vector3d& value, const Eigen::Vector3d& sigma);
  bool empty() const { return rows.empty(); }
};

/// A slow block over time, as users know it, in SI units: a column a row, then their sigmas.
struct BlockHistory {
  state::SlowBlock slow;
  Eigen::VectorXd prior, prior_sigma;
  Eigen::VectorXd last, last_sigma;
  plot::DecimatedTable rows;
  plot::DecimatedTable forward;  ///< the same of the forward run of a smoother
};

/// Normalized squares of one kind of measurement over their dimension.
struct SquareHistory {
  plot::DecimatedTable used{1};
  plot::DecimatedTable rejected{1};
};

struct Interval {
  double begin = 0;
  double end = 0;
  double length() const { return end - begin; }
};

/// Stretches of time in which something went on, in bounded memory: if there are too many, those
/// closest to each other are joined, and from then on all that come as close.
class Stretches {
 public:
  void begin(double t);
  /// The last one, if any, reaches at least to t.
  void extend(double t);

  bool empty() const { return intervals_.empty(); }
  /// What began goes on, or something begins.
  void extend_or_begin(double t, bool goes_on) { goes_on ? extend(t) : begin(t); }
  /// In order of their begins.
  std::vector<Interval> intervals() const;

 private:
  void join_closest();

  std::vector<Interval> intervals_;
  double shortest_pause_ = -1;  ///< [s]; stretches closer than that are one
};

/// Watches the steps of a sequence of stamps: how long they are, and which are gaps, that is longer
/// than `least_gap` and than five times the median of the last steps.
class StepWatch {
 public:
  explicit StepWatch(double least_gap) : least_gap_(least_gap) {}

  /// The step that ends at t [s]; none for the first stamp.
  std::optional<double> observe(double t);

  bool last_was_gap() const { return last_was_gap_; }
  /// A longer step would be a gap [s].
  double longest_usual() const;
  size_t stamps() const { return stamps_; }
  double first() const { return first_; }
  double last() const { return last_; }
  size_t gaps() const { return gap_count_; }
  double longest() const { return longest_; }
  double duration() const { return stamps_ > 1 ? last_ - first_ : 0; }
  double gap_duration() const { return gap_duration_; }
  /// Steps a second while there was no gap [Hz].
  double rate() const;
  /// Each step at its begin.
  const plot::DecimatedTable& steps() const { return steps_; }
  /// The longest gaps, at most 64, in order of time.
  std::vector<Interval> longest_gaps() const;

 private:
  double median_step() const;
  void keep_gap(const Interval& gap);

  static constexpr size_t kMemory = 9;

  double least_gap_;
  bool last_was_gap_ = false;
  size_t stamps_ = 0;
  size_t gap_count_ = 0;
  double first_ = 0;
  double last_ = 0;
  double longest_ = 0;
  double gap_duration_ = 0;
  std::array<double, kMemory> recent_{};
  std::vector<Interval> gaps_;
  plot::DecimatedTable steps_{1};
};

/// How often intervals of a length occur, by bins that are evenly spaced on a logarithmic axis.
class IntervalHistogram {
 public:
  void add(double interval);
  /// Corners of the bins from the first to the last that is not empty, and what each holds.
  struct Bins {
    std::vector<double> corner;  ///< one more than counts
    std::vector<int64_t> count;
  };
  Bins bins() const;

 private:
  static constexpr double kShortest = 1e-5;  // [s]
  static constexpr double kPerDecade = 100;
  std::array<int64_t, 700> counts_{};
};

/// Holes in the samples of an IMU, whether they were missing or left out.
struct ImuGaps {
  std::vector<Interval> longest;  ///< in order of time
  size_t count = 0;
  double duration = 0;
};

/// What optimizations came to.
struct SolveTotals {
  int64_t count = 0;
  double nodes = 0, most_nodes = 0;            ///< sum, most of one
  double iterations = 0, most_iterations = 0;  ///< likewise
  double seconds = 0, longest = 0;             ///< likewise
};

/// North and east of a start point along the ellipsoid, and height above it [m]. For drawing: the
/// radii of curvature are those of the middle latitude, good to 1e-5 within 100 km.
class StartPlane {
 public:
  explicit StartPlane(const Geodetic& start) : start_(start) {}
  Eigen::Vector3d north_east_up(const Geodetic& place) const;

 private:
  Geodetic start_;
};

class RunData {
 public:
  RunData(const state::Mounting& mounting, const state::Told& told);

  /// Statistics are over what comes from there on; to be told before.
  void start_statistics(int64_t t_ns);
  double statistics_from() const { return statistics_from_; }  ///< [s]

  void add(const state::Epoch& epoch);
  /// Of the forward run of a smoother.
  void add_forward(const state::Epoch& epoch);
  void add(const state::FixResult& fix);
  void add(const state::ObservationResult& result);
  void add(const state::Notice& notice);
  /// What sensors told, before anything is made of it.
  void add(const Measurement& measurement);
  void add(const state::Epoch& epoch, const state::ReferenceError& error);
  void add(const state::Separation& separation);
  void add(const NormalizedSquare& square);
  void add(const Solve& solve);
  void add_imu_stamp(int64_t t_ns);
  void add_outage(int64_t begin_ns, int64_t end_ns);

  /// Times count from here on; without it, from the first stamp of a measurement or an epoch.
  void start(int64_t t_ns) { start_ns_ = t_ns; }
  std::optional<int64_t> start_ns() const { return start_ns_; }
  /// What north, east and height are relative to: "first fix" or "first epoch".
  const char* origin() const { return origin_; }

  plot::DecimatedTable track{2};             ///< north, east
  plot::DecimatedTable fix_places{3};        ///< north, east, quality; used fixes
  plot::DecimatedTable rejected_places{2};   ///< north, east
  plot::DecimatedTable speed_and_height{2};  ///< [m/s], above the ellipsoid [m]
  plot::DecimatedTable imu_rates{6, 4000};   ///< of b, not corrected [deg/s, m/s^2]
  ImuSpectrum imu_spectrum;                  ///< of the same
  IntervalHistogram imu_intervals;
  plot::DecimatedTable fix_sigmas{3};   ///< that the receiver gives: north, east, down [m]
  plot::DecimatedTable fix_details{3};  ///< satellites, HDOP, age of corrections [s]; NaN: not told
  ImuGaps imu_gaps() const;
  Triad position;             ///< north, east, up of the start [m]
  Triad velocity;             ///< north, east, down [m/s]
  Triad vehicle_velocity;     ///< forward, right, down [m/s]
  Triad attitude;             ///< roll, pitch, heading (continuous) [deg]
  Triad gyro_bias;            ///< x, y, z of b [deg/h]
  Triad accel_bias;           ///< x, y, z of b [mGal]
  Triad position_error;       ///< north, east, down [m]
  Triad velocity_error;       ///< north, east, down [m/s]
  Triad attitude_error;       ///< roll, pitch, heading [deg]
  Triad position_separation;  ///< smoothed less forward, as the errors
  Triad velocity_separation;
  Triad attitude_separation;
  Triad innovation;           ///< used fixes, north, east, down [m]
  Triad rejected_innovation;  ///< as innovation
  Triad postfit;              ///< used fixes; sigma not known
  std::vector<BlockHistory> blocks;
  std::map<std::string, SquareHistory, std::less<>> aids;
  plot::DecimatedTable nis{2};  ///< used fixes: NIS, running mean
  plot::DecimatedTable rejected_nis{1};
  plot::DecimatedTable position_nees{1};
  plot::DecimatedTable velocity_nees{1};
  plot::DecimatedTable attitude_nees{1};
  std::optional<Consistency> consistency;
  plot::DecimatedTable solves{2};  ///< iterations, time [ms]
  SolveTotals solve_totals;
  std::map<FixQuality, size_t> qualities;
  std::map<state::FixVerdict, size_t> verdicts;
  /// Epochs are from fixes on both sides of them.
  bool is_smoothed() const { return !position_separation.empty(); }
  /// What to call the fixes that were not used as they are.
  std::string not_used_name() const;
  std::map<state::FixVerdict, Stretches> verdict_stretches;
  std::map<FixQuality, Stretches> quality_stretches;
  StepWatch imu_steps{0.2};
  StepWatch fix_steps{4.0};  ///< between used fixes
  StepWatch epoch_steps{3.0};
  std::vector<Interval> outages() const;
  std::vector<state::Notice> notices;  ///< the first ones
  size_t notices_seen = 0;

 private:
  struct Stretch {
    int64_t begin_ns = 0;
    int64_t end_ns = 0;
  };

  double seconds(int64_t t_ns);
  Eigen::Vector3d place(const Geodetic& geodetic);
  void mark_gap();
  void add_fix(const GnssFix& fix);
  void add_increment(const ImuIncrement& increment);
  void add_blocks(double t, const state::Epoch& epoch);
  void watch(double t, const state::FixResult& fix);

  state::Mounting mounting_;
  state::Told told_;
  double statistics_from_ = 0;
  std::vector<Stretch> outages_;
  std::optional<int64_t> start_ns_;
  std::optional<StartPlane> plane_;
  const char* origin_ = "first epoch";
  StepWatch all_fix_steps_{4.0};
  std::optional<state::FixVerdict> last_verdict_;
  std::optional<FixQuality> last_quality_;
  std::optional<double> last_imu_;      // [s]
  double last_fix_ = 0;                 // [s], whatever became of it
  std::optional<double> last_heading_;  // [rad], continuous
};

}  // namespace foucault::content
