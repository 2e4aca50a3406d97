#include "foucault/rawlog/import_nmea.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <set>

#include "csv_readers.h"
#include "foucault/core/error.h"
#include "foucault/core/fix_quality.h"
#include "foucault/core/so3.h"
#include "foucault/core/time.h"
#include "nmea_accuracy.h"
#include "nmea_reader.h"
#include "nmea_sentences.h"

namespace foucault::rawlog {

namespace {

constexpr double kSmallestSigma = 1e-5;  ///< [m]
constexpr double kLargestSigma = 1e6;    ///< [m]
constexpr double kLargestHeight = 1e8;   ///< [m]

class NmeaReader : public RecordReader {
 public:
  NmeaReader(const GnssMapping& mapping, const NmeaFile& file)
      : epochs_(file.path, file.named),
        mapping_(mapping),
        offset_ns_(nanoseconds(mapping.time.offset_s)),
        first_(first_of(mapping, file)),
        near_ns_(first_.stamp_ns) {}

  const TextTable& table() const override { return epochs_.sentences().table(); }
  int64_t without_fix() const override { return epochs_.without_fix(); }

  std::optional<Record> next() override {
    while (const std::optional<NmeaEpoch> epoch = epochs_.next()) {
      near_ns_ = stamp_near(epoch->time_of_day_ns, epoch->dated_ns.value_or(near_ns_));
      if (epoch->position) return fix_of(*epoch, *epoch->position);
      if (first_.flat && epoch->flat) return flat_fix(*epoch, *epoch->flat);
    }
    return std::nullopt;
  }

  std::vector<std::string> notices() const override {
    std::vector<std::string> found;
    const NmeaSentences& sentences = epochs_.sentences();
    if (sentences.damaged() > 0) {
      found.push_back(
          fmt::format("{}: left out {} of {} sentences, their checksum is wrong or missing; the "
                      "first in line {}",
                      table().path(), sentences.damaged(), sentences.sentences(),
                      sentences.first_damaged_line()));
    }
    if (sentences.unchecked()) {
      found.push_back(
          fmt::format("{}: no sentence has a checksum; all were taken, damaged ones cannot be told",
                      table().path()));
    }
    if (first_.flat) {
      found.push_back(
          fmt::format("{}: no heights (RMC only, no GGA): {} m assumed, with a sigma of {} m; if "
                      "known, give gnss.height_m and gnss.sigma_m: [north, east, down]",
                      table().path(), mapping_.height_m.value_or(0), flat_sigma_down()));
    }
    if (!assumed_.empty()) {
      std::vector<std::string> parts;
      for (const FixQuality quality : assumed_) {
        parts.push_back(
            fmt::format("{} m ({})", nmea_sigma(quality, 1).horizontal, name_of(quality)));
      }
      found.push_back(
          fmt::format("{}: no sigmas (GST): HDOP times {} assumed, down twice that; if known, give "
                      "gnss.sigma_m: [north, east, down] at an HDOP of 1",
                      table().path(), fmt::join(parts, ", ")));
    }
    if (velocity_assumed_) {
      found.push_back(fmt::format(
          "{}: velocities along the ground with an assumed sigma of {} m/s; if known, give "
          "gnss.velocity_sigma_m_s: [north, east, down]",
          table().path(), kGroundSpeedSigma));
    }
    if (heading_assumed_) {
      found.push_back(
          fmt::format("{}: headings with an assumed sigma of {} deg; if known, give "
                      "gnss.heading_sigma_deg",
                      table().path(), kHeadingSigma / kDegree));
    }
    return found;
  }

 private:
  /// What is found before the file is read.
  struct First {
    int64_t stamp_ns = 0;  ///< of the first position
    bool flat = false;     ///< there are positions of RMC only
  };
  static First first_of(const GnssMapping& mapping, const NmeaFile& file);

  double flat_sigma_down() const {
    constexpr double kOpenHeight = 1000;  // [m]
    return mapping_.sigma_m.size() == 3 ? mapping_.sigma_m[2] : kOpenHeight;
  }

  GnssFix flat_fix(const NmeaEpoch& epoch, NmeaPosition position) {
    position.height = mapping_.height_m.value_or(0);
    position.geoid_separation = 0;
    GnssFix fix = fix_of(epoch, position);
    const double sigma = flat_sigma_down();
    fix.position_covariance(2, 2) = sigma * sigma;
    return fix;
  }

  GnssFix fix_of(const NmeaEpoch& epoch, const NmeaPosition& position) {
    const Row& row = *epoch.row;
    GnssFix fix;
    fix.quality = position.quality;
    fix.details = position.details;
    fix.antenna = checked_position(row, position.latitude, position.longitude,
                                   position.height + separation(position, row));
    if (std::abs(fix.antenna.height) > kLargestHeight) {
      row.fail(fmt::format("{} m are no height; correct or remove the line", fix.antenna.height));
    }
    fix.position_covariance = sigma(epoch, position).cwiseAbs2().asDiagonal();
    if (epoch.velocity && mapping_.velocity) add_velocity(fix, *epoch.velocity);
    if (epoch.heading) fix.heading = GnssHeading{so3::wrap(*epoch.heading), heading_sigma(epoch)};
    fix.t_ns = checked_stamp(row, near_ns_ + offset_ns_);
    order_.check(row, fix.t_ns);
    return fix;
  }

  double separation(const NmeaPosition& position, const Row& row) const {
    if (position.geoid_separation) return *position.geoid_separation;
    if (mapping_.geoid_separation_m) return *mapping_.geoid_separation_m;
    row.fail(
        "GGA has no geoid separation; give gnss.geoid_separation_m (ellipsoidal = msl + "
        "separation; 50 m off do no harm, 0 is allowed)");
  }

  Eigen::Vector3d sigma(const NmeaEpoch& epoch, const NmeaPosition& position) {
    const Eigen::Vector3d found = epoch.sigma ? *epoch.sigma : sigma_by_hdop(position);
    if (!(found.minCoeff() > kSmallestSigma && found.maxCoeff() < kLargestSigma)) {
      epoch.row->fail(
          fmt::format("sigmas of the position of {} to {} m (GST or HDOP); remove the "
                      "lines of this time",
                      found.minCoeff(), found.maxCoeff()));
    }
    return found;
  }

  /// A missing HDOP counts as 1.
  Eigen::Vector3d sigma_by_hdop(const NmeaPosition& position) {
    const std::optional<double>& hdop = position.details.hdop;
    if (mapping_.sigma_m.size() == 3) {
      return hdop.value_or(1) * Eigen::Vector3d(mapping_.sigma_m.data());
    }
    assumed_.insert(position.quality);
    const NmeaSigma sigma = nmea_sigma(position.quality, hdop);
    return {sigma.horizontal, sigma.horizontal, sigma.vertical};
  }

  void add_velocity(GnssFix& fix, const Eigen::Vector2d& velocity) {
    fix.velocity_n = Eigen::Vector3d(velocity.x(), velocity.y(), 0);
    Eigen::Vector3d sigma(kGroundSpeedSigma, kGroundSpeedSigma, kOpenVerticalSigma);
    if (mapping_.velocity_sigma_m_s.size() == 3) {
      sigma = Eigen::Vector3d(mapping_.velocity_sigma_m_s.data());
    } else {
      velocity_assumed_ = true;
    }
    fix.velocity_covariance = sigma.cwiseAbs2().asDiagonal();
  }

  double heading_sigma(const NmeaEpoch& epoch) {
    if (epoch.heading_sigma) return *epoch.heading_sigma;
    if (mapping_.heading_sigma_deg) return *mapping_.heading_sigma_deg * kDegree;
    heading_assumed_ = true;
    return kHeadingSigma;
  }

  NmeaEpochs epochs_;
  GnssMapping mapping_;
  int64_t offset_ns_;
  First first_;
  int64_t near_ns_;  ///< a stamp within half a day of the next epoch
  StampOrder order_;
  std::set<FixQuality> assumed_;
  bool velocity_assumed_ = false, heading_assumed_ = false;
};

/// The first epochs of a file with a position, with and without a height.
struct FirstEpochs {
  explicit FirstEpochs(const NmeaFile& file) : epochs(file.path, file.named) {}

  /// Until there is a position with a height and a date beside one.
  void scan() {
    for (bool over = false; !over && !(position_ns && dated_ns);) {
      try {
        const std::optional<NmeaEpoch> epoch = epochs.next();
        over = !epoch;
        if (!over) take(*epoch);
      } catch (const RowError&) {
        continue;  // comes again when the file is read
      }
    }
  }

  NmeaEpochs epochs;
  std::optional<int64_t> position_ns, flat_ns;  ///< times of day
  std::optional<int64_t> dated_ns;

 private:
  void take(const NmeaEpoch& epoch) {
    if (!epoch.position && !epoch.flat) return;
    if (!flat_ns) flat_ns = epoch.time_of_day_ns;
    if (epoch.position && !position_ns) position_ns = epoch.time_of_day_ns;
    if (!dated_ns) dated_ns = epoch.dated_ns;
  }
};

/// Dated by the first RMC, ZDA or PUBX,04 beside a position.
NmeaReader::First NmeaReader::first_of(const GnssMapping& mapping, const NmeaFile& file) {
  FirstEpochs found(file);
  found.scan();
  if (!found.flat_ns) {
    const NmeaSentences& sentences = found.epochs.sentences();
    throw DataError(fmt::format(
        "'{}' has no position in NMEA: of {} sentences {} have a wrong checksum or "
        "none, {} GGA are without a fix; give a file with GGA sentences",
        file.named, sentences.sentences(), sentences.damaged(), found.epochs.without_fix()));
  }
  const bool flat = !found.position_ns;
  const int64_t first_ns = *found.flat_ns;
  if (found.dated_ns) return {stamp_near(first_ns, *found.dated_ns), flat};
  const std::optional<int64_t> midnight = midnight_ns(mapping.time.date, "%Y-%m-%d");
  if (midnight) return {*midnight + first_ns, flat};
  if (file.begins_ns) return {stamp_near(first_ns, *file.begins_ns), flat};
  throw UsageError(
      fmt::format("'{}' has no date (RMC or ZDA); give gnss.time.date: YYYY-MM-DD, of its first "
                  "position, UTC",
                  file.named));
}

}  // namespace

std::unique_ptr<RecordReader> make_nmea_reader(const GnssMapping& mapping, const NmeaFile& file) {
  return std::make_unique<NmeaReader>(mapping, file);
}

ImportSummary import_nmea(const NmeaImport& options) {
  const MappingSource source{options.mapping, options.data_dir};
  ImportInputs inputs;
  const ImportMapping mapping =
      add_tables(source, {options.imu, options.reference, options.wheel}, inputs);
  const auto gnss = input_path(source, options.gnss, mapping.gnss.file);
  if (!gnss) throw UsageError("no NMEA file: give --gnss, or gnss.file in the mapping");
  inputs.gnss = make_nmea_reader(mapping.gnss, {*gnss, *gnss, {}});
  if (options.lever_arm) inputs.lever_arm_v = options.lever_arm;
  return run_import(options, std::move(inputs));
}

}  // namespace foucault::rawlog
