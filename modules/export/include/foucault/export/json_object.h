#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

namespace foucault::exports {

using Json = nlohmann::ordered_json;

/// Builds a JSON object key by key.
class Object {
 public:
  template <class Value>
  Object& with(const char* key, Value&& value) {
    json_[key] = std::forward<Value>(value);
    return *this;
  }
  operator const Json&() const { return json_; }

 private:
  Json json_ = Json::object();
};

inline Json number_or_null(const std::optional<double>& value, double factor = 1) {
  return value ? Json(*value * factor) : Json(nullptr);
}

/// `value` of samples if there are any.
template <class Value>
Json json_if(bool exists, const Value& value) {
  return exists ? Json(value) : Json(nullptr);
}

}  // namespace foucault::exports
