// A model as the file says it: ONNX without protobuf, every operator known.
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

using Shape = std::vector<int64_t>;

int64_t element_count(const Shape& shape);
std::string to_string(const Shape& shape);

/// A constant of the model.
struct Tensor {
  ElementType type = ElementType::kFloat32;
  Shape shape;
  std::vector<std::byte> bytes;

  /// The elements as float, or as integers; floats are not converted to integers.
  std::vector<float> floats() const;
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
  /// For messages: "node 'trunk/stem' (Conv)".
  std::string label;
  std::vector<std::string> inputs;  ///< "" where an optional input is left out
  std::string output;
  std::map<std::string, Attribute> attributes;

  /// An attribute, or its default; refused when it has another type.
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
  std::vector<Node> nodes;  ///< in an order in which they can be computed
  std::map<std::string, Tensor> constants;
  std::map<std::string, std::string> metadata;
};

}  // namespace bevloc::nn
