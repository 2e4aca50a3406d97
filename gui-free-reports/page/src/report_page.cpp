#include "foucault/page/report_page.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <future>
#include <set>
#include <thread>

#include "foucault/core/error.h"
#include "foucault/plot/figure_store.h"
#include "foucault/plot/files.h"
#include "foucault/plot/json_fields.h"
#include "report_html.h"

namespace foucault::page {

using namespace plot;

static auto fields_of(const Table*) {
  return std::tuple(std::pair("title", &Table::title), std::pair("note", &Table::note),
                    std::pair("of_words", &Table::of_words), std::pair("header", &Table::header),
                    std::pair("rows", &Table::rows));
}

static auto fields_of(const Banner*) {
  return std::tuple(std::pair("alarming", &Banner::alarming), std::pair("title", &Banner::title),
                    std::pair("lines", &Banner::lines));
}

static auto fields_of(const KeyNumber*) {
  return std::tuple(std::pair("label", &KeyNumber::label), std::pair("value", &KeyNumber::value),
                    std::pair("unit", &KeyNumber::unit), std::pair("note", &KeyNumber::note));
}

static auto fields_of(const Link*) {
  return std::tuple(std::pair("text", &Link::text), std::pair("target", &Link::target));
}

static auto fields_of(const Listing*) {
  return std::tuple(std::pair("title", &Listing::title), std::pair("text", &Listing::text));
}

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kPageFile = "report.json";

// ---- the page as JSON; figures by name

Json section_to_json(const Section& s) {
  Json names = Json::array();
  for (const Figure& figure : s.figures) names.push_back(figure.name);
  return {{"title", s.title},
          {"paragraphs", s.paragraphs},
          {"tables", s.tables},
          {"figures", names},
          {"details", s.details}};
}

Section section_from_json(const Json& j, const std::string& folder) {
  Section s{j.at("title"), j.at("paragraphs"), j.at("tables")};
  for (const Json& name : j.at("figures")) s.figures.push_back(load_figure(folder, name));
  s.details = j.value("details", std::vector<Table>());
  return s;
}

Json page_to_json(const ReportPage& page) {
  Json json{{"title", page.title},       {"subtitle", page.subtitle},
            {"footer", page.footer},     {"key_numbers", page.key_numbers},
            {"sections", Json::array()}, {"listings", page.listings}};
  for (const Section& section : page.sections) json["sections"].push_back(section_to_json(section));
  if (page.banner) json["banner"] = *page.banner;
  if (!page.links.empty()) json["links"] = page.links;
  if (page.start_ns) json["start_ns"] = *page.start_ns;
  return json;
}

ReportPage page_from_json(const Json& j, const std::string& folder) {
  ReportPage page;
  j.at("title").get_to(page.title);
  j.at("subtitle").get_to(page.subtitle);
  j.at("footer").get_to(page.footer);
  page.links = j.value("links", std::vector<Link>());
  if (j.contains("start_ns")) page.start_ns = j.at("start_ns").get<int64_t>();
  if (j.contains("banner")) page.banner = j.at("banner").get<Banner>();
  j.at("key_numbers").get_to(page.key_numbers);
  for (const Json& section : j.at("sections")) {
    page.sections.push_back(section_from_json(section, folder));
  }
  j.at("listings").get_to(page.listings);
  return page;
}

// ---- writing

std::vector<Figure*> figures_of(ReportPage& page) {
  std::vector<Figure*> figures;
  std::set<std::string> names;
  for (Section& section : page.sections) {
    for (Figure& figure : section.figures) {
      if (!names.insert(figure.name).second) {
        throw DataError("report: two figures are named '" + figure.name + "'");
      }
      figures.push_back(&figure);
    }
  }
  return figures;
}

/// Draws on as many threads as there are processors, each with a renderer of its own. The figures
/// become what was written, rounded.
void save_figures(const std::vector<Figure*>& figures, const std::string& folder) {
  const Fonts fonts = find_fonts();
  std::atomic<size_t> next{0};
  const auto work = [&] {
    Renderer renderer(fonts);
    for (size_t i = next++; i < figures.size(); i = next++) {
      *figures[i] = save_figure(*figures[i], folder, renderer);
    }
  };
  const size_t threads = std::clamp<size_t>(std::thread::hardware_concurrency(), 1,
                                            std::max<size_t>(1, figures.size()));
  std::vector<std::future<void>> workers;
  for (size_t i = 0; i < std::min<size_t>(threads, 4); ++i) {
    workers.push_back(std::async(std::launch::async, work));
  }
  for (std::future<void>& worker : workers) worker.wait();
  for (std::future<void>& worker : workers) worker.get();
}

/// A folder that is filled beside its target and takes its place on commit(), or vanishes.
class PendingFolder {
 public:
  explicit PendingFolder(const std::string& target)
      : target_(target), suffix_(std::to_string(getpid())), pending_(target + ".part-" + suffix_) {
    check_target();
    std::error_code error;
    fs::remove_all(pending_, error);
    fs::create_directories(pending_, error);
    if (error) throw DataError(pending_.string() + ": cannot be made (" + error.message() + ")");
  }
  ~PendingFolder() {
    std::error_code error;
    fs::remove_all(pending_, error);
  }
  PendingFolder(const PendingFolder&) = delete;
  PendingFolder& operator=(const PendingFolder&) = delete;

  std::string path() const { return pending_.string(); }

  void commit() {
    const fs::path old = target_.string() + ".old-" + suffix_;
    std::error_code error;
    if (fs::exists(target_)) fs::rename(target_, old, error);
    if (!error) fs::rename(pending_, target_, error);
    if (error) throw DataError(target_.string() + ": cannot be replaced (" + error.message() + ")");
    fs::remove_all(old, error);
  }

 private:
  /// Nothing but an older report may be replaced.
  void check_target() const {
    if (!fs::exists(target_)) return;
    const bool replaceable =
        fs::is_directory(target_) && (fs::is_empty(target_) || fs::exists(target_ / kPageFile));
    if (replaceable) return;
    throw DataError(target_.string() +
                    ": exists and is not a report; remove it or choose another folder");
  }

  fs::path target_;
  std::string suffix_;
  fs::path pending_;
};

std::string without_trailing_slash(std::string folder) {
  while (folder.size() > 1 && folder.back() == '/') folder.pop_back();
  return folder;
}

}  // namespace

void write_report(ReportPage page, const std::string& folder) {
  const std::vector<Figure*> figures = figures_of(page);
  PendingFolder pending(without_trailing_slash(folder));
  save_figures(figures, pending.path());
  write_file(pending.path() + "/index.html", to_html(page));
  write_file(pending.path() + "/" + kPageFile, page_to_json(page).dump(1) + "\n");
  pending.commit();
}

void redraw_report(const std::string& folder) {
  const std::string path = folder + "/" + kPageFile;
  try {
    write_report(page_from_json(Json::parse(read_file(path)), folder), folder);
  } catch (const nlohmann::json::exception& error) {
    throw DataError(path + ": " + error.what());
  }
}

}  // namespace foucault::page
