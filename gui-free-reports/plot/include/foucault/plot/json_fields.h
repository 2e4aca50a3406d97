#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "foucault/core/error.h"

/// Structs as JSON objects, and back, by one list of their fields; enumerators by their words.
/// In the namespace of a struct T or an enum E one writes
///   static auto fields_of(const T*) { return std::tuple(std::pair("key", &T::member), ...); }
///   static auto words_of(E) { return std::array{std::pair(E::first, "first"), ...}; }
/// Every key has to be there when it is read: nlohmann::json::exception; an unknown word is a
/// DataError; an optional is null if it is empty.
namespace nlohmann {

template <class T>
struct adl_serializer<T, std::void_t<decltype(fields_of(static_cast<const T*>(nullptr)))>> {
  template <class Json>
  static void to_json(Json& json, const T& value) {
    json = Json::object();
    std::apply([&](auto... field) { ((json[field.first] = value.*field.second), ...); },
               fields_of(&value));
  }
  template <class Json>
  static void from_json(const Json& json, T& value) {
    std::apply([&](auto... field) { (json.at(field.first).get_to(value.*field.second), ...); },
               fields_of(&value));
  }
};

template <class Enum>
struct adl_serializer<Enum, std::void_t<decltype(words_of(Enum{}))>> {
  template <class Json>
  static void to_json(Json& json, Enum value) {
    for (const auto& [key, word] : words_of(value)) {
      if (key == value) json = word;
    }
  }
  template <class Json>
  static void from_json(const Json& json, Enum& value) {
    const std::string wanted = json.template get<std::string>();
    for (const auto& [key, word] : words_of(value)) {
      if (wanted != word) continue;
      value = key;
      return;
    }
    throw foucault::DataError("unknown word '" + wanted + "'");
  }
};

template <class T>
struct adl_serializer<std::optional<T>> {
  template <class Json>
  static void to_json(Json& json, const std::optional<T>& value) {
    json = value ? Json(*value) : Json();
  }
  template <class Json>
  static void from_json(const Json& json, std::optional<T>& value) {
    value = json.is_null() ? std::optional<T>() : json.template get<T>();
  }
};

}  // namespace nlohmann
