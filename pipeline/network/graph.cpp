#include "pipeline/network/graph.h"

#include <cassert>
#include <cstring>
#include <functional>
#include <numeric>

#include <fmt/ranges.h>

#include "pipeline/network/load_error.h"

namespace bevloc::nn {
namespace {

template <typename Element, typename Wanted>
std::vector<Wanted> convert(const Tensor& tensor) {
  std::vector<Element> elements(tensor.bytes.size() / sizeof(Element));
  std::memcpy(elements.data(), tensor.bytes.data(), tensor.bytes.size());
  return {elements.begin(), elements.end()};
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

int64_t element_count(const Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), int64_t{1}, std::multiplies<>());
}

std::string to_string(const Shape& shape) {
  return fmt::format("[{}]", fmt::join(shape, ", "));
}

std::vector<float> Tensor::floats() const {
  switch (type) {
    case ElementType::kFloat32:
      return convert<float, float>(*this);
    case ElementType::kUint8:
      return convert<uint8_t, float>(*this);
    case ElementType::kInt8:
      return convert<int8_t, float>(*this);
    case ElementType::kInt32:
      return convert<int32_t, float>(*this);
    case ElementType::kInt64:
      return convert<int64_t, float>(*this);
  }
  return {};
}

std::vector<int64_t> Tensor::integers() const {
  switch (type) {
    case ElementType::kUint8:
      return convert<uint8_t, int64_t>(*this);
    case ElementType::kInt8:
      return convert<int8_t, int64_t>(*this);
    case ElementType::kInt32:
      return convert<int32_t, int64_t>(*this);
    case ElementType::kInt64:
      return convert<int64_t, int64_t>(*this);
    case ElementType::kFloat32:
      break;
  }
  refuse("a constant of shape {} is float, wanted integers", to_string(shape));
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
