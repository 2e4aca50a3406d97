#include "foucault/export/run_metrics_json.h"

#include <string>

#include "foucault/core/units.h"
#include "foucault/export/json_object.h"

namespace foucault::exports {
namespace {

Json north_east_down(const Eigen::Vector3d& v, bool exists) {
  if (!exists) return Object().with("north", nullptr).with("east", nullptr).with("down", nullptr);
  return Object().with("north", v.x()).with("east", v.y()).with("down", v.z());
}

double ratio(int64_t part, int64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

/// Mean over the axes of the share inside 1, 2, 3 sigma; null if there is none.
Json inside_json(const evaluation::InsideSigma& inside) {
  if (inside.samples == 0) return nullptr;
  const Eigen::RowVector3d mean = inside.fraction.colwise().mean();
  return Object().with("1_sigma", mean[0]).with("2_sigma", mean[1]).with("3_sigma", mean[2]);
}

Json gnss_json(const evaluation::GnssMetrics& gnss) {
  const bool exists = gnss.samples > 0;
  const int64_t fixes = gnss.used + gnss.rejected + gnss.corrected;
  const bool compared = gnss.rejected_samples > 0;
  return Object()
      .with("used", gnss.used)
      .with("rejected", gnss.rejected)
      .with("corrected", gnss.corrected)
      .with("rejected_share", json_if(fixes > 0, ratio(gnss.rejected, fixes)))
      .with("rejected_innovation_rms_m", north_east_down(gnss.rejected_innovation_rms_n, compared))
      .with("rejected_mean_nis", json_if(compared, gnss.rejected_mean_nis))
      .with("innovation_rms_m", north_east_down(gnss.innovation_rms_n, exists))
      .with("postfit_rms_m", north_east_down(gnss.postfit_rms_n, exists))
      .with("mean_nis", json_if(exists, gnss.mean_nis))
      .with("samples", gnss.samples);
}

Json reference_json(const evaluation::ReferenceMetrics& reference) {
  return Object()
      .with("horizontal_rmse_m", reference.horizontal_rmse)
      .with("vertical_rmse_m", reference.vertical_rmse)
      .with("roll_rmse_deg", number_or_null(reference.roll_rmse, units::kDegrees))
      .with("pitch_rmse_deg", number_or_null(reference.pitch_rmse, units::kDegrees))
      .with("heading_rmse_deg", number_or_null(reference.heading_rmse, units::kDegrees))
      .with("velocity_rmse_m_s", number_or_null(reference.velocity_rmse))
      .with("position_inside", inside_json(reference.position_inside))
      .with("velocity_inside", inside_json(reference.velocity_inside))
      .with("attitude_inside", inside_json(reference.attitude_inside))
      .with("position_nees", number_or_null(reference.position_nees))
      .with("velocity_nees", number_or_null(reference.velocity_nees))
      .with("attitude_nees", number_or_null(reference.attitude_nees))
      .with("samples", reference.samples);
}

Json square_json(const SquareConsistency& squares) {
  const bool exists = squares.samples > 0;
  const auto number = [exists](double value) { return json_if(exists, value); };
  return Object()
      .with("mean", number(squares.mean))
      .with("mean_low", number(squares.mean_band.low))
      .with("mean_high", number(squares.mean_band.high))
      .with("inside_95", number(squares.inside_share))
      .with("samples", squares.samples)
      .with("effective_samples", number(squares.effective_samples));
}

Json stretches_json(const StretchConsistency& s) {
  return Object()
      .with("fixes_each", kRunningMeanFixes)
      .with("count", s.stretches)
      .with("above_3_sigma", s.too_large)
      .with("worst", json_if(s.stretches > 0, s.worst));
}

Json predictions_json(const std::vector<PredictionConsistency>& predictions) {
  Json json = Json::array();
  for (const PredictionConsistency& p : predictions) {
    json.push_back(Object()
                       .with("after_s", p.ahead_s)
                       .with("mean_nis", p.mean_nis)
                       .with("mean_low", p.mean_band.low)
                       .with("mean_high", p.mean_band.high)
                       .with("samples", p.samples));
  }
  return json;
}

Json residual_json(const ResidualStatistics& s) {
  if (s.samples == 0) return nullptr;
  return Object()
      .with("mean", s.mean)
      .with("sigma", s.sigma)
      .with("excess_kurtosis", number_or_null(s.excess_kurtosis))
      .with("inside_1_sigma", s.inside[0])
      .with("inside_2_sigma", s.inside[1])
      .with("inside_3_sigma", s.inside[2]);
}

Json autocorrelation_json(const ResidualAutocorrelation& a) {
  if (a.lag.empty()) return nullptr;
  return Object()
      .with("lags", a.lag.size())
      .with("interval_s", a.interval_s)
      .with("white_bound", a.white_bound)
      .with("outside_share", a.outside_share)
      .with("lag_1", north_east_down(a.lag.front(), true));
}

Json consistency_json(const Consistency& c) {
  Json json = Object()
                  .with("bound_low", c.single_band.low)
                  .with("bound_high", c.single_band.high)
                  .with("nis", square_json(c.nis))
                  .with("stretches", stretches_json(c.stretches))
                  .with("horizons", predictions_json(c.predictions))
                  .with("whitened_innovation", Object()
                                                   .with("north", residual_json(c.innovations[0]))
                                                   .with("east", residual_json(c.innovations[1]))
                                                   .with("down", residual_json(c.innovations[2])))
                  .with("autocorrelation", autocorrelation_json(c.autocorrelation));
  if (c.position_nees) json["position_nees"] = square_json(*c.position_nees);
  if (c.velocity_nees) json["velocity_nees"] = square_json(*c.velocity_nees);
  if (c.attitude_nees) json["attitude_nees"] = square_json(*c.attitude_nees);
  return json;
}

Json aids_json(const evaluation::Aids& aids) {
  Json json = Json::object();
  for (const auto& [name, aid] : aids) {
    json[name] = Object()
                     .with("used", aid.used)
                     .with("rejected", aid.rejected)
                     .with("mean_nis", json_if(aid.used > 0, aid.mean_nis()));
  }
  return json;
}

Json calibration_json(const std::vector<evaluation::CalibratedBlock>& blocks) {
  Json json = Json::object();
  for (const evaluation::CalibratedBlock& b : blocks)
    json[std::string(b.block.name)] = Object()
                                          .with("value", b.value)
                                          .with("sigma", b.sigma)
                                          .with("unit", std::string(b.block.unit));
  return json;
}

}  // namespace

Json run_metrics_json(const evaluation::RunMetrics& m,
                      const std::vector<evaluation::CalibratedBlock>& calibration) {
  Json json = Object()
                  .with("epochs", m.epochs)
                  .with("duration_s", m.duration_s)
                  .with("trustworthy", m.trust.trustworthy)
                  .with("reasons", m.trust.reasons)
                  .with("gnss", gnss_json(m.gnss))
                  .with("aids", aids_json(m.aids))
                  .with("calibration", calibration_json(calibration));
  if (m.reference) json["reference"] = reference_json(*m.reference);
  if (m.reference_elsewhere_m) json["reference_elsewhere_m"] = *m.reference_elsewhere_m;
  json["consistency"] = consistency_json(m.consistency);
  return json;
}

Json separation_json(const evaluation::SeparationMetrics& separation) {
  const bool exists = separation.samples > 0;
  const Eigen::Vector3d euler_deg = units::kDegrees * separation.euler_rms;
  return Object()
      .with("position_rms_m", north_east_down(separation.position_rms_n, exists))
      .with("velocity_rms_m_s", north_east_down(separation.velocity_rms_n, exists))
      .with("roll_rms_deg", json_if(exists, euler_deg[0]))
      .with("pitch_rms_deg", json_if(exists, euler_deg[1]))
      .with("heading_rms_deg", json_if(exists, euler_deg[2]))
      .with("position_size", json_if(exists, separation.position_size))
      .with("velocity_size", json_if(exists, separation.velocity_size))
      .with("attitude_size", json_if(exists, separation.attitude_size))
      .with("samples", separation.samples);
}

}  // namespace foucault::exports
