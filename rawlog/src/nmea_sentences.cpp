#include "nmea_sentences.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "foucault/core/constants.h"
#include "foucault/core/time.h"
#include "import_run.h"
#include "nmea_accuracy.h"

namespace foucault::rawlog {

namespace {

constexpr size_t kAddress = 5;  ///< two letters of the talker (GP, GN, GL ...), three of the type

constexpr std::string_view kUblox = "PUBX", kAshtech = "PASHR";

/// '$' and five capital letters or u-blox's own address, else it is of no use here.
bool has_address(std::string_view sentence) {
  if (sentence.substr(1, kUblox.size() + 1) == "PUBX,") return true;
  const std::string_view address = sentence.substr(1, kAddress);
  return address.size() == kAddress &&
         std::all_of(address.begin(), address.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
}

/// Exclusive-or of all between '$' and '*', which two hexadecimal digits behind it tell.
bool checksum_is_right(std::string_view sentence, size_t star) {
  unsigned told = 0;
  const char* digits = sentence.data() + star + 1;
  const char* end = digits + std::min<size_t>(2, sentence.size() - star - 1);
  const auto read = std::from_chars(digits, end, told, 16);
  if (read.ec != std::errc{} || read.ptr != digits + 2) return false;
  unsigned sum = 0;
  for (const char c : sentence.substr(1, star - 1)) sum ^= static_cast<unsigned char>(c);
  return sum == told;
}

/// hhmmss.sss as nanoseconds; the last second of a day may be a leap second.
int64_t sentence_time_ns(const Row& row, size_t column = 1) {
  const int64_t digits = row.scaled(column, kNanosecondDecimals);
  const int64_t whole = digits / kNanosecondsPerSecond;
  const int64_t hours = whole / 10'000;
  const int64_t minutes = whole / 100 % 100;
  const int64_t seconds = whole % 100;
  if (digits < 0 || hours > 23 || minutes > 59 || seconds > 60) {
    row.fail(fmt::format("'{}' is no time of day (hhmmss); correct or remove the line",
                         row.text(column)));
  }
  return (hours * kSecondsPerHour + minutes * 60 + seconds) * kNanosecondsPerSecond +
         digits % kNanosecondsPerSecond;
}

/// ddmm.mmmm and its hemisphere [rad].
double angle(const Row& row, size_t column, char positive, char negative) {
  const double value = row.number(column);
  const double degrees = std::floor(value / 100);
  const double minutes = value - degrees * 100;
  const std::string_view side = row.text(column + 1);
  if (value < 0 || minutes >= 60 || side.size() != 1 ||
      (side[0] != positive && side[0] != negative)) {
    row.fail(
        fmt::format("'{},{}' is no angle in degrees and minutes with {} or {}; correct or "
                    "remove the line",
                    row.text(column), side, positive, negative));
  }
  return (side[0] == negative ? -1 : 1) * (degrees + minutes / 60) * kDegree;
}

bool is_blank(const Row& row, size_t column) {
  return row.size() <= column || row.text(column).empty();
}

std::optional<double> optional_number(const Row& row, size_t column) {
  return is_blank(row, column) ? std::nullopt : std::optional(row.number(column));
}

/// None where there is no position by satellites.
std::optional<FixQuality> quality(const Row& row) {
  switch (is_blank(row, 6) ? 0 : row.integer(6)) {
    case 0:
    case 6:  // dead reckoning
    case 7:  // entered by hand
      return std::nullopt;
    case 1:
    case 3:  // PPS
      return FixQuality::single;
    case 2:
    case 9:  // SBAS, of NovAtel
      return FixQuality::differential;
    case 4:
      return FixQuality::fixed_rtk;
    case 5:
      return FixQuality::float_rtk;
    case 8:  // simulator
      return FixQuality::unknown;
    default:
      row.fail(fmt::format("quality '{}' is none of GGA's (0 to 9); correct or remove the line",
                           row.text(6)));
  }
}

/// Of the letters that RMC has and GNS has one a system: the best.
std::optional<FixQuality> quality_by_mode(std::string_view modes) {
  const auto has = [&](const char* letters) {
    return modes.find_first_of(letters) != std::string_view::npos;
  };
  if (has("R")) return FixQuality::fixed_rtk;
  if (has("F")) return FixQuality::float_rtk;
  if (has("D")) return FixQuality::differential;
  if (has("AP")) return FixQuality::single;
  if (has("S")) return FixQuality::unknown;  // simulator
  return std::nullopt;                       // none, estimated or entered by hand
}

/// Of PUBX,00; positions of two dimensions and of dead reckoning are none.
std::optional<FixQuality> quality_of_pubx(std::string_view status) {
  if (status == "G3" || status == "RK") return FixQuality::single;
  return status == "D3" ? std::optional(FixQuality::differential) : std::nullopt;
}

std::optional<Eigen::Vector2d> velocity(const Row& row, size_t course, size_t speed,
                                        double unit = kKnot) {
  if (is_blank(row, course) || is_blank(row, speed)) return std::nullopt;
  const double bearing = row.number(course) * kDegree;
  return row.number(speed) * unit * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
}

/// Standard deviations of GST; none where the receiver leaves them blank or zero.
std::optional<Eigen::Vector3d> sigma(const Row& row) {
  Eigen::Vector3d found;
  for (int i = 0; i < 3; ++i) {
    const std::optional<double> one = optional_number(row, static_cast<size_t>(6 + i));
    if (!one || *one == 0) return std::nullopt;
    found[i] = row.sigma(static_cast<size_t>(6 + i));
  }
  return found;
}

/// Zero: not told.
std::optional<double> positive(const Row& row, size_t field) {
  const std::optional<double> value = optional_number(row, field);
  return value && *value > 0 ? value : std::nullopt;
}

std::optional<int> count(const Row& row, size_t field) {
  const std::optional<double> value = positive(row, field);
  return value && *value < 256 ? std::optional<int>(static_cast<int>(*value)) : std::nullopt;
}

bool is_valid(const Row& row, size_t mode) { return is_blank(row, mode) || row.text(mode) != "N"; }

}  // namespace

NmeaSentences::NmeaSentences(const std::string& path, const std::string& named)
    : NmeaSentences(path, named, has_no_checksums(path, named)) {}

NmeaSentences::NmeaSentences(const std::string& path, const std::string& named, bool unchecked)
    : table_(path, TextTable::Separator::comma, "", named), unchecked_(unchecked) {}

bool NmeaSentences::has_no_checksums(const std::string& path, const std::string& named) {
  NmeaSentences sentences(path, named, false);
  int64_t found = 0;
  while (const std::optional<std::string_view> sentence = sentences.next_sentence()) {
    if (sentence->find('*') != std::string_view::npos) return false;
    ++found;
  }
  return found > 0;
}

const Row* NmeaSentences::next() {
  while (const std::optional<std::string_view> sentence = next_sentence()) {
    const size_t star = sentence->find('*');
    ++sentences_;
    if (unchecked_) {
      const size_t end = sentence->find_last_not_of(" \t\r\"");
      return &table_.split(sentence->substr(1, end));
    }
    if (star != std::string_view::npos && checksum_is_right(*sentence, star)) {
      return &table_.split(sentence->substr(1, star - 1));
    }
    if (damaged_++ == 0) first_damaged_line_ = table_.position();
  }
  return nullptr;
}

std::optional<std::string_view> NmeaSentences::next_sentence() {
  while (true) {
    const size_t begin = rest_.find('$');
    if (begin == std::string_view::npos) {
      const std::optional<std::string_view> line = table_.next_bytes();
      if (!line) return std::nullopt;
      rest_ = *line;
      continue;
    }
    const size_t end = std::min(rest_.find('$', begin + 1), rest_.size());
    const std::string_view sentence = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    if (has_address(sentence)) return sentence;
  }
}

std::optional<NmeaEpoch> NmeaEpochs::next() {
  while (!finished_) {
    const Row* row = sentences_.next();
    if (row == nullptr) {
      finish();
      break;
    }
    take(*row);
  }
  std::optional<NmeaEpoch> epoch;
  epoch.swap(finished_);
  return epoch;
}

void NmeaEpochs::finish() {
  finished_.swap(current_);
  current_.reset();
  if (!finished_) return;
  finished_->dated_ns = dated_ns_;
  dated_ns_.reset();
}

void NmeaEpochs::take(const Row& row) {
  if (row.text(0) == kUblox) return take_pubx(row);
  if (row.text(0) == kAshtech) return take_pashr(row);
  if (row.text(0).size() != kAddress) return;
  const std::string_view type = row.text(0).substr(2);
  const bool position = type == "GGA" || type == "GNS";
  if (position || type == "RMC" || type == "GST") {
    if (!is_blank(row, 1)) return take_timed(type, row);
    if (position) ++without_fix_;
  } else if (type == "ZDA") {
    take_zda(row);
  } else if (type == "VTG") {
    take_vtg(row);
  } else if (type == "THS" || type == "HDT") {
    take_heading(row);
  }
}

/// Of what moves the antennas alone: A in THS. They have no time: they belong to the sentences
/// before them.
void NmeaEpochs::take_heading(const Row& row) {
  const bool ths = row.text(0).substr(2) == "THS";
  if (!current_ || is_blank(row, 1) || is_blank(row, 2)) return;
  if (row.text(2) != (ths ? "A" : "T")) return;
  current_->heading = row.number(1) * kDegree;
}

/// time, heading, T, roll, pitch, heave, three sigmas, of the heading the last [deg].
void NmeaEpochs::take_pashr(const Row& row) {
  if (is_blank(row, 1) || is_blank(row, 2) || is_blank(row, 3) || row.text(3) != "T") return;
  begin_epoch(sentence_time_ns(row));
  current_->heading = row.number(2) * kDegree;
  if (const std::optional<double> sigma = positive(row, 9))
    current_->heading_sigma = *sigma * kDegree;
}

void NmeaEpochs::take_zda(const Row& row) {
  for (const size_t column : {1, 2, 3, 4}) {
    if (is_blank(row, column)) return;
  }
  take_date(row, fmt::format("{} {} {}", row.text(2), row.text(3), row.text(4)), "%d %m %Y");
}

/// It has no time: it belongs to the sentences before it.
void NmeaEpochs::take_vtg(const Row& row) {
  if (!current_ || current_->velocity_from_rmc || is_blank(row, 2) || row.text(2) != "T") return;
  if (is_valid(row, 9)) current_->velocity = velocity(row, 1, 5);
}

void NmeaEpochs::begin_epoch(int64_t time_of_day_ns) {
  if (current_ && current_->time_of_day_ns == time_of_day_ns) return;
  finish();
  current_.emplace();
  current_->time_of_day_ns = time_of_day_ns;
}

void NmeaEpochs::take_timed(std::string_view type, const Row& row) {
  begin_epoch(sentence_time_ns(row));
  if (type == "GGA" || type == "GNS") return take_position(row, type == "GNS");
  if (type == "RMC") return take_rmc(row);
  current_->sigma = sigma(row);
}

void NmeaEpochs::take_position(const Row& row, bool gns) {
  if (current_->position) return;  // of a second talker, or written twice
  NmeaPosition position;
  const std::optional<FixQuality> found = gns ? quality_by_mode(row.text(6)) : quality(row);
  if (!found) {
    ++without_fix_;
    return;
  }
  position.quality = *found;
  position.latitude = angle(row, 2, 'N', 'S');
  position.longitude = angle(row, 4, 'E', 'W');
  position.details.satellites = count(row, 7);
  position.details.hdop = positive(row, 8);
  position.details.correction_age = positive(row, gns ? 11 : 13);
  position.height = row.number(9);
  position.geoid_separation = optional_number(row, gns ? 10 : 11);
  current_->position = position;
  current_->row = row;
}

/// u-blox's own: a position above the ellipsoid with its accuracy, or the date.
void NmeaEpochs::take_pubx(const Row& row) {
  constexpr double kKmPerHour = 1000.0 / kSecondsPerHour;
  if (row.size() < 4 || is_blank(row, 2)) return;
  if (row.text(1) == "04" && !is_blank(row, 3)) {
    return take_date(row, std::string(row.text(3)), "%d%m%y", 2);
  }
  if (row.text(1) != "00") return;
  begin_epoch(sentence_time_ns(row, 2));
  if (current_->position) return;
  const std::optional<FixQuality> found = quality_of_pubx(row.text(8));
  if (!found) {
    ++without_fix_;
    return;
  }
  NmeaPosition position;
  position.quality = *found;
  position.latitude = angle(row, 3, 'N', 'S');
  position.longitude = angle(row, 5, 'E', 'W');
  position.height = row.number(7);
  position.geoid_separation = 0;
  position.details.correction_age = positive(row, 14);
  position.details.hdop = positive(row, 15);
  position.details.satellites = count(row, 18);
  const std::optional<double> horizontal = positive(row, 9);
  const std::optional<double> vertical = positive(row, 10);
  if (horizontal && vertical && !current_->sigma) {
    const double axis = *horizontal / std::sqrt(2.0);  // it is that of both together
    current_->sigma = Eigen::Vector3d(axis, axis, *vertical);
  }
  if (!current_->velocity_from_rmc) current_->velocity = velocity(row, 12, 11, kKmPerHour);
  current_->position = position;
  current_->row = row;
}

void NmeaEpochs::take_date(const Row& row, const std::string& date, const char* format,
                           size_t time_column) {
  const std::optional<int64_t> midnight = midnight_ns(date, format);
  if (!midnight) row.fail(fmt::format("'{}' is no date; correct or remove the line", date));
  dated_ns_ = *midnight + sentence_time_ns(row, time_column);
}

void NmeaEpochs::take_rmc(const Row& row) {
  if (row.text(2) != "A") return;
  if (!is_blank(row, 9)) take_date(row, std::string(row.text(9)), "%d%m%y");
  if (!is_valid(row, 12)) return;
  take_flat(row);
  current_->velocity = velocity(row, 8, 7);
  current_->velocity_from_rmc = current_->velocity.has_value();
}

/// Counts in a file without heights only.
void NmeaEpochs::take_flat(const Row& row) {
  if (current_->flat || is_blank(row, 3) || is_blank(row, 5)) return;
  NmeaPosition position;
  position.quality = is_blank(row, 12)
                         ? FixQuality::unknown
                         : quality_by_mode(row.text(12)).value_or(FixQuality::unknown);
  position.latitude = angle(row, 3, 'N', 'S');
  position.longitude = angle(row, 5, 'E', 'W');
  current_->flat = position;
  if (!current_->position) current_->row = row;
}

int64_t stamp_near(int64_t time_of_day_ns, int64_t near_ns) {
  int64_t days = (near_ns - time_of_day_ns) / kNanosecondsPerDay;
  int64_t stamp = days * kNanosecondsPerDay + time_of_day_ns;
  if (near_ns - stamp > kNanosecondsPerDay / 2) stamp += kNanosecondsPerDay;
  if (stamp - near_ns > kNanosecondsPerDay / 2) stamp -= kNanosecondsPerDay;
  return stamp;
}

}  // namespace foucault::rawlog
