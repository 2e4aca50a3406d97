#include "reading.h"

#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "foucault/rawlog/rawlog_info.h"
#include "foucault/rawlog/rawlog_source.h"
#include "fuzzing.h"

namespace foucault::fuzz {

namespace {

bool finite(const Geodetic& position) {
  return std::isfinite(position.latitude) && std::isfinite(position.longitude) &&
         std::isfinite(position.height);
}

bool finite(const Measurement& measurement) {
  if (const auto* increment = std::get_if<ImuIncrement>(&measurement)) {
    return increment->t_begin_ns < increment->t_end_ns;
  }
  if (const auto* fix = std::get_if<GnssFix>(&measurement)) {
    return finite(fix->antenna) && fix->position_covariance.allFinite() && fix->p_b_a.allFinite();
  }
  if (const auto* pose = std::get_if<ReferencePose>(&measurement)) return finite(pose->position);
  return true;
}

/// What a source gives out; true if the log is whole.
bool read_measurements(const std::string& path, imu::SampleKind samples) {
  rawlog::RawlogSource source(path, samples);
  int64_t last_ns = std::numeric_limits<int64_t>::min();
  while (const std::optional<Measurement> measurement = source.next()) {
    require(stamp(*measurement) >= last_ns, "measurements in order");
    require(finite(*measurement), "finite measurements");
    last_ns = stamp(*measurement);
  }
  source.notices();
  require(source.progress() == 1, "progress at the end");
  return !source.damage();
}

}  // namespace

void read_rawlog(const std::string& path) {
  contained([&] { rawlog::read_rawlog_info(path); });
  contained([&] { read_measurements(path, imu::SampleKind::interval_mean); });
  contained([&] { read_measurements(path, imu::SampleKind::instantaneous); });
}

void read_own_rawlog(const std::string& path) {
  contained([&] { require(!rawlog::read_rawlog_info(path).damage, "what we write is whole"); });
  contained([&] {
    require(read_measurements(path, imu::SampleKind::interval_mean), "what we write is whole");
  });
}

}  // namespace foucault::fuzz
