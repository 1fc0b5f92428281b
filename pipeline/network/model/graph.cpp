#include "pipeline/network/model/graph.h"

#include <cassert>
#include <cstring>
#include <functional>
#include <numeric>

#include <fmt/ranges.h>

#include "pipeline/network/model/load_error.h"

namespace bevloc::nn {
namespace {

template <typename Element, typename Wanted>
std::vector<Wanted> converted_from(const Tensor& tensor) {
  std::vector<Element> elements(tensor.bytes.size() / sizeof(Element));
  std::memcpy(elements.data(), tensor.bytes.data(), tensor.bytes.size());
  return {elements.begin(), elements.end()};
}

template <typename Wanted>
std::vector<Wanted> converted(const Tensor& tensor) {
  switch (tensor.type) {
    case ElementType::kFloat32:
      return converted_from<float, Wanted>(tensor);
    case ElementType::kUint8:
      return converted_from<uint8_t, Wanted>(tensor);
    case ElementType::kInt8:
      return converted_from<int8_t, Wanted>(tensor);
    case ElementType::kInt32:
      return converted_from<int32_t, Wanted>(tensor);
    case ElementType::kInt64:
      return converted_from<int64_t, Wanted>(tensor);
  }
  return {};
}

template <typename Wanted>
Wanted attribute(const Node& node, const std::string& name, Wanted fallback) {
  const auto found = node.attributes.find(name);
  if (found == node.attributes.end()) return fallback;
  const Wanted* value = std::get_if<Wanted>(&found->second);
  if (value == nullptr) refuse("{}: attribute '{}' has the wrong type", node.label, name);
  return *value;
}

}  // namespace

size_t size_in_bytes(ElementType type) {
  switch (type) {
    case ElementType::kFloat32:
    case ElementType::kInt32:
      return 4;
    case ElementType::kUint8:
    case ElementType::kInt8:
      return 1;
    case ElementType::kInt64:
      return 8;
  }
  return 0;
}

std::string_view name_of(ElementType type) {
  switch (type) {
    case ElementType::kFloat32:
      return "float";
    case ElementType::kUint8:
      return "uint8";
    case ElementType::kInt8:
      return "int8";
    case ElementType::kInt32:
      return "int32";
    case ElementType::kInt64:
      return "int64";
  }
  return "";
}

bool is_8_bit(ElementType type) {
  return type == ElementType::kUint8 || type == ElementType::kInt8;
}

int64_t element_count(const Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), int64_t{1}, std::multiplies<>());
}

std::string to_string(const Shape& shape) {
  return fmt::format("[{}]", fmt::join(shape, ", "));
}

std::vector<float> Tensor::floats() const {
  return converted<float>(*this);
}

std::vector<int64_t> Tensor::integers() const {
  if (type == ElementType::kFloat32) {
    refuse("a constant of shape {} is float, wanted integers", to_string(shape));
  }
  return converted<int64_t>(*this);
}

int64_t Node::integer(const std::string& name, int64_t fallback) const {
  return attribute<int64_t>(*this, name, fallback);
}

std::string Node::text(const std::string& name, const std::string& fallback) const {
  return attribute<std::string>(*this, name, fallback);
}

std::vector<int64_t> Node::integers(const std::string& name, std::vector<int64_t> fallback) const {
  return attribute<std::vector<int64_t>>(*this, name, std::move(fallback));
}

}  // namespace bevloc::nn
