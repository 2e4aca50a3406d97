#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "foucault/export/solution_file.h"
#include "foucault/export/text_file.h"

namespace foucault::exports {

/// A track for Google Earth and other maps: lines coloured by the horizontal standard deviation of
/// the position, a vertex every half second, and a mark with time, speed and accuracy every minute.
/// Streams. Lines are cut at the 180 deg meridian, which maps would else cross the long way round.
/// They lie on the ground: the heights are ellipsoidal, and KML's are above the geoid.
class TrackKml : public SolutionFile {
 public:
  explicit TrackKml(const std::filesystem::path& path);

  void epoch(const state::Epoch& epoch) override;
  void finish() override;

 private:
  struct Vertex {
    double longitude_deg;
    double latitude_deg;
    double height;  ///< [m]
  };

  static Vertex vertex(const Geodetic& position);
  static std::string coordinates(const Vertex& vertex);
  void cut_at_antimeridian(const Vertex& next);
  void begin_line(std::size_t accuracy_class);
  void end_line();
  void mark(const state::Epoch& epoch);

  TextFile file_;
  std::optional<std::size_t> line_class_;  ///< of the line that is open
  int vertices_ = 0;
  std::optional<Vertex> last_vertex_;
  int64_t next_vertex_ns_ = 0;
  int64_t next_mark_ns_ = 0;
};

}  // namespace foucault::exports
