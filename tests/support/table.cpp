#include "support/table.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace foucault::test {
namespace {

std::vector<std::string> split_at_commas(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> cells;
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

Table::Table(const std::string& path) {
  std::ifstream stream(path);
  std::string line;
  if (!std::getline(stream, line)) throw std::runtime_error("no table in " + path);
  names_ = split_at_commas(line);
  while (std::getline(stream, line)) cells_.push_back(split_at_commas(line));
}

std::vector<double> Table::column(const std::string& name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) throw std::out_of_range("no column " + name);
  const auto index = static_cast<std::size_t>(found - names_.begin());
  std::vector<double> values;
  for (const std::vector<std::string>& row : cells_) values.push_back(std::stod(row.at(index)));
  return values;
}

}  // namespace foucault::test
