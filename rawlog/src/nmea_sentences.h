#pragma once

#include <map>
#include <optional>
#include <string>

#include "foucault/core/measurement.h"
#include "text_table.h"

/// Sentences of NMEA 0183, and what those of one time of day say together.
/// Source: IEC 61162-1; gpsd's "NMEA Revealed".
namespace foucault::rawlog {

/// What a GGA, a GNS or u-blox's PUBX,00 says, or an RMC, which has no height.
struct NmeaPosition {
  FixQuality quality = FixQuality::unknown;
  double latitude = 0;                     ///< [rad]
  double longitude = 0;                    ///< [rad]
  double height = 0;                       ///< above mean sea level; of PUBX the ellipsoid [m]
  std::optional<double> geoid_separation;  ///< of PUBX zero [m]
  FixDetails details;
};

struct NmeaEpoch {
  int64_t time_of_day_ns = 0;       ///< UTC
  std::optional<int64_t> dated_ns;  ///< a stamp near it, from RMC or ZDA
  std::optional<NmeaPosition> position;
  std::optional<NmeaPosition> flat;         ///< of RMC
  std::optional<Eigen::Vector3d> sigma;     ///< north, east, down, from GST or PUBX [m]
  std::optional<Eigen::Vector2d> velocity;  ///< north, east [m/s]
  bool velocity_from_rmc = false;
  std::optional<double> heading;        ///< of THS, HDT or PASHR [rad]
  std::optional<double> heading_sigma;  ///< of PASHR [rad]
  std::optional<Row> row;               ///< of the position, for messages only: its fields are gone
};

/// Sentences with a right checksum, cut into fields. What stands between them is left out: stamps
/// of a logger, binary messages of the receiver. Where none of a file has a checksum, all are
/// taken.
class NmeaSentences {
 public:
  NmeaSentences(const std::string& path, const std::string& named);

  /// The first field is the address, e.g. GPGGA. None at the end.
  const Row* next();
  const TextTable& table() const { return table_; }
  int64_t sentences() const { return sentences_; }
  int64_t damaged() const { return damaged_; }
  int64_t first_damaged_line() const { return first_damaged_line_; }
  /// Whether no sentence of the file has a checksum.
  bool unchecked() const { return unchecked_; }

 private:
  NmeaSentences(const std::string& path, const std::string& named, bool unchecked);
  static bool has_no_checksums(const std::string& path, const std::string& named);
  /// From '$' on; whether it is right is not checked.
  std::optional<std::string_view> next_sentence();

  TextTable table_;
  bool unchecked_;
  std::string_view rest_;  ///< of the line
  int64_t sentences_ = 0;
  int64_t damaged_ = 0;  ///< checksum wrong or missing
  int64_t first_damaged_line_ = 0;
};

/// Sentences of a time of day, joined.
class NmeaEpochs {
 public:
  /// Messages name the file `named`.
  NmeaEpochs(const std::string& path, const std::string& named) : sentences_(path, named) {}

  /// None at the end. Throws RowError for a sentence that is wrong, and goes on behind it.
  std::optional<NmeaEpoch> next();
  const NmeaSentences& sentences() const { return sentences_; }
  int64_t without_fix() const { return without_fix_; }

 private:
  void take(const Row& row);
  void take_timed(std::string_view type, const Row& row);
  void take_position(const Row& row, bool gns);
  void take_pubx(const Row& row);
  void begin_epoch(int64_t time_of_day_ns);
  void take_zda(const Row& row);
  void take_vtg(const Row& row);
  void take_heading(const Row& row);
  void take_pashr(const Row& row);
  void take_date(const Row& row, const std::string& date, const char* format,
                 size_t time_column = 1);
  void take_flat(const Row& row);
  void take_rmc(const Row& row);
  void finish();

  NmeaSentences sentences_;
  std::optional<NmeaEpoch> current_;
  std::optional<NmeaEpoch> finished_;
  std::optional<int64_t> dated_ns_;
  int64_t without_fix_ = 0;
};

/// The stamp of a time of day that is nearest to `near_ns`.
int64_t stamp_near(int64_t time_of_day_ns, int64_t near_ns);

}  // namespace foucault::rawlog
