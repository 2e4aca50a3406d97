#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "foucault/core/consistency.h"
#include "foucault/core/profile.h"
#include "foucault/page/report_page.h"
#include "foucault/state/interfaces.h"
#include "foucault/state/result.h"
#include "foucault/state/separation.h"
#include "foucault/state/told_blocks.h"

namespace foucault::content {

/// What a run was, in words.
struct RunLabels {
  std::string recording;               ///< name of the log
  std::string method;                  ///< e.g. "refined"
  std::string version;                 ///< of the program
  std::string command;                 ///< the command line; may be empty
  std::string config;                  ///< the effective configuration, YAML
  std::vector<page::Link> links = {};  ///< pages beside this one
};

/// What the innovations of one kind of measurement beside positions amount to.
struct AidSummary {
  std::string name;  ///< of the kind, as in metrics.json
  int dimension = 0;
  int64_t used = 0, rejected = 0;
  double mean_nis = 0;  ///< of the used ones; as many as dimensions if their covariances are right
  Band single_band;     ///< holds a normalized square with 95 % if they are
};

/// Collects a run in bounded memory and writes its report: ground track, timeline of faults,
/// errors where there is a reference, smoothed against forward, consistency, GNSS innovations, aids
/// and calibration where there are any, position, velocity, attitude, uncertainty, biases, data
/// health. Calls come in order of stamps within each kind; kinds may interleave in any way.
class RunReport : public state::Sink {
 public:
  /// `told`: of the blocks that are estimated.
  RunReport(RunLabels labels, const state::Mounting& mounting, const state::Told& told = {});
  ~RunReport() override;

  /// The first stamp of the recording: times in the report count from there.
  void start(int64_t t_ns);

  /// Statistics are over what comes from there on: the settling time can be left out.
  void start_statistics(int64_t t_ns);

  void epoch(const state::Epoch& epoch) override;
  void fix(const state::FixResult& fix) override;
  void observation(const state::ObservationResult& result) override;
  void notice(const state::Notice& notice) override;
  /// `epoch` is the one the error belongs to; its covariance gives the bounds.
  void reference_error(const state::Epoch& epoch, const state::ReferenceError& error);

  /// Of a smoother: an epoch of its forward run, in which what is calibrated becomes known.
  void forward_epoch(const state::Epoch& epoch);

  /// Of a smoother: what it made of its forward run.
  void separation(const state::Separation& separation);

  /// Drawn over time if there is a consistency().
  void normalized_square(const NormalizedSquare& square);

  /// What the normalized squares and innovations of the whole run amount to.
  void consistency(const Consistency& consistency);

  /// The kinds of observations that are shown, in this order.
  void aid(const AidSummary& aid);

  /// What sensors told, before an estimator makes something of it.
  void measurement(const Measurement& measurement);

  /// End of an IMU sample's interval, for the sampling statistics; measurement() does it.
  void imu_stamp(int64_t t_ns);

  /// Of a factor graph: an optimization.
  void solve(const Solve& solve);

  /// Where the time went.
  void stages(const std::vector<StageTime>& stages);

  /// A stretch in which fixes were withheld on purpose; shaded in every figure over time.
  void outage(int64_t begin_ns, int64_t end_ns);

  /// Shown above everything else.
  void banner(const page::Banner& banner);

  /// Shown large at the top, in this order.
  void key_number(const page::KeyNumber& number);

  /// Shown under "Overview", in this order.
  void table(const page::Table& table);

  /// The page with all its figures, as plain data.
  page::ReportPage page() const;

  /// Writes `folder`, usually DIR/report. Throws DataError as write_report does.
  void write(const std::string& folder) const;

 private:
  class Collector;
  std::unique_ptr<Collector> collector_;
};

}  // namespace foucault::content
