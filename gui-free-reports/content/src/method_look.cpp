#include "method_look.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace foucault::content {

using namespace plot;

namespace {

constexpr std::array<std::pair<std::string_view, MethodLook>, 6> kMethods{{
    {"ekf", {Ink::orange, Dash::dashes, Shape::diamond}},
    {"refined", {Ink::blue, Dash::none, Shape::dot}},
    {"rough", {Ink::vermillion, Dash::dash_dot, Shape::triangle}},
    {"full", {Ink::purple, Dash::dots, Shape::square}},
    {"rts", {Ink::green, Dash::long_dashes, Shape::plus}},
    {"batch", {Ink::black, Dash::none, Shape::star}},
}};

constexpr std::array<MethodLook, 6> kOthers{{
    {Ink::sky, Dash::dash_dot, Shape::ring},
    {Ink::green, Dash::dots, Shape::cross},
    {Ink::gray, Dash::dashes, Shape::triangle},
    {Ink::vermillion, Dash::long_dashes, Shape::diamond},
    {Ink::purple, Dash::dashes, Shape::square},
    {Ink::blue, Dash::dots, Shape::plus},
}};

bool is_known(std::string_view method) {
  return std::any_of(kMethods.begin(), kMethods.end(),
                     [&](const auto& known) { return known.first == method; });
}

}  // namespace

MethodLook look_of(const std::string& method, const std::vector<std::string>& order) {
  for (const auto& [name, look] : kMethods) {
    if (name == method) return look;
  }
  size_t place = 0;
  for (const std::string& other : order) {
    if (other == method) break;
    if (!is_known(other)) ++place;
  }
  return kOthers[place % kOthers.size()];
}

}  // namespace foucault::content
