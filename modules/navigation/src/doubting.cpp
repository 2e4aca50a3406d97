#include "doubting.h"

namespace foucault::navigation {

bool Doubting::take(const Measurement& measurement) {
  held_.push_back(measurement);
  return show_doubt(measurement);
}

bool Doubting::show_doubt(const Measurement& measurement) {
  const auto* fix = std::get_if<GnssFix>(&measurement);
  if (!fix) return doubt_->add(measurement);
  return options_.allows(*fix) && doubt_->add(options_.weighted(*fix));
}

}  // namespace foucault::navigation
