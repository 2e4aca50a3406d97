#pragma once

#include <string>
#include <vector>

#include "foucault/plot/figure.h"

namespace foucault::content {

/// How a method is drawn, in every figure alike: told apart by colour, by dash and, as points, by
/// shape, so that a print in grey tells them, too.
struct MethodLook {
  plot::Ink ink = plot::Ink::blue;
  plot::Dash dash = plot::Dash::none;
  plot::Shape shape = plot::Shape::dot;
};

/// Names that are no method of the program take looks of their own by their place in `order`.
MethodLook look_of(const std::string& method, const std::vector<std::string>& order = {});

}  // namespace foucault::content
