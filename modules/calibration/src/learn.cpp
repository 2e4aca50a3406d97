#include "foucault/calibration/learn.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace foucault::calibration {
namespace {

constexpr double kIndependent = 15;  // [s], from one prediction to another

double length_of(const std::vector<RecordedWay>& ways) {
  double length = 0;
  for (const RecordedWay& way : ways) length += length_s(way);
  return length;
}

/// From start to start of predictions.
double every_s(const std::vector<RecordedWay>& ways, int starts) {
  constexpr double kClosest = 5, kFarthest = 60;  // [s]
  return std::clamp(length_of(ways) / starts, kClosest, kFarthest);
}

std::vector<Prediction> all_predictions(const std::vector<RecordedWay>& ways,
                                        const NoiseModel& noise, const Horizons& horizons) {
  std::vector<Prediction> all;
  for (const RecordedWay& way : ways) {
    const std::vector<Prediction> of_way = predictions(way, noise, horizons);
    all.insert(all.end(), of_way.begin(), of_way.end());
  }
  return all;
}

/// Of fixes, the largest of a horizon, of the same predictions with two noises.
double gain_of(const std::vector<Prediction>& one, const std::vector<Prediction>& other,
               double every_s) {
  std::map<double, double> gains;
  for (std::size_t k = 0; k < one.size(); ++k) {
    if (one[k].kind != NoiseOf::position) continue;
    const double horizon = one[k].horizon_s;
    const double share = horizon > 0 ? std::min(1.0, every_s / horizon) : 1;
    gains[horizon] += share * (log_density(other[k]) - log_density(one[k]));
  }
  double most = 0;
  for (const auto& [horizon, gain] : gains) most = std::max(most, gain);
  return most;
}

/// Coarse: a quarter of the starts.
enum class Detail { coarse, fine };

/// The function that is climbed, over the logarithms of the factors of what was told.
class Landscape {
 public:
  Landscape(const std::vector<RecordedWay>& ways, const NoiseModel& told,
            const LearnOptions& options, Detail detail = Detail::fine)
      : ways_(ways),
        options_(options),
        detail_(detail),
        told_(told),
        prior_(1 / std::pow(std::log(options.told_within), 2)) {
    const double length = length_of(ways);
    const int starts = options.starts / (detail == Detail::coarse ? 4 : 1);
    horizons_ = {options.horizons_s, every_s(ways, starts)};
    for (const Prediction& p : predict(origin())) weights_[p.horizon_s] += 1;
    for (auto& [horizon, weight] : weights_) weight = std::min(1.0, length / kIndependent / weight);
  }

  Eigen::Index size() const { return static_cast<Eigen::Index>(options_.axes.size()); }
  Eigen::VectorXd origin() const { return Eigen::VectorXd::Zero(size()); }
  int passes() const { return passes_; }
  Detail detail() const { return detail_; }
  double every() const { return horizons_.every_s; }  ///< [s]

  NoiseModel at(const Eigen::VectorXd& x) const {
    NoiseModel model = told_;
    for (Eigen::Index i = 0; i < size(); ++i)
      options_.axes[static_cast<std::size_t>(i)].of(model) *= std::exp(x[i]);
    return model;
  }

  std::vector<Prediction> predict(const Eigen::VectorXd& x) {
    ++passes_;
    return all_predictions(ways_, at(x), horizons_);
  }

  double height(const std::vector<Prediction>& all, const Eigen::VectorXd& x) const {
    double sum = -0.5 * prior_ * x.squaredNorm();
    for (const Prediction& p : all) sum += weights_.at(p.horizon_s) * log_density(p);
    return std::isfinite(sum) ? sum : -std::numeric_limits<double>::infinity();
  }

  /// Of what is learned. Horizons share their time, so that all of them tell what one does.
  Eigen::MatrixXd covariance(const Eigen::MatrixXd& information) const {
    const Eigen::MatrixXd prior = prior_ * Eigen::MatrixXd::Identity(size(), size());
    return (prior + (information - prior) / static_cast<double>(weights_.size())).inverse();
  }

  struct Slope {
    Eigen::VectorXd gradient;
    Eigen::MatrixXd information;
  };
  Slope slope(const std::vector<Prediction>& here, const Eigen::VectorXd& x) {
    constexpr double kStep = 0.02;
    std::vector<std::vector<Prediction>> moved;
    for (Eigen::Index i = 0; i < size(); ++i) {
      Eigen::VectorXd next = x;
      next[i] += kStep;
      moved.push_back(predict(next));
    }
    Slope slope{-prior_ * x, prior_ * Eigen::MatrixXd::Identity(size(), size())};
    std::vector<Derivative> by(moved.size());
    for (std::size_t k = 0; k < here.size(); ++k) {
      for (std::size_t i = 0; i < by.size(); ++i)
        by[i] = {(moved[i][k].error - here[k].error) / kStep,
                 (moved[i][k].covariance - here[k].covariance) / kStep};
      add(here[k], by, slope);
    }
    return slope;
  }

 private:
  struct Derivative {
    Eigen::Vector3d error;
    Eigen::Matrix3d covariance;
  };

  /// Of N(error; 0, S): d = -e' W de + (e' W dS W e - tr W dS) / 2, W = S^-1, and
  /// information de' W de + tr(W dS W dS) / 2.
  void add(const Prediction& p, const std::vector<Derivative>& by, Slope& slope) const {
    const double weight = weights_.at(p.horizon_s);
    const Eigen::Matrix3d W = p.covariance.inverse();
    const Eigen::Vector3d We = W * p.error;
    for (std::size_t i = 0; i < by.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const Eigen::Matrix3d WdS = W * by[i].covariance;
      slope.gradient[row] +=
          weight * (-We.dot(by[i].error) + 0.5 * (p.error.dot(WdS * We) - WdS.trace()));
      for (std::size_t j = 0; j <= i; ++j) {
        const auto column = static_cast<Eigen::Index>(j);
        const double both =
            weight * (by[i].error.dot(W * by[j].error) +
                      0.5 * WdS.cwiseProduct((W * by[j].covariance).transpose()).sum());
        slope.information(row, column) += both;
        if (i != j) slope.information(column, row) += both;
      }
    }
  }

  const std::vector<RecordedWay>& ways_;
  const LearnOptions& options_;
  Detail detail_;
  NoiseModel told_;
  double prior_;
  Horizons horizons_;
  std::map<double, double> weights_;  ///< by horizon
  int passes_ = 0;
};

struct Place {
  Eigen::VectorXd x;
  std::vector<Prediction> predictions;
  double height = -std::numeric_limits<double>::infinity();
  Eigen::MatrixXd information;
};

Place place_at(Landscape& landscape, const Eigen::VectorXd& x) {
  Place place{x, landscape.predict(x), 0, {}};
  place.height = landscape.height(place.predictions, x);
  return place;
}

/// What the information lacks of the curvature, where the errors are not what the model takes them
/// for: from how the gradient changed along steps (Dennis, Gay, Welsch, ACM TOMS 7 (1981)).
class Curvature {
 public:
  explicit Curvature(Eigen::Index size) : beyond_(Eigen::MatrixXd::Zero(size, size)) {}

  /// Of the slope, that is `step` from the one seen before.
  void see(const Landscape::Slope& slope, const Eigen::VectorXd& step) {
    if (gradient_.size() > 0) learn(slope, step);
    gradient_ = slope.gradient;
  }

  /// With the diagonal of the information times `damping` added. The information alone where that
  /// is no top.
  Eigen::VectorXd step(const Landscape::Slope& slope, double damping) const {
    Eigen::MatrixXd added = Eigen::MatrixXd::Zero(beyond_.rows(), beyond_.cols());
    added.diagonal() = damping * slope.information.diagonal();
    const Eigen::LLT<Eigen::MatrixXd> llt(slope.information + beyond_ + added);
    if (llt.info() == Eigen::Success) return llt.solve(slope.gradient);
    return (slope.information + added).ldlt().solve(slope.gradient);
  }

 private:
  void learn(const Landscape::Slope& slope, const Eigen::VectorXd& step) {
    const Eigen::VectorXd change = gradient_ - slope.gradient;
    const double along = change.dot(step);
    if (along <= 0) return;
    const Eigen::VectorXd rest = change - (slope.information + beyond_) * step;
    beyond_ += (rest * change.transpose() + change * rest.transpose()) / along -
               rest.dot(step) * change * change.transpose() / (along * along);
  }

  Eigen::MatrixXd beyond_;
  Eigen::VectorXd gradient_;
};

/// The first higher place along steps that are damped more and more; none if there is none.
std::optional<Place> higher(Landscape& landscape, const Place& from, const Landscape::Slope& slope,
                            const Curvature& curvature, double& damping) {
  constexpr int kAttempts = 6;
  constexpr double kLongest = 1.5;  // a factor of 4.5
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Eigen::VectorXd step = curvature.step(slope, damping);
    step *= std::min(1.0, kLongest / step.cwiseAbs().maxCoeff());
    Place next = place_at(landscape, from.x + step);
    if (next.height > from.height) {
      damping *= 0.3;
      return next;
    }
    damping = std::max(4 * damping, 0.3);
  }
  return std::nullopt;
}

Place climbed(Landscape& landscape, const Eigen::VectorXd& start) {
  constexpr int kMostRounds = 20;
  // Of a logarithm of a likelihood; of the coarse one a fine one finds the rest.
  const double little = landscape.detail() == Detail::fine ? 0.02 : 0.2;
  Place place = place_at(landscape, start);
  Curvature curvature(start.size());
  Eigen::VectorXd step = Eigen::VectorXd::Zero(start.size());
  double damping = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    const Landscape::Slope slope = landscape.slope(place.predictions, place.x);
    if (landscape.detail() == Detail::fine) curvature.see(slope, step);
    place.information = slope.information;
    std::optional<Place> next = higher(landscape, place, slope, curvature, damping);
    if (!next) break;
    step = next->x - place.x;
    next->information = place.information;
    const bool arrived = next->height - place.height < little;
    place = std::move(*next);
    if (arrived) break;
  }
  return place;
}

/// By the recording: half of what is known of a logarithm.
bool is_told(double variance, const LearnOptions& options) {
  return variance < 0.5 * std::pow(std::log(options.told_within), 2);
}

bool is_variation(const NoiseAxis& axis) {
  return axis.name == noise_axis::accel_bias.name || axis.name == noise_axis::gyro_bias.name;
}

/// Whether the recording tells how large the variations of the biases are.
bool knows_variations(const Place& place, const LearnOptions& options) {
  const Eigen::MatrixXd covariance = place.information.inverse();
  for (std::size_t i = 0; i < options.axes.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (is_variation(options.axes[i]) && !is_told(covariance(row, row), options)) return false;
  }
  return true;
}

/// From variations of biases that are thirty times what was told; if they do not show there, from
/// others.
Place highest(Landscape& landscape, const Eigen::VectorXd& origin, const LearnOptions& options) {
  const std::vector<NoiseAxis>& axes = options.axes;
  Place best;
  for (const double factor : {30.0, 300.0, 1.0}) {
    Eigen::VectorXd start = origin;
    for (std::size_t i = 0; i < axes.size(); ++i)
      if (is_variation(axes[i])) start[static_cast<Eigen::Index>(i)] = std::log(factor);
    Place place = climbed(landscape, start);
    if (place.height > best.height) best = std::move(place);
    if (knows_variations(best, options)) break;
  }
  return best;
}

std::vector<LearnedAxis> learned_axes(const LearnOptions& options, const NoiseModel& told,
                                      const NoiseModel& found, const Eigen::MatrixXd& covariance) {
  std::vector<LearnedAxis> out;
  for (std::size_t i = 0; i < options.axes.size(); ++i) {
    const NoiseAxis& axis = options.axes[i];
    const auto row = static_cast<Eigen::Index>(i);
    const double sigma = std::sqrt(covariance(row, row));
    out.push_back({axis,
                   axis.value(told),
                   axis.value(found),
                   sigma,
                   is_told(sigma * sigma, options),
                   {},
                   {}});
  }
  return out;
}

/// From a fifth to five times the value.
void add_profiles(Landscape& landscape, const Place& best, std::vector<LearnedAxis>& axes) {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (const double factor :
         {0.2, 0.35, 0.5, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.4, 2.0, 2.8, 5.0}) {
      Eigen::VectorXd x = best.x;
      x[static_cast<Eigen::Index>(i)] += std::log(factor);
      axes[i].profile_factors.push_back(factor);
      axes[i].profile.push_back(place_at(landscape, x).height - best.height);
    }
  }
}

Learned found_at(Landscape& landscape, const Place& best, const NoiseModel& told,
                 const LearnOptions& options) {
  Learned out;
  out.noise = landscape.at(best.x);
  out.axes = learned_axes(options, told, out.noise, landscape.covariance(best.information));
  if (options.profile) add_profiles(landscape, best, out.axes);
  out.passes = landscape.passes();
  return out;
}

/// All else as it is, the sigma of fixes for those who take their errors for white.
void learn_white_alone(const std::vector<RecordedWay>& ways, const LearnOptions& options,
                       Learned& out) {
  const NoiseAxis& white = noise_axis::fix_white;
  const auto axis = std::find_if(out.axes.begin(), out.axes.end(),
                                 [&](const LearnedAxis& a) { return a.axis.name == white.name; });
  if (axis == out.axes.end()) return;
  LearnOptions alone = options;
  alone.axes = {white};
  out.noise.fix_white = std::hypot(out.noise.fix_white, out.noise.fix_coloured);
  out.noise.fix_coloured = 0;
  Landscape landscape(ways, out.noise, alone);
  const Learned found =
      found_at(landscape, climbed(landscape, landscape.origin()), out.noise, alone);
  out.noise = found.noise;
  out.passes += found.passes;
  const double told = axis->told;
  *axis = found.axes.front();
  axis->told = told;
}

/// From the coarse place without them; none if chance would explain as much.
std::optional<Learned> among_lasting_errors(const std::vector<RecordedWay>& ways, NoiseModel told,
                                            const LearnOptions& options, const Place& without) {
  constexpr double kChance = 1e-4;
  told.fix_coloured = 0.5;  // of what was told
  LearnOptions more = options;
  more.axes.insert(more.axes.end(), {noise_axis::fix_coloured, noise_axis::fix_tau});
  Landscape coarse(ways, told, more, Detail::coarse);
  Eigen::VectorXd origin = coarse.origin();
  origin.head(without.x.size()) = without.x;
  const Place with = highest(coarse, origin, more);
  // Twice the gain is a chi-square of two degrees of freedom, at the next fix or any horizon.
  const double gain = gain_of(without.predictions, with.predictions, coarse.every());
  const double tries = 1 + static_cast<double>(options.horizons_s.size());
  if (tries * std::exp(-gain) > kChance) return std::nullopt;
  Landscape landscape(ways, told, more);
  Learned out = found_at(landscape, climbed(landscape, with.x), told, options);
  out.passes += coarse.passes();
  out.lasting = {out.noise.fix_coloured, out.noise.fix_tau_s};
  learn_white_alone(ways, options, out);
  return out;
}

}  // namespace

std::vector<NoiseAxis> NoiseAxes::all() const {
  std::vector<NoiseAxis> out = told;
  out.insert(out.end(), of_aids.begin(), of_aids.end());
  return out;
}

NoiseAxes axes_of(const std::vector<RecordedWay>& ways) {
  namespace axis = noise_axis;
  std::map<NoiseOf, int> measured;
  for (const RecordedWay& way : ways)
    for (const WayNode& node : way.nodes)
      for (const WayMeasurement& z : node.measured) ++measured[z.kind];
  NoiseAxes axes;
  axes.told = {axis::accel_white, axis::gyro_white, axis::accel_bias, axis::gyro_bias};
  if (measured[NoiseOf::position] > 0) axes.told.push_back(axis::fix_white);
  if (measured[NoiseOf::velocity] > 0) axes.told.push_back(axis::velocity);
  if (measured[NoiseOf::slip] > 0) axes.of_aids = {axis::slip, axis::bounce};
  if (measured[NoiseOf::wheel] > 0) axes.of_aids.push_back(axis::wheel);
  return axes;
}

Learned learn(const std::vector<RecordedWay>& ways, const NoiseModel& told,
              const LearnOptions& options) {
  if (options.axes.empty()) return {told, {}, {}, 0, 0, {}, {}};
  Landscape coarse(ways, told, options, Detail::coarse);
  Landscape landscape(ways, told, options);
  const Place before = place_at(landscape, landscape.origin());
  const Place near = highest(coarse, coarse.origin(), options);
  std::optional<Learned> among;
  if (options.lasting) among = among_lasting_errors(ways, told, options, near);
  Learned out =
      among ? std::move(*among) : found_at(landscape, climbed(landscape, near.x), told, options);
  const std::vector<Prediction> after =
      all_predictions(ways, out.noise, {options.horizons_s, landscape.every()});
  out.gain = gain_of(before.predictions, after, landscape.every());
  out.passes += coarse.passes() + (among ? landscape.passes() : 0) + 1;
  out.before = normalized_errors(before.predictions);
  out.after = normalized_errors(after);
  return out;
}

double gain_of(const std::vector<RecordedWay>& ways, const NoiseModel& noise,
               const NoiseModel& other, const LearnOptions& options) {
  const Horizons horizons{options.horizons_s, every_s(ways, options.starts)};
  return gain_of(all_predictions(ways, noise, horizons), all_predictions(ways, other, horizons),
                 horizons.every_s);
}

std::size_t most_likely(const std::vector<RecordedWay>& ways, const std::vector<NoiseModel>& noises,
                        const LearnOptions& options) {
  std::size_t best = 0;
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < noises.size(); ++i) {
    Landscape landscape(ways, noises[i], options);
    const double height = place_at(landscape, landscape.origin()).height;
    if (height <= highest) continue;
    highest = height;
    best = i;
  }
  return best;
}

}  // namespace foucault::calibration
