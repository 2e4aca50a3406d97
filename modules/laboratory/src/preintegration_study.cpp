#include "foucault/laboratory/preintegration_study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "foucault/laboratory/ablated_integrator.h"
#include "foucault/preintegration/preintegrator.h"

namespace foucault::laboratory {
namespace {

using Eigen::Vector3d;

constexpr double kBaseRate = 1000;  ///< [Hz]

struct Ablation {
  LabName name;
  MotionTerms terms;
};

const std::vector<Ablation>& ablations() {
  static const std::vector<Ablation> kAblations = [] {
    std::vector<Ablation> all{{{"none", "nothing"}, {}},
                              {{"coning", "coning"}, {}},
                              {{"sculling", "sculling"}, {}},
                              {{"rotation", "turning within a sample"}, {}},
                              {{"rotation_again", "its second order"}, {}},
                              {{"earth_rotation", "Earth rotation of the attitude"}, {}},
                              {{"coriolis", "Coriolis acceleration"}, {}},
                              {{"gravity_change", "change of gravity along the way"}, {}}};
    all[1].terms.coning = false;
    all[2].terms.sculling = false;
    all[3].terms.rotation = all[3].terms.rotation_again = false;
    all[4].terms.rotation_again = false;
    all[5].terms.earth_rotation = false;
    all[6].terms.coriolis = false;
    all[7].terms.gravity = GravityAlong::start;
    return all;
  }();
  return kAblations;
}

struct Model {
  LabName name;
  preintegration::PreintegrationModel model;
  bool local;  ///< the origin of w is where the interval begins
};

const std::vector<Model>& models() {
  static const std::vector<Model> kModels{
      {{"rough", "rough"}, preintegration::PreintegrationModel::rough, false},
      {{"rough_local", "rough, origin here"}, preintegration::PreintegrationModel::rough, true},
      {{"refined", "refined"}, preintegration::PreintegrationModel::refined, false},
      {{"refined_local", "refined, origin here"},
       preintegration::PreintegrationModel::refined,
       true},
      {{"full", "full"}, preintegration::PreintegrationModel::full, false}};
  return kModels;
}

/// An interval in a frame: the truth at its begin and at every duration.
struct Interval {
  Interval(const simulation::Trajectory& trajectory, const geodesy::LocalFrame& frame_in,
           double begin, const std::vector<double>& durations_s)
      : frame(frame_in), x0(true_state(trajectory, frame, begin)) {
    for (const double T : durations_s) truth.push_back(true_state(trajectory, frame, begin + T));
  }
  geodesy::LocalFrame frame;
  state::NodeState x0;
  std::vector<state::NodeState> truth;
};

/// The trip's frame and the interval's own.
struct Frames {
  Interval trip, local;
};

/// Adds the increments after the first and calls at_mark(i) when durations_s[i] is reached.
template <class Integrator, class AtMark>
void integrate(Integrator& integrator, const std::vector<ImuIncrement>& increments,
               const std::vector<double>& durations_s, const AtMark& at_mark) {
  const int64_t begin = increments.front().t_end_ns;
  std::size_t mark = 0;
  for (std::size_t i = 1; i < increments.size() && mark < durations_s.size(); ++i) {
    integrator.add(increments[i]);
    if (increments[i].t_end_ns == begin + nanoseconds(durations_s[mark])) at_mark(mark++);
  }
}

class IntervalRecorder {
 public:
  IntervalRecorder(const std::vector<double>& durations_s, const Frames& frames, double distance_m,
                   std::vector<LabRow>& rows)
      : durations_s_(durations_s), frames_(frames), distance_m_(distance_m), rows_(rows) {}

  void models(const std::vector<ImuIncrement>& increments, double rate_hz) const {
    preintegration::Preintegrator integrator({}, {}, increments[1].t_begin_ns, increments.front());
    integrate(integrator, increments, durations_s_, [&](std::size_t mark) {
      const preintegration::Preintegration pre = integrator.result();
      for (const Model& m : laboratory::models()) {
        const Interval& seen = m.local ? frames_.local : frames_.trip;
        const preintegration::EarthModel earth =
            preintegration::earth_model(m.model, seen.frame, seen.x0.p_w_b);
        add(LabGroup::model, m.name.key, rate_hz, mark, m.local ? 0 : distance_m_,
            error_of(preintegration::predict(seen.x0, pre, earth), seen.truth[mark]));
      }
    });
    MotionTerms everything;
    everything.gravity = GravityAlong::place;
    reckon(LabGroup::model, "discretization", everything, increments, rate_hz);
  }

  void ablations(const std::vector<ImuIncrement>& increments, double rate_hz) const {
    for (const Ablation& ablation : laboratory::ablations()) {
      reckon(LabGroup::ablation, ablation.name.key, ablation.terms, increments, rate_hz);
    }
  }

  void noise(const std::string& grade, const std::vector<ImuIncrement>& increments,
             double rate_hz) const {
    preintegration::Preintegrator integrator(imu::imu_preset(grade), {}, increments[1].t_begin_ns,
                                             increments.front());
    integrate(integrator, increments, durations_s_, [&](std::size_t mark) {
      const state::NodeMatrix P = integrator.result().covariance;
      const auto sigma = [&P](const state::NodeBlock& b) {
        return std::sqrt(state::part(P, b, b).trace());
      };
      add(LabGroup::noise, grade, rate_hz, mark, distance_m_,
          {sigma(state::block::position), sigma(state::block::velocity),
           sigma(state::block::attitude)});
    });
  }

  /// `refined` with the origin `km` behind the vehicle.
  void distances(const simulation::Trajectory& trajectory, double begin,
                 const std::vector<double>& all_km, const std::vector<ImuIncrement>& increments,
                 double rate_hz) const {
    std::vector<Interval> seen;
    for (const double km : all_km) {
      seen.emplace_back(trajectory, frame_behind(1000 * km), begin, durations_s_);
    }
    preintegration::Preintegrator integrator({}, {}, increments[1].t_begin_ns, increments.front());
    integrate(integrator, increments, durations_s_, [&](std::size_t mark) {
      const preintegration::Preintegration pre = integrator.result();
      for (std::size_t i = 0; i < seen.size(); ++i) {
        const preintegration::EarthModel earth = preintegration::earth_model(
            preintegration::PreintegrationModel::refined, seen[i].frame, seen[i].x0.p_w_b);
        add(LabGroup::distance, "refined", rate_hz, mark, 1000 * all_km[i],
            error_of(preintegration::predict(seen[i].x0, pre, earth), seen[i].truth[mark]));
      }
    });
  }

 private:
  void reckon(LabGroup group, const std::string& name, const MotionTerms& terms,
              const std::vector<ImuIncrement>& increments, double rate_hz) const {
    const Interval& seen = frames_.trip;
    AblatedIntegrator integrator(seen.x0, seen.frame, terms, increments.front());
    integrate(integrator, increments, durations_s_, [&](std::size_t mark) {
      add(group, name, rate_hz, mark, distance_m_, error_of(integrator.state(), seen.truth[mark]));
    });
  }

  geodesy::LocalFrame frame_behind(double metres) const {
    const state::NodeState& x0 = frames_.local.x0;
    const Vector3d ahead = x0.q_w_b * Vector3d::UnitX();
    const Vector3d level(ahead.x(), ahead.y(), 0);
    Geodetic origin = frames_.local.frame.to_geodetic(-metres * level.normalized());
    origin.height = frames_.local.frame.origin().height;
    return geodesy::LocalFrame(origin);
  }

  void add(LabGroup group, const std::string& name, double rate_hz, std::size_t mark,
           double distance_m, const MotionError& error) const {
    rows_.push_back({group, name, rate_hz, durations_s_[mark], distance_m, error});
  }

  const std::vector<double>& durations_s_;
  const Frames& frames_;
  double distance_m_;
  std::vector<LabRow>& rows_;
};

void require_whole_samples(const StudyPlan& plan) {
  for (const double T : plan.durations_s) {
    for (const double rate : plan.rates_hz) {
      if (std::abs(T * rate - std::round(T * rate)) > 1e-9 || T * rate < 0.5) {
        throw std::invalid_argument("laboratory: a duration is no whole number of samples");
      }
    }
  }
}

/// Adds squares; the sums become root mean squares in the end.
void add_squares(const MotionError& error, MotionError& sum) {
  sum.position += error.position * error.position;
  sum.velocity += error.velocity * error.velocity;
  sum.attitude += error.attitude * error.attitude;
}

MotionError root_mean(const MotionError& sum, double count) {
  return {std::sqrt(sum.position / count), std::sqrt(sum.velocity / count),
          std::sqrt(sum.attitude / count)};
}

}  // namespace

MotionError error_of(const state::NodeState& estimate, const state::NodeState& truth) {
  return {(estimate.p_w_b - truth.p_w_b).norm(), (estimate.v_w_b - truth.v_w_b).norm(),
          so3::log(truth.q_w_b.conjugate() * estimate.q_w_b).norm()};
}

const char* group_name(LabGroup group) {
  switch (group) {
    case LabGroup::model:
      return "model";
    case LabGroup::ablation:
      return "ablation";
    case LabGroup::distance:
      return "distance";
    case LabGroup::noise:
      break;
  }
  return "noise";
}

const std::vector<LabName>& lab_models() {
  static const std::vector<LabName> kNames = [] {
    std::vector<LabName> names;
    for (const Model& m : models()) names.push_back(m.name);
    names.push_back({"discretization", "discretization"});
    return names;
  }();
  return kNames;
}

const std::vector<LabName>& lab_ablations() {
  static const std::vector<LabName> kNames = [] {
    std::vector<LabName> names;
    for (const Ablation& a : ablations()) names.push_back(a.name);
    return names;
  }();
  return kNames;
}

const LabRow& find_row(const MotionStudy& study, LabGroup group, const std::string& name,
                       double rate_hz, double duration_s) {
  for (const LabRow& row : study.rows) {
    if (row.group == group && row.name == name && row.rate_hz == rate_hz &&
        row.duration_s == duration_s) {
      return row;
    }
  }
  throw std::out_of_range("laboratory: no row of " + name);
}

PreintegrationStudy::PreintegrationStudy(LabMotion motion, StudyPlan plan)
    : motion_(std::move(motion)),
      plan_(std::move(plan)),
      trajectory_(simulation::make_trajectory(motion_.scenario)) {
  require_whole_samples(plan_);
}

PreintegrationStudy::Record PreintegrationStudy::measure(int interval) const {
  const double begin = motion_.start_s(interval);
  const simulation::Motion start = trajectory_.at(begin);
  const geodesy::LocalFrame trip_frame(trajectory_.at(0).position);
  const auto seen = [&](const std::vector<double>& durations_s) {
    return Frames{Interval(trajectory_, trip_frame, begin, durations_s),
                  Interval(trajectory_, geodesy::LocalFrame(start.position), begin, durations_s)};
  };
  Record record;
  const Frames frames = seen(plan_.durations_s);
  record.distance_m = frames.trip.x0.p_w_b.norm();
  record.speed_m_s = start.velocity_n.norm();

  const IntervalRecorder recorder(plan_.durations_s, frames, record.distance_m, record.rows);
  const double coarsest = *std::min_element(plan_.rates_hz.begin(), plan_.rates_hz.end());
  const ExactIncrements exact(trajectory_, begin, plan_.durations_s.back(), kBaseRate, coarsest);
  for (const double rate : plan_.rates_hz) {
    const std::vector<ImuIncrement> increments = exact.at(rate);
    recorder.models(increments, rate);
    recorder.ablations(increments, rate);
  }
  const std::vector<ImuIncrement> increments = exact.at(plan_.rate_hz);
  for (const std::string& grade : plan_.grades) recorder.noise(grade, increments, plan_.rate_hz);
  recorder.distances(trajectory_, begin, plan_.origin_distances_km, increments, plan_.rate_hz);

  if (plan_.fine_rates_hz.empty()) return record;
  const std::vector<double> fine_duration{plan_.fine_duration_s};
  const Frames fine_frames = seen(fine_duration);
  const IntervalRecorder fine(fine_duration, fine_frames, record.distance_m, record.rows);
  const auto [low, high] =
      std::minmax_element(plan_.fine_rates_hz.begin(), plan_.fine_rates_hz.end());
  const ExactIncrements finer(trajectory_, begin, plan_.fine_duration_s, *high, *low);
  for (const double rate : plan_.fine_rates_hz) {
    fine.models(finer.at(rate), rate);
    fine.ablations(finer.at(rate), rate);
  }
  return record;
}

MotionStudy PreintegrationStudy::summarize(const std::vector<Record>& records) const {
  MotionStudy study;
  study.name = motion_.name;
  study.title = motion_.title;
  study.intervals = static_cast<int>(records.size());
  study.nearest_m = study.slowest_m_s = std::numeric_limits<double>::infinity();
  study.rows = records.front().rows;
  const auto count = static_cast<double>(records.size());
  for (std::size_t i = 0; i < study.rows.size(); ++i) {
    MotionError sum;
    double distance = 0;
    for (const Record& record : records) {
      add_squares(record.rows[i].rms, sum);
      distance += record.rows[i].origin_distance_m;
    }
    study.rows[i].rms = root_mean(sum, count);
    study.rows[i].origin_distance_m = distance / count;
  }
  for (const Record& record : records) {
    study.nearest_m = std::min(study.nearest_m, record.distance_m);
    study.farthest_m = std::max(study.farthest_m, record.distance_m);
    study.slowest_m_s = std::min(study.slowest_m_s, record.speed_m_s);
    study.fastest_m_s = std::max(study.fastest_m_s, record.speed_m_s);
  }
  return study;
}

}  // namespace foucault::laboratory
