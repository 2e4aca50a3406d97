#pragma once

/// When a reference trajectory is of another place, for all who compare with one.
namespace foucault {

/// [m], horizontal, at most poses. Chosen: the worst receivers are off by less; other datums than
/// WGS-84, degrees without their minutes and swapped coordinates by more. Not where it is nearest:
/// a drive may begin at a whole degree.
inline constexpr double kElsewhere = 100;

}  // namespace foucault
