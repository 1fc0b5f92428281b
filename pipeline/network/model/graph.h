// A model as its file describes it: an ONNX graph without protobuf types and with known operators
// only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace bevloc::nn {

enum class ElementType { kFloat32, kUint8, kInt8, kInt32, kInt64 };

size_t size_in_bytes(ElementType type);
std::string_view name_of(ElementType type);

/// Whether the type is that of a quantized activation: uint8 or int8.
bool is_8_bit(ElementType type);

using Shape = std::vector<int64_t>;

int64_t element_count(const Shape& shape);
std::string to_string(const Shape& shape);

/// A constant of the model.
struct Tensor {
  ElementType type = ElementType::kFloat32;
  Shape shape;
  std::vector<std::byte> bytes;

  /// The elements, converted to float.
  std::vector<float> floats() const;
  /// The elements, converted to int64. Throws LoadError if they are floats.
  std::vector<int64_t> integers() const;
};

enum class Operator {
  kAdd,
  kConcat,
  kConstant,
  kConv,
  kDepthToSpace,
  kDequantizeLinear,
  kGather,
  kIdentity,
  kMaxPool,
  kMul,
  kQuantizeLinear,
  kReduceSum,
  kRelu,
  kReshape,
  kResize,
  kSpaceToDepth,
  kTranspose,
};

using Attribute = std::variant<int64_t, float, std::string, std::vector<int64_t>>;

struct Node {
  Operator op = Operator::kIdentity;
  /// Identifies the node in messages: "node 'trunk/stem' (Conv)".
  std::string label;
  std::vector<std::string> inputs;  ///< "" for an optional input that is not used
  std::string output;
  std::map<std::string, Attribute> attributes;

  /// The value of an attribute, or `fallback` if the node does not have it. Throws LoadError if the
  /// attribute has another type.
  int64_t integer(const std::string& name, int64_t fallback) const;
  std::string text(const std::string& name, const std::string& fallback) const;
  std::vector<int64_t> integers(const std::string& name, std::vector<int64_t> fallback) const;

  bool has_input(size_t i) const { return i < inputs.size() && !inputs[i].empty(); }
};

/// An input or output of the model.
struct Port {
  std::string name;
  ElementType type = ElementType::kFloat32;
  Shape shape;
};

struct Graph {
  std::string name;
  std::vector<Port> inputs;
  std::vector<Port> outputs;
  std::vector<Node> nodes;  ///< each node comes after those that compute its inputs
  std::map<std::string, Tensor> constants;
  std::map<std::string, std::string> metadata;
};

}  // namespace bevloc::nn
