#pragma once

#include <string>
#include <vector>

#include "foucault/plot/renderer.h"

/// What draws is a library of its own, since OpenCV brings 100 others: who links foucault::plot has
/// it, the program loads it when it first draws.
namespace foucault::plot {

/// Renderer, as it is there.
class Drawing {
 public:
  virtual ~Drawing() = default;
  virtual std::string svg(const Figure& figure) = 0;
  virtual std::vector<unsigned char> png(const Figure& figure) = 0;
};

}  // namespace foucault::plot

/// A new one, to be deleted; null in a program that has yet to load it.
extern "C" [[gnu::weak, gnu::visibility("default")]] foucault::plot::Drawing*
foucault_renderer_part(const foucault::plot::Fonts& fonts);
