#pragma once

#include <string>
#include <vector>

/// Numbers as readers want them, and words in a row.
namespace foucault::plot {

/// A number with a true minus sign and `decimals` decimals; thousands parted from 10 000 on; "–" if
/// it is not finite.
std::string number_text(double value, int decimals);

/// A number with `significant` digits, as number_text.
std::string significant_text(double value, int significant = 3);

/// "10⁻⁵".
std::string power_of_ten(int exponent);

/// The parts that are not empty, with `between` them.
std::string joined(const std::vector<std::string>& parts, const std::string& between);

}  // namespace foucault::plot
