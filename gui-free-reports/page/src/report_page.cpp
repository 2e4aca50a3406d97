#include "foucault/page/report_page.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <future>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "foucault/core/error.h"
#include "foucault/plot/figure_store.h"
#include "foucault/plot/files.h"
#include "report_html.h"

namespace foucault::page {

using namespace plot;

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kPageFile = "report.json";

// ---- the page as JSON; figures by name

Json table_to_json(const Table& t) {
  return {{"title", t.title},
          {"note", t.note},
          {"of_words", t.of_words},
          {"header", t.header},
          {"rows", t.rows}};
}

Table table_from_json(const Json& j) {
  Table t;
  t.title = j.at("title").get<std::string>();
  t.note = j.at("note").get<std::string>();
  t.of_words = j.at("of_words").get<bool>();
  t.header = j.at("header").get<std::vector<std::string>>();
  t.rows = j.at("rows").get<std::vector<std::vector<std::string>>>();
  return t;
}

Json section_to_json(const Section& s) {
  Json json{{"title", s.title},
            {"paragraphs", s.paragraphs},
            {"tables", Json::array()},
            {"figures", Json::array()},
            {"details", Json::array()}};
  for (const Table& table : s.details) json["details"].push_back(table_to_json(table));
  for (const Table& table : s.tables) json["tables"].push_back(table_to_json(table));
  for (const Figure& figure : s.figures) json["figures"].push_back(figure.name);
  return json;
}

Section section_from_json(const Json& j, const std::string& folder) {
  Section s;
  s.title = j.at("title").get<std::string>();
  s.paragraphs = j.at("paragraphs").get<std::vector<std::string>>();
  for (const Json& table : j.at("tables")) s.tables.push_back(table_from_json(table));
  for (const Json& name : j.at("figures")) {
    s.figures.push_back(load_figure(folder, name.get<std::string>()));
  }
  for (const Json& table : j.value("details", Json::array())) {
    s.details.push_back(table_from_json(table));
  }
  return s;
}

Json banner_to_json(const Banner& b) {
  return {{"alarming", b.alarming}, {"title", b.title}, {"lines", b.lines}};
}

Banner banner_from_json(const Json& j) {
  return {j.at("alarming").get<bool>(), j.at("title").get<std::string>(),
          j.at("lines").get<std::vector<std::string>>()};
}

Json page_to_json(const ReportPage& page) {
  Json json{{"title", page.title},       {"subtitle", page.subtitle},
            {"footer", page.footer},     {"key_numbers", Json::array()},
            {"sections", Json::array()}, {"listings", Json::array()}};
  if (page.banner) json["banner"] = banner_to_json(*page.banner);
  for (const KeyNumber& n : page.key_numbers) {
    json["key_numbers"].push_back(
        {{"label", n.label}, {"value", n.value}, {"unit", n.unit}, {"note", n.note}});
  }
  for (const Section& section : page.sections) json["sections"].push_back(section_to_json(section));
  for (const Listing& l : page.listings) {
    json["listings"].push_back({{"title", l.title}, {"text", l.text}});
  }
  return json;
}

ReportPage page_from_json(const Json& j, const std::string& folder) {
  ReportPage page;
  page.title = j.at("title").get<std::string>();
  page.subtitle = j.at("subtitle").get<std::string>();
  page.footer = j.at("footer").get<std::string>();
  if (j.contains("banner")) page.banner = banner_from_json(j.at("banner"));
  for (const Json& n : j.at("key_numbers")) {
    page.key_numbers.push_back({n.at("label").get<std::string>(), n.at("value").get<std::string>(),
                                n.at("unit").get<std::string>(), n.at("note").get<std::string>()});
  }
  for (const Json& section : j.at("sections")) {
    page.sections.push_back(section_from_json(section, folder));
  }
  for (const Json& l : j.at("listings")) {
    page.listings.push_back({l.at("title").get<std::string>(), l.at("text").get<std::string>()});
  }
  return page;
}

// ---- writing

std::vector<const Figure*> figures_of(const ReportPage& page) {
  std::vector<const Figure*> figures;
  std::set<std::string> names;
  for (const Section& section : page.sections) {
    for (const Figure& figure : section.figures) {
      if (!names.insert(figure.name).second) {
        throw DataError("report: two figures are named '" + figure.name + "'");
      }
      figures.push_back(&figure);
    }
  }
  return figures;
}

/// Draws on as many threads as there are processors, each with a renderer of its own.
void save_figures(const std::vector<const Figure*>& figures, const std::string& folder) {
  const Fonts fonts = find_fonts();
  std::atomic<size_t> next{0};
  const auto work = [&] {
    Renderer renderer(fonts);
    for (size_t i = next++; i < figures.size(); i = next++) {
      save_figure(*figures[i], folder, renderer);
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

void write_report(const ReportPage& page, const std::string& folder) {
  const std::vector<const Figure*> figures = figures_of(page);
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
