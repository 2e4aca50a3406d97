#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "foucault/plot/figure.h"

/// A report folder: index.html, which opens from disk with no network, and beside it every figure
/// as PNG, SVG, CSV and JSON. Figures are live (zoom, values under the cursor) where scripts run,
/// else and in print the images.
namespace foucault::page {

/// A number a reader looks for first, shown large.
struct KeyNumber {
  std::string label;
  std::string value;
  std::string unit;
  std::string note;  ///< one line in small print; may be empty
};

/// The verdict on all that follows, above everything else.
struct Banner {
  bool alarming = false;  ///< it condemns
  std::string title;
  std::vector<std::string> lines;  ///< the reasons
};

struct Table {
  std::string title;
  std::string note;       ///< under the table; may be empty
  bool of_words = false;  ///< cells are text, not numbers: set to the left
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  ///< the first cell of a row names it
};

/// A heading with what stands under it, in this order: paragraphs, tables, figures, details.
struct Section {
  std::string title;
  std::vector<std::string> paragraphs = {};
  std::vector<Table> tables = {};
  std::vector<plot::Figure> figures = {};
  std::vector<Table> details = {};  ///< tables to look things up in
};

/// Long plain text, e.g. the configuration; folded on screen, open in print.
struct Listing {
  std::string title;
  std::string text;
};

/// Another page that belongs to this one.
struct Link {
  std::string text;
  std::string target;  ///< relative to the folder of the page
};

struct ReportPage {
  std::string title;
  std::string subtitle;
  std::vector<Link> links = {};
  /// The stamp at which the axes over time begin, if they have one: cursors tell the clock there.
  std::optional<int64_t> start_ns = {};
  std::optional<Banner> banner = {};
  std::vector<KeyNumber> key_numbers;
  std::vector<Section> sections;
  std::vector<Listing> listings;
  std::string footer;  ///< program and version
};

/// Writes `folder` (e.g. DIR/report): drawn beside it, then renamed, so that it appears whole or
/// not at all and replaces an older one. Figures are numbered over the whole page. Throws DataError
/// if it cannot be written or a figure name occurs twice.
void write_report(ReportPage page, const std::string& folder);

/// Reads the page and the numbers back from `folder` and draws all of it again: the same bytes.
/// Throws DataError if the folder holds no report.
void redraw_report(const std::string& folder);

}  // namespace foucault::page
