// Reads YAML scalars strictly, and describes for messages what was found and what was wanted. Only
// YamlMap uses it.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include <yaml-cpp/yaml.h>

#include "common/number_text.h"
#include "common/strict_yaml.h"

namespace bevloc {

inline int line_of(const YAML::Node& node) {
  return node.Mark().line + 1;
}

inline std::string describe(const YAML::Node& node) {
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      return node.Tag() == "!" ? fmt::format("\"{}\"", node.Scalar()) : node.Scalar();
    case YAML::NodeType::Sequence:
      return fmt::format("a list of {}", node.size());
    case YAML::NodeType::Map:
      return "a mapping";
    default:
      return "nothing";
  }
}

template <typename T>
constexpr std::string_view type_name() {
  if constexpr (std::is_same_v<T, bool>) {
    return "true or false";
  } else if constexpr (std::is_same_v<T, std::string>) {
    return "a text";
  } else if constexpr (std::is_floating_point_v<T>) {
    return "a number";
  } else {
    return "a whole number";
  }
}

template <typename T>
std::string describe_wanted(const Wanted<T>& wanted) {
  if (wanted.description.empty()) return std::string(type_name<T>());
  if constexpr (std::is_arithmetic_v<T>) {
    return fmt::format("{}, {}", type_name<T>(), wanted.description);
  }
  return wanted.description;
}

template <typename T>
std::optional<T> number_from(std::string_view text) {
  if constexpr (std::is_floating_point_v<T>) {
    const auto value = parse_number<T>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
  } else {
    if (text.starts_with("0x-")) return std::nullopt;
    return text.starts_with("0x") ? parse_number<T>(text.substr(2), 16) : parse_number<T>(text);
  }
}

template <typename T>
std::optional<T> scalar_from(const YAML::Node& node) {
  if (!node.IsScalar()) return std::nullopt;
  const std::string& text = node.Scalar();
  if constexpr (std::is_same_v<T, std::string>) {
    return text;
  } else {
    const bool is_quoted = node.Tag() == "!";
    if (is_quoted) return std::nullopt;
    if constexpr (std::is_same_v<T, bool>) {
      if (text == "true") return true;
      if (text == "false") return false;
      return std::nullopt;
    } else {
      return number_from<T>(text);
    }
  }
}

template <typename T>
std::optional<T> accepted_scalar(const YAML::Node& node, const Wanted<T>& wanted) {
  const std::optional<T> value = scalar_from<T>(node);
  return value && wanted.accepts && !wanted.accepts(*value) ? std::nullopt : value;
}

}  // namespace bevloc
