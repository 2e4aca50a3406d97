#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "foucault/core/measurement.h"

namespace foucault {

/// A sequence of variants with each alternative in a row of its own: an IMU increment takes 81
/// bytes there, a Measurement, which is as long as the longest of them, nearly 300.
template <class Variant>
class PackedSequence;

template <class... Value>
class PackedSequence<std::variant<Value...>> {
 public:
  using Variant = std::variant<Value...>;

  void push_back(const Variant& value) {
    kinds_.push_back(static_cast<uint8_t>(value.index()));
    std::visit(
        [this](const auto& v) {
          std::get<std::vector<std::decay_t<decltype(v)>>>(rows_).push_back(v);
        },
        value);
  }
  std::size_t size() const { return kinds_.size(); }

  /// Where someone stands who walks through it.
  class Place {
   public:
    bool at_end(const PackedSequence& sequence) const { return place_ == sequence.size(); }
    Variant next(const PackedSequence& sequence) { return take<0>(sequence); }

   private:
    template <std::size_t kKind>
    Variant take(const PackedSequence& sequence) {
      if constexpr (kKind + 1 < sizeof...(Value)) {
        if (sequence.kinds_[place_] != kKind) return take<kKind + 1>(sequence);
      }
      ++place_;
      return Variant(std::in_place_index<kKind>,
                     std::get<kKind>(sequence.rows_)[in_rows_[kKind]++]);
    }

    std::size_t place_ = 0;
    std::array<std::size_t, sizeof...(Value)> in_rows_{};
  };

 private:
  std::vector<uint8_t> kinds_;
  std::tuple<std::vector<Value>...> rows_;
};

using PackedMeasurements = PackedSequence<Measurement>;

}  // namespace foucault
