#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "foucault/page/report_page.h"

/// Figures and page of an evaluation of outages, from plain results. A case is what methods are
/// compared on: an IMU with all its recordings and shifts, or one recording.
namespace foucault::content {

/// The errors of one method in one outage.
struct OutageCurve {
  std::string label;                  ///< e.g. "trip, shift 75 s, outage 3"
  std::vector<double> since_begin_s;  ///< increasing
  std::vector<double> horizontal_m;
  std::vector<double> vertical_m;  ///< absolute
  std::vector<double> north_m;     ///< of the horizontal error
  std::vector<double> east_m;
  double max_horizontal_m = 0;
  double max_vertical_m = 0;
};

/// All outages of a case by one method; the same outages in the same order for every method.
struct MethodCurves {
  std::string method;
  std::vector<OutageCurve> outages;
};

struct DriftCase {
  std::string name;  ///< e.g. "ADIS16465"
  std::vector<MethodCurves> methods;
  std::size_t all = 0;  ///< outages for which these stand, if they are not all
};

/// A number with its interval (bootstrap, 95 %).
struct Bounded {
  double value = 0;
  double low = 0;
  double high = 0;
};

/// RMS over outages of the maximum drift, an entry of Table III.
struct DriftRms {
  std::string case_name;
  std::string method;
  Bounded horizontal_m;
  Bounded vertical_m;
};

/// A stretch of time [s since the start of the recording].
struct TimeSpan {
  double begin_s = 0;
  double end_s = 0;
};

/// Horizontal error of the methods over one recording. Not finite: a gap.
struct ErrorTimeline {
  struct Curve {
    std::string method;
    std::vector<double> t_s;
    std::vector<double> horizontal_m;
  };
  std::string name;  ///< of the recording
  std::vector<TimeSpan> outages;
  std::vector<Curve> curves;
  std::string subtitle = {};  ///< also says which shift of the outages is shown
};

/// A path over the ground, relative to a common start [m]. Not finite: a gap.
struct GroundPath {
  std::vector<double> north_m;
  std::vector<double> east_m;
};

/// Truth and, in the outages, the estimates of the methods.
struct OutageMap {
  struct Estimate {
    std::string method;
    GroundPath path;  ///< in outages only, a gap between two
  };
  std::string name;  ///< of the recording
  GroundPath truth;
  GroundPath truth_in_outages;  ///< a gap between two
  std::vector<Estimate> estimates;
  std::string subtitle = {};  ///< as in ErrorTimeline
};

/// Drift against the distance from the start of the recording at which an outage begins.
struct DistanceDrift {
  /// The RMS of the largest drifts of some outages, at their mean distance.
  struct Bin {
    double distance_km = 0;
    Bounded horizontal_m;
    Bounded vertical_m;
  };
  struct Method {
    std::string method;
    std::vector<double> distance_km;  ///< an entry an outage
    std::vector<double> horizontal_m;
    std::vector<double> vertical_m;
    std::vector<Bin> bins;
  };
  std::string name;  ///< of the case
  std::vector<Method> methods;
  std::size_t all = 0;  ///< as in DriftCase; bins are of all
};

/// Errors in outages over their sigmas: mean squares per degree of freedom, 1 if the sigmas are
/// right, each between the ends of the band that then holds it. Not finite: none.
struct NormalizedErrors {
  struct Method {
    std::string method;
    std::vector<Bounded> horizontal;  ///< an entry a time
    std::vector<Bounded> vertical;
  };
  std::string name;                ///< of the case
  std::vector<std::string> times;  ///< in the outage, e.g. "30 s", "middle"
  std::vector<Method> methods;     ///< on the same outages
};

/// Names of methods in the order of their colours; every figure gives a method the same colour.
using MethodOrder = std::vector<std::string>;

/// Each outage a thin line, their RMS a thick one; a column a method, on equal axes (Fig. 3).
plot::Figure drift_curves(const DriftCase& drift_case, const MethodOrder& order);
/// The largest drift of each outage by method, on a logarithmic axis.
plot::Figure maximum_drifts(const DriftCase& drift_case, const MethodOrder& order);
/// Share of the outages with a maximum drift up to x, with marks at 50, 68 and 95 %.
plot::Figure drift_distribution(const DriftCase& drift_case, const MethodOrder& order);
/// RMS over the outages against time, both axes logarithmic.
plot::Figure drift_growth(const DriftCase& drift_case, const MethodOrder& order);
/// The way of the error over the ground in single outages, all at one scale.
plot::Figure outage_errors(const DriftCase& drift_case, const MethodOrder& order);
/// Where the errors are at the end of the outages, with the ellipse that holds 95 % of as many as
/// they spread; a panel a method.
plot::Figure end_errors(const DriftCase& drift_case, const MethodOrder& order);
/// Table III as grouped bars with intervals.
plot::Figure drift_bars(const std::vector<DriftRms>& rms, const MethodOrder& order);
/// Largest drift of each outage and its RMS in bins, on a logarithmic axis.
plot::Figure drift_by_distance(const DistanceDrift& drift, const MethodOrder& order);
/// Mean squares by time in the outage, with their bands, on a logarithmic axis.
plot::Figure normalized_drift(const NormalizedErrors& errors, const MethodOrder& order);
plot::Figure error_timeline(const ErrorTimeline& timeline, const MethodOrder& order);
plot::Figure outage_map(const OutageMap& map, const MethodOrder& order);

/// Objective over a grid of two parameters; `values` row by row, a row a value of y.
struct ParameterMap {
  std::string name;  ///< of the figure's files
  std::string title;
  std::string subtitle;
  std::string x_label;
  std::string y_label;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> values;  ///< not finite: not evaluated
  std::string value_label;
  std::string value_unit;
  std::optional<std::pair<size_t, size_t>> chosen;  ///< column and row of the chosen point
};

plot::Figure parameter_map(const ParameterMap& map);

/// RMS of the largest drifts with everything in use, or without one part.
struct AblationBar {
  std::string method;
  std::string without;  ///< empty: nothing
  double horizontal_m = 0;
  double vertical_m = 0;
};
plot::Figure ablation_bars(const std::vector<AblationBar>& bars, const MethodOrder& order);

/// Everything an evaluation shows.
struct EvaluationReport {
  std::string title = "Outage evaluation";
  std::string subtitle;
  std::vector<page::Link> links;  ///< pages beside this one
  MethodOrder methods;
  std::vector<std::string> remarks;  ///< paragraphs at the top: what was done, what was not
  std::vector<page::KeyNumber> key_numbers;
  std::vector<page::Table> tables;
  std::vector<AblationBar> ablation;
  std::vector<DriftRms> rms;
  std::vector<DriftCase> cases;
  std::vector<DistanceDrift> distances;  ///< if recordings go far enough
  std::vector<page::Table> distance_tables;
  std::vector<NormalizedErrors> normalized;
  std::vector<page::Table> consistency_tables;
  std::vector<ErrorTimeline> timelines;
  std::vector<OutageMap> maps;
  std::vector<page::Listing> listings;
  std::string footer;
};

/// The page: overview with tables and bars, a section a case, consistency, distance, recordings.
page::ReportPage evaluation_page(const EvaluationReport& report);

}  // namespace foucault::content
