#include "foucault/export/track_kml.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "foucault/core/time.h"
#include "foucault/core/units.h"
#include "foucault/state/blocks.h"

namespace foucault::exports {
namespace {

constexpr int64_t kVertexInterval = 500'000'000;   // [ns]
constexpr int64_t kMarkInterval = 60'000'000'000;  // [ns]
constexpr int kMaxVertices = 10'000;               // viewers cut longer lines

struct AccuracyClass {
  const char* id;
  double max_sigma;    // horizontal [m]
  const char* colour;  // aabbggrr
};

constexpr std::array<AccuracyClass, 4> kClasses{
    {{"below-0.1m", 0.1, "ff3ca03c"},
     {"below-0.5m", 0.5, "ff1ec8e6"},
     {"below-2m", 2.0, "ff1e82f0"},
     {"above-2m", std::numeric_limits<double>::infinity(), "ff2828d2"}}};

/// sqrt of the trace of the horizontal block [m].
double horizontal_sigma(const state::Epoch& epoch) {
  return epoch.sigma_of(state::block::position).head<2>().norm();
}

std::size_t class_of(double sigma) {
  for (std::size_t i = 0; i < kClasses.size(); ++i) {
    if (sigma < kClasses[i].max_sigma) return i;
  }
  return kClasses.size() - 1;
}

std::string style(const AccuracyClass& accuracy) {
  return fmt::format(
      "<Style id=\"{}\"><LineStyle><color>{}</color><width>4</width></LineStyle>"
      "</Style>\n",
      accuracy.id, accuracy.colour);
}

}  // namespace

TrackKml::TrackKml(const std::filesystem::path& path) : file_(path) {
  file_.write(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<kml xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document><name>Foucault</name>\n");
  for (const AccuracyClass& accuracy : kClasses) file_.write(style(accuracy));
}

TrackKml::Vertex TrackKml::vertex(const Geodetic& position) {
  return {position.longitude * units::kDegrees, position.latitude * units::kDegrees,
          position.height};
}

std::string TrackKml::coordinates(const Vertex& vertex) {
  return fmt::format("{:.8f},{:.8f},{:.2f}\n", vertex.longitude_deg, vertex.latitude_deg,
                     vertex.height);
}

void TrackKml::epoch(const state::Epoch& epoch) {
  if (epoch.t_ns < next_vertex_ns_) return;
  next_vertex_ns_ = epoch.t_ns + kVertexInterval;
  const Vertex next = vertex(epoch.position);
  cut_at_antimeridian(next);
  const std::size_t accuracy_class = class_of(horizontal_sigma(epoch));
  if (epoch.t_ns >= next_mark_ns_) {
    end_line();
    mark(epoch);
  }
  if (line_class_ != accuracy_class || vertices_ >= kMaxVertices) {
    end_line();
    begin_line(accuracy_class);
  }
  last_vertex_ = next;
  file_.write(coordinates(next));
  ++vertices_;
}

/// Ends the line on this side of the meridian; the next one begins on the other.
void TrackKml::cut_at_antimeridian(const Vertex& next) {
  if (!last_vertex_ || std::abs(next.longitude_deg - last_vertex_->longitude_deg) <= 180) return;
  const Vertex& last = *last_vertex_;
  const double side = last.longitude_deg > 0 ? 180 : -180;
  const double next_longitude = next.longitude_deg + 2 * side;
  const double share = (side - last.longitude_deg) / (next_longitude - last.longitude_deg);
  Vertex edge{side, last.latitude_deg + share * (next.latitude_deg - last.latitude_deg),
              last.height + share * (next.height - last.height)};
  file_.write(coordinates(edge));
  end_line();
  edge.longitude_deg = -side;
  last_vertex_ = edge;
}

void TrackKml::begin_line(std::size_t accuracy_class) {
  file_.write(
      fmt::format("<Placemark><styleUrl>#{}</styleUrl><LineString><tessellate>1</tessellate>"
                  "<coordinates>\n{}",
                  kClasses[accuracy_class].id, last_vertex_ ? coordinates(*last_vertex_) : ""));
  line_class_ = accuracy_class;
  vertices_ = 1;
}

void TrackKml::end_line() {
  if (!line_class_) return;
  file_.write("</coordinates></LineString></Placemark>\n");
  line_class_.reset();
}

void TrackKml::mark(const state::Epoch& epoch) {
  next_mark_ns_ = epoch.t_ns + kMarkInterval;
  file_.write(
      fmt::format("<Placemark><name>{}</name><description>speed {:.1f} m/s, horizontal "
                  "standard deviation {:.3f} m</description><Point><coordinates>{}"
                  "</coordinates></Point></Placemark>\n",
                  utc_text(epoch.t_ns), epoch.velocity_n.head<2>().norm(), horizontal_sigma(epoch),
                  coordinates(vertex(epoch.position))));
}

void TrackKml::finish() {
  end_line();
  file_.write("</Document></kml>\n");
  file_.close();
}

}  // namespace foucault::exports
