#include "report_html.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "foucault/plot/axis_scale.h"
#include "foucault/plot/text.h"
#include "live_data.h"

namespace foucault::page {

using namespace plot;

namespace {

constexpr const char* kStyle = R"css(
:root { --ink: #1c1e21; --soft: #565b62; --line: #e1e4e8; --paper: #ffffff; --wash: #f6f7f9;
  --accent: #0072b2; --good: #007a5a; --bad: #b3261e; --alarm: #fdf1f0; color-scheme: light; }
@media screen and (prefers-color-scheme: dark) {
  :root { --ink: #e8eaed; --soft: #a9afb8; --line: #383d45; --paper: #17191d; --wash: #0f1114;
    --accent: #6db8e8; --good: #43c49c; --bad: #ff8a80; --alarm: #2c1a1a; color-scheme: dark; }
  .still img { filter: brightness(0.88); }
}
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
* { box-sizing: border-box; }
html { scroll-behavior: smooth; }
body { margin: 0; background: var(--wash); color: var(--ink);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif;
  font-variant-numeric: tabular-nums; }
main { max-width: 1120px; margin: 0 auto; padding: 48px 40px 64px; background: var(--paper);
  min-height: 100vh; box-shadow: 0 0 0 1px var(--line); }
header { border-bottom: 2px solid var(--ink); padding-bottom: 20px; margin-bottom: 28px; }
h1 { font-size: 34px; line-height: 1.15; letter-spacing: -0.02em; margin: 0 0 8px; }
header p { margin: 0; color: var(--soft); font-size: 17px; }
h2 { font-size: 22px; letter-spacing: -0.01em; margin: 52px 0 14px; }
p { max-width: 46em; }
a { color: var(--accent); text-decoration: none; }
a:hover { text-decoration: underline; }
.banner { border: 1px solid var(--line); border-left: 6px solid var(--good); border-radius: 8px;
  padding: 14px 18px; margin: 0 0 24px; overflow-wrap: anywhere; }
.banner b { color: var(--good); font-size: 19px; }
.banner p { margin: 4px 0 0; max-width: none; }
.banner.alarming { border-color: var(--bad); background: var(--alarm); }
.banner.alarming b { color: var(--bad); }
nav { display: flex; flex-wrap: wrap; gap: 6px 22px; margin: 0 0 28px; font-size: 15px; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(190px, 1fr)); gap: 14px;
  margin: 0 0 12px; padding: 0; }
.tile { border: 1px solid var(--line); border-radius: 8px; padding: 14px 16px 12px; margin: 0; }
.tile dt { color: var(--soft); font-size: 13.5px; line-height: 1.35; }
.tile dd { margin: 4px 0 0; font-size: 27px; font-weight: 650; letter-spacing: -0.02em;
  line-height: 1.2; }
.tile dd span { font-size: 15px; font-weight: 500; letter-spacing: 0; color: var(--soft); }
.tile dd.note { font-size: 13px; font-weight: 400; letter-spacing: 0; color: var(--soft); }
.tables { display: flex; flex-wrap: wrap; gap: 28px 48px; align-items: flex-start; }
.table { overflow-x: auto; margin: 10px 0 6px; max-width: 100%; }
table { border-collapse: collapse; font-size: 15px; border-top: 1.5px solid var(--ink);
  border-bottom: 1.5px solid var(--ink); min-width: 300px; }
caption { caption-side: top; text-align: left; font-weight: 650; padding-bottom: 6px; }
th, td { padding: 5px 22px 5px 0; text-align: right; border-bottom: 1px solid var(--line);
  vertical-align: baseline; }
th:last-child, td:last-child { padding-right: 2px; }
thead th { font-weight: 600; color: var(--soft); border-bottom: 1px solid var(--ink); }
th:first-child, td:first-child { text-align: left; font-weight: 400; }
table.words th, table.words td { text-align: left; }
tr:last-child td { border-bottom: none; }
.small { font-size: 13.5px; color: var(--soft); margin: 6px 0 0; }
figure { margin: 26px 0 40px; break-inside: avoid; }
figure img { width: 100%; height: auto; display: block; border: 1px solid var(--line);
  border-radius: 6px; }
.live { display: none; }
.is-live .live { display: block; }
.is-live .still { display: none; }
.live { border: 1px solid var(--line); border-radius: 6px; padding: 10px 10px 6px; }
.live-head { display: flex; justify-content: space-between; gap: 12px; align-items: baseline;
  font-size: 17px; }
.live canvas[tabindex] { display: block; width: 100%; touch-action: pan-y pinch-zoom;
  cursor: crosshair; }
.live button { font: inherit; font-size: 13px; color: inherit; background: none; padding: 1px 8px;
  border: 1px solid var(--line); border-radius: 5px; cursor: pointer; }
.live button[aria-pressed="false"] { opacity: 0.45; text-decoration: line-through; }
.tools { white-space: nowrap; }
.tools button { margin-left: 4px; min-width: 28px; }
.series { display: flex; flex-wrap: wrap; gap: 4px 8px; margin: 6px 0; font-size: 13px; }
.series canvas { width: 26px; height: 12px; margin-right: 5px; }
.readout { font-size: 13px; color: var(--soft); min-height: 2.8em; margin: 4px 2px 0;
  max-width: none; }
figcaption { margin-top: 10px; font-size: 15px; max-width: 58em; }
figcaption .files { white-space: nowrap; color: var(--soft); font-size: 13.5px;
  margin-left: 6px; }
details { border-top: 1px solid var(--line); padding: 12px 0; }
summary { cursor: pointer; font-weight: 600; }
pre { background: var(--wash); border: 1px solid var(--line); border-radius: 6px; padding: 14px 16px;
  font: 13px/1.5 ui-monospace, "DejaVu Sans Mono", monospace; white-space: pre-wrap;
  overflow-wrap: anywhere; }
footer { margin-top: 48px; padding-top: 14px; border-top: 1px solid var(--line);
  color: var(--soft); font-size: 13.5px; }
@media (max-width: 700px) {
  main { padding: 28px 14px; }
  h1 { font-size: 27px; }
  header p, figcaption { overflow-wrap: anywhere; }
  .tiles { grid-template-columns: repeat(auto-fit, minmax(140px, 1fr)); gap: 8px; }
  .tile dd { font-size: 21px; }
}
@media print {
  @page { size: A4; margin: 16mm 15mm; }
  body { background: none; font-size: 10.5pt; }
  main { max-width: none; padding: 0; box-shadow: none; }
  nav, figcaption .files { display: none; }
  h2 { break-after: avoid; margin-top: 9mm; }
  .banner, .tile, table, tr { break-inside: avoid; }
  figure { margin: 5mm 0 7mm; }
  .is-live .live { display: none; }
  .is-live .still { display: block; }
  figure img { border: none; width: auto; max-width: 100%; max-height: 215mm; margin: 0 auto; }
  .table { overflow: visible; }
  table { min-width: 0; font-size: 8.5pt; }
  th, td { padding-right: 10px; overflow-wrap: anywhere; }
  pre { font-size: 8pt; }
  a { color: inherit; }
}
)css";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string banner(const Banner& banner) {
  std::string html = fmt::format("<div class=\"banner{}\" role=\"{}\"><b>{}</b>\n",
                                 banner.alarming ? " alarming" : "",
                                 banner.alarming ? "alert" : "note", escaped(banner.title));
  for (const std::string& line : banner.lines) html += fmt::format("<p>{}</p>\n", escaped(line));
  return html + "</div>\n";
}

std::string tile(const KeyNumber& number) {
  const std::string unit =
      number.unit.empty() ? "" : fmt::format(" <span>{}</span>", escaped(number.unit));
  const std::string note =
      number.note.empty() ? "" : fmt::format("<dd class=\"note\">{}</dd>", escaped(number.note));
  return fmt::format("<dl class=\"tile\"><dt>{}</dt><dd>{}{}</dd>{}</dl>\n", escaped(number.label),
                     escaped(number.value), unit, note);
}

std::string row(const std::vector<std::string>& cells, const char* tag) {
  std::string html = "<tr>";
  for (const std::string& cell : cells) html += fmt::format("<{0}>{1}</{0}>", tag, escaped(cell));
  return html + "</tr>\n";
}

std::string table(const Table& table) {
  std::string html = table.of_words ? "<div class=\"table\"><table class=\"words\">\n"
                                    : "<div class=\"table\"><table>\n";
  if (!table.title.empty()) html += fmt::format("<caption>{}</caption>\n", escaped(table.title));
  if (!table.header.empty()) html += "<thead>" + row(table.header, "th") + "</thead>\n";
  html += "<tbody>\n";
  for (const std::vector<std::string>& cells : table.rows) html += row(cells, "td");
  html += "</tbody></table>\n";
  if (!table.note.empty()) html += fmt::format("<p class=\"small\">{}</p>\n", escaped(table.note));
  return html + "</div>\n";
}

std::string tables(const std::vector<Table>& tables) {
  if (tables.empty()) return {};
  std::string html = "<div class=\"tables\">\n";
  for (const Table& each : tables) html += table(each);
  return html + "</div>\n";
}

/// Broken lines are bounds.
bool is_curve(const Series& series) {
  return !series.y.empty() && series.in_legend && series.dash == Dash::none;
}

/// What one sees of a panel: where its last curve runs, and its note.
std::string seen_in(const Panel& panel) {
  const std::string name = panel.title.empty() ? panel.y.label : panel.title;
  std::string text = name;
  const auto curve = std::find_if(panel.series.rbegin(), panel.series.rend(), is_curve);
  if (panel.y.kind == AxisKind::category) {
    text = fmt::format("{}", fmt::join(panel.y.categories, ", "));
  } else if (curve != panel.series.rend()) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const double value : curve->y) {
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    const double factor = panel.y.shown_factor;
    if (low <= high) {
      text += fmt::format("{} from {} to {} {}", curve->label.empty() ? "" : " " + curve->label,
                          significant_text(low * factor), significant_text(high * factor),
                          shown_unit(panel.y));
    }
  }
  return joined({text, panel.note}, "; ");
}

/// For those who cannot see it.
std::string seen_in(const Figure& figure) {
  constexpr size_t kMost = 9;
  std::string text = figure.title + ".";
  for (size_t i = 0; i < std::min(kMost, figure.panels.size()); ++i) {
    const std::string seen = seen_in(figure.panels[i]);
    if (!seen.empty()) text += " " + seen + ".";
  }
  return text;
}

std::string figure(const Figure& figure, int number) {
  return fmt::format(
      "<figure id=\"{0}\">\n<a class=\"still\" href=\"{0}.png\"><img src=\"{0}.png\" alt=\"{1}\" "
      "width=\"{2:.0f}\" height=\"{3:.0f}\"></a>\n<figcaption><b>Figure {4}.</b> {5} "
      "<span class=\"files\"><a href=\"{0}.csv\">numbers (CSV)</a> · <a href=\"{0}.png\">image</a> "
      "· <a href=\"{0}.svg\">SVG</a>"
      "</span></figcaption>\n</figure>\n",
      figure.name, escaped(seen_in(figure)), 4 * figure.width_mm, 4 * figure.height_mm, number,
      escaped(figure.caption.empty() ? figure.title + "." : figure.caption));
}

std::string section(const Section& section, size_t index, int& figure_number) {
  std::string html =
      fmt::format("<section id=\"section-{}\">\n<h2>{}</h2>\n", index + 1, escaped(section.title));
  for (const std::string& text : section.paragraphs) {
    html += fmt::format("<p>{}</p>\n", escaped(text));
  }
  html += tables(section.tables);
  for (const Figure& each : section.figures) html += figure(each, ++figure_number);
  html += tables(section.details);
  return html + "</section>\n";
}

std::string links(const std::vector<Link>& links) {
  std::string html = "<nav aria-label=\"Pages\">\n";
  for (const Link& link : links) {
    html += fmt::format("<a href=\"{}\">{}</a>\n", escaped(link.target), escaped(link.text));
  }
  return html + "</nav>\n";
}

std::string navigation(const ReportPage& page) {
  std::string html = "<nav aria-label=\"Sections\">\n";
  for (size_t i = 0; i < page.sections.size(); ++i) {
    html += fmt::format("<a href=\"#section-{}\">{}</a>\n", i + 1, escaped(page.sections[i].title));
  }
  return html + "</nav>\n";
}

std::string listing(const Listing& listing) {
  return fmt::format("<details><summary>{}</summary>\n<pre>{}</pre></details>\n",
                     escaped(listing.title), escaped(listing.text));
}

}  // namespace

std::string to_html(const ReportPage& page) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<main>\n"
      "<header><h1>{0}</h1><p>{2}</p></header>\n",
      escaped(page.title), kStyle, escaped(page.subtitle));
  if (!page.links.empty()) html += links(page.links);
  if (page.banner) html += banner(*page.banner);
  if (page.sections.size() > 1) html += navigation(page);
  if (!page.key_numbers.empty()) html += "<div class=\"tiles\">\n";
  for (const KeyNumber& number : page.key_numbers) html += tile(number);
  if (!page.key_numbers.empty()) html += "</div>\n";
  int figure_number = 0;
  for (size_t i = 0; i < page.sections.size(); ++i) {
    html += section(page.sections[i], i, figure_number);
  }
  for (const Listing& each : page.listings) html += listing(each);
  if (!page.footer.empty()) html += fmt::format("<footer>{}</footer>\n", escaped(page.footer));
  html += "</main>\n";
  if (figure_number > 0) {
    html += fmt::format(
        "<script type=\"application/json\" id=\"live-data\">{}</script>\n<script>\n{}</script>\n",
        live_data(page), live_script());
  }
  return html + "</body>\n</html>\n";
}

}  // namespace foucault::page
