#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

#include "foucault/store/bytes.h"

/// Records of structures: one list of fields, shown to a Recorder or a Player, writes and reads.
namespace foucault::store {

/// Writes what it is shown. Player has the same calls: one list of fields serves both.
class Recorder {
 public:
  void field(const int64_t& value) { writer_.put(value); }
  void field(const double& value) { writer_.put(value); }
  void field(const std::string& text) { writer_.put(std::string_view(text)); }
  std::size_t size(std::size_t count) {
    writer_.put(static_cast<uint64_t>(count));
    return count;
  }
  const std::string& bytes() const { return writer_.bytes(); }

 private:
  ByteWriter writer_;
};

class Player {
 public:
  explicit Player(std::string_view bytes) : reader_(bytes) {}
  void field(int64_t& value) { value = reader_.integer(); }
  void field(double& value) { value = reader_.number(); }
  void field(std::string& text) { text = reader_.text(); }
  std::size_t size(std::size_t) { return reader_.count(); }
  void finish() const { reader_.finish(); }

 private:
  ByteReader reader_;
};

/// Count, and each value as `visit` shows it to the archive.
template <class Archive, class List, class Visit>
void list(Archive& archive, List& values, Visit visit) {
  const std::size_t count = archive.size(values.size());
  if constexpr (std::is_const_v<List>) {
    for (const auto& value : values) visit(value);
  } else {
    for (std::size_t i = 0; i < count; ++i) visit(values.emplace_back());
  }
}

/// Whether it is there, and what `visit` shows of it.
template <class Archive, class Optional, class Visit>
void optional(Archive& archive, Optional& value, Visit visit) {
  const bool is_there = archive.size(value ? 1 : 0) != 0;
  if (!is_there) return;
  if constexpr (!std::is_const_v<Optional>) value.emplace();
  visit(*value);
}

/// An enumerator, a bool or an int.
template <class Archive, class Integral>
void integral(Archive& archive, Integral& value) {
  auto number = static_cast<int64_t>(value);
  archive.field(number);
  if constexpr (!std::is_const_v<Integral>) value = static_cast<Integral>(number);
}

}  // namespace foucault::store
