#pragma once

#include <string>
#include <vector>

#include "foucault/evaluation/drift_table.h"
#include "foucault/evaluation/method_outages.h"
#include "foucault/evaluation/statistics.h"

/// Drift against the distance from the start of the recording. What a method takes as constant in a
/// frame fixed at the start (gravity turns by 0.157 mrad per km) shows as drift that grows with it.
namespace foucault::evaluation {

/// Nearer, the distance does not matter [km].
constexpr double kFarKm = 10;

/// Outages that begin at a distance in [from_km, to_km).
struct DistanceBin {
  double from_km = 0;
  double to_km = 0;
  std::vector<std::size_t> outages;  ///< indices, in order
};

/// Bins with round borders, none of fewer than four outages (neighbours are joined until there are
/// so many); about six outages a bin, two to eight bins. None if all outages lie within kFarKm.
/// Distances that are not finite are in no bin.
std::vector<DistanceBin> distance_bins(const std::vector<double>& distances_km);

/// RMS over the outages of a bin of the largest drift of each.
struct BinDrift {
  std::string method;
  Estimate horizontal_m;
  Estimate vertical_m;
  /// Difference of the RMS from the first method's, relative to it; outages drawn in pairs.
  Estimate horizontal_relative;
  Estimate vertical_relative;
};

struct ProfileBin {
  DistanceBin bin;
  double mean_km = 0;  ///< of its outages
  std::vector<BinDrift> methods;
};

/// One group of outages (an IMU, a recording or all) by distance.
struct DistanceProfile {
  std::string group;
  std::vector<ProfileBin> bins;
};

/// A profile for each group that goes far enough; groups as in `outages`, which group_outages()
/// gave.
std::vector<DistanceProfile> distance_profiles(const std::vector<MethodOutages>& outages);

/// A row a bin and direction, a column a method: RMS with its interval [m]; "-" where a group has
/// no such method. `group_header` heads the column of the groups.
TextTable distance_table(const std::vector<DistanceProfile>& profiles,
                         const std::string& group_header);

/// As above, a column each method but a group's first: difference from that [%].
TextTable distance_difference_table(const std::vector<DistanceProfile>& profiles,
                                    const std::string& group_header);

}  // namespace foucault::evaluation
