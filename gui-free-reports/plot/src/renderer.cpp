#include "foucault/plot/renderer.h"

#include "foucault/core/loaded_part.h"
#include "renderer_part.h"

namespace foucault::plot {
namespace {

std::unique_ptr<Drawing> new_drawing(const Fonts& fonts) {
  using Entry = decltype(&foucault_renderer_part);
  static const Entry entry =
      foucault_renderer_part != nullptr
          ? &foucault_renderer_part
          : reinterpret_cast<Entry>(load_part("foucault_renderer", "foucault_renderer_part"));
  return std::unique_ptr<Drawing>(entry(fonts));
}

}  // namespace

Renderer::Renderer(const Fonts& fonts) : drawing_(new_drawing(fonts)) {}

Renderer::~Renderer() = default;

std::string Renderer::svg(const Figure& figure) { return drawing_->svg(figure); }

std::vector<unsigned char> Renderer::png(const Figure& figure) { return drawing_->png(figure); }

}  // namespace foucault::plot
