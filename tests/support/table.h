#pragma once

#include <string>
#include <vector>

namespace foucault::test {

/// A CSV file of numbers with one header line.
class Table {
 public:
  explicit Table(const std::string& path);

  const std::vector<std::string>& names() const { return names_; }
  std::size_t rows() const { return cells_.size(); }
  /// Throws std::out_of_range for a column that does not exist.
  std::vector<double> column(const std::string& name) const;

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<std::string>> cells_;
};

}  // namespace foucault::test
