#include "pipeline/network/model/onnx_reader.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <span>

#include <onnx/onnx_pb.h>

#include "pipeline/network/model/limits.h"
#include "pipeline/network/model/load_error.h"

namespace bevloc::nn {
namespace {

constexpr int64_t kOldestOperatorSet = 13;  // the first with DequantizeLinear per channel

struct KnownOperator {
  Operator op;
  std::set<std::string> attributes;
};

const std::map<std::string, KnownOperator>& known_operators() {
  static const std::map<std::string, KnownOperator> known = {
      {"Add", {Operator::kAdd, {}}},
      {"Concat", {Operator::kConcat, {"axis"}}},
      {"Constant", {Operator::kConstant, {"value"}}},
      {"Conv",
       {Operator::kConv, {"auto_pad", "dilations", "group", "kernel_shape", "pads", "strides"}}},
      {"DepthToSpace", {Operator::kDepthToSpace, {"blocksize", "mode"}}},
      {"DequantizeLinear", {Operator::kDequantizeLinear, {"axis"}}},
      {"Gather", {Operator::kGather, {"axis"}}},
      {"Identity", {Operator::kIdentity, {}}},
      {"MaxPool",
       {Operator::kMaxPool,
        {"auto_pad", "ceil_mode", "dilations", "kernel_shape", "pads", "storage_order",
         "strides"}}},
      {"Mul", {Operator::kMul, {}}},
      {"QuantizeLinear", {Operator::kQuantizeLinear, {"axis"}}},
      {"ReduceSum", {Operator::kReduceSum, {"keepdims", "noop_with_empty_axes"}}},
      {"Relu", {Operator::kRelu, {}}},
      {"Reshape", {Operator::kReshape, {"allowzero"}}},
      {"Resize",
       {Operator::kResize,
        {"coordinate_transformation_mode", "cubic_coeff_a", "exclude_outside",
         "extrapolation_value", "mode", "nearest_mode"}}},
      {"SpaceToDepth", {Operator::kSpaceToDepth, {"blocksize"}}},
      {"Transpose", {Operator::kTranspose, {"perm"}}},
  };
  return known;
}

ElementType element_type(int32_t type, const std::string& what) {
  switch (type) {
    case onnx::TensorProto::FLOAT:
      return ElementType::kFloat32;
    case onnx::TensorProto::UINT8:
      return ElementType::kUint8;
    case onnx::TensorProto::INT8:
      return ElementType::kInt8;
    case onnx::TensorProto::INT32:
      return ElementType::kInt32;
    case onnx::TensorProto::INT64:
      return ElementType::kInt64;
    default:
      break;
  }
  refuse("{} has ONNX element type {}, wanted float, uint8, int8, int32 or int64", what, type);
}

/// The bytes of elements that protobuf stores in a field of a wider type.
template <typename Element, typename Field>
std::vector<std::byte> packed(const Field& values) {
  std::vector<Element> elements(values.begin(), values.end());
  const auto bytes = std::as_bytes(std::span(elements));
  return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> content(const onnx::TensorProto& proto, ElementType type) {
  if (proto.has_raw_data()) {
    const auto* begin = reinterpret_cast<const std::byte*>(proto.raw_data().data());
    return {begin, begin + proto.raw_data().size()};
  }
  switch (type) {
    case ElementType::kFloat32:
      return packed<float>(proto.float_data());
    case ElementType::kUint8:
      return packed<uint8_t>(proto.int32_data());
    case ElementType::kInt8:
      return packed<int8_t>(proto.int32_data());
    case ElementType::kInt32:
      return packed<int32_t>(proto.int32_data());
    case ElementType::kInt64:
      return packed<int64_t>(proto.int64_data());
  }
  return {};
}

Tensor read_tensor(const onnx::TensorProto& proto, const std::string& name) {
  const std::string what = fmt::format("constant '{}'", name);
  if (proto.data_location() == onnx::TensorProto::EXTERNAL) {
    refuse("{} is stored in another file, wanted all weights in the model file", what);
  }
  Tensor tensor;
  tensor.type = element_type(proto.data_type(), what);
  tensor.shape.assign(proto.dims().begin(), proto.dims().end());
  tensor.bytes = content(proto, tensor.type);
  int64_t left = static_cast<int64_t>(tensor.bytes.size() / size_in_bytes(tensor.type));
  const bool positive = std::ranges::all_of(tensor.shape, [](int64_t n) { return n > 0; });
  // Divides instead of multiplying, so that a damaged shape cannot overflow.
  const bool exact = tensor.bytes.size() % size_in_bytes(tensor.type) == 0 && positive &&
                     std::ranges::all_of(tensor.shape, [&left](int64_t n) {
                       const bool divides = left % n == 0;
                       left /= n;
                       return divides;
                     });
  if (!exact || left != 1) {
    refuse("{} has {} bytes, which do not match its shape {} of {}", what, tensor.bytes.size(),
           to_string(tensor.shape), name_of(tensor.type));
  }
  checked_element_count(tensor.shape, what);
  if (tensor.type == ElementType::kFloat32 &&
      !std::ranges::all_of(tensor.floats(), [](float value) { return std::isfinite(value); })) {
    refuse("{} has an element that is not finite", what);
  }
  return tensor;
}

Attribute read_attribute(const onnx::AttributeProto& proto, const std::string& label) {
  switch (proto.type()) {
    case onnx::AttributeProto::INT:
      return proto.i();
    case onnx::AttributeProto::FLOAT:
      return proto.f();
    case onnx::AttributeProto::STRING:
      return proto.s();
    case onnx::AttributeProto::INTS:
      return std::vector<int64_t>(proto.ints().begin(), proto.ints().end());
    default:
      break;
  }
  refuse("{}: attribute '{}' has a type that is not supported", label, proto.name());
}

std::string label_of(const onnx::NodeProto& proto) {
  const std::string& first_output = proto.output_size() > 0 ? proto.output(0) : proto.name();
  return fmt::format("node '{}' ({})", proto.name().empty() ? first_output : proto.name(),
                     proto.op_type());
}

Node read_node(const onnx::NodeProto& proto) {
  Node node;
  node.label = label_of(proto);
  const auto known = known_operators().find(proto.op_type());
  const bool standard = proto.domain().empty() || proto.domain() == "ai.onnx";
  if (known == known_operators().end() || !standard) {
    refuse("{}: operator '{}' is not supported", node.label,
           standard ? proto.op_type() : proto.domain() + "." + proto.op_type());
  }
  if (proto.output_size() != 1) {
    refuse("{} has {} outputs, wanted 1", node.label, proto.output_size());
  }
  node.op = known->second.op;
  node.inputs.assign(proto.input().begin(), proto.input().end());
  node.output = proto.output(0);
  for (const onnx::AttributeProto& attribute : proto.attribute()) {
    if (!known->second.attributes.contains(attribute.name())) {
      refuse("{}: attribute '{}' is not supported", node.label, attribute.name());
    }
    if (node.op == Operator::kConstant) continue;
    node.attributes[attribute.name()] = read_attribute(attribute, node.label);
  }
  return node;
}

Port read_port(const onnx::ValueInfoProto& proto) {
  const auto& type = proto.type().tensor_type();
  const std::string what = fmt::format("'{}'", proto.name());
  Port port{proto.name(), element_type(type.elem_type(), what), {}};
  for (const auto& dimension : type.shape().dim()) {
    if (dimension.dim_value() <= 0) refuse("{} has a dynamic shape, wanted fixed dimensions", what);
    port.shape.push_back(dimension.dim_value());
  }
  checked_element_count(port.shape, what);
  return port;
}

void check_operator_set(const onnx::ModelProto& model) {
  for (const onnx::OperatorSetIdProto& set : model.opset_import()) {
    const bool standard = set.domain().empty() || set.domain() == "ai.onnx";
    if (standard && set.version() < kOldestOperatorSet) {
      refuse("the model uses ONNX operator set {}, wanted {} or newer", set.version(),
             kOldestOperatorSet);
    }
  }
}

/// Checks that every name is defined once, and before a node or an output reads it.
void check_order(const Graph& graph) {
  std::set<std::string> known;
  for (const auto& [name, tensor] : graph.constants) known.insert(name);
  for (const Port& input : graph.inputs) {
    if (!known.insert(input.name).second) refuse("input '{}' is defined twice", input.name);
  }
  for (const Node& node : graph.nodes) {
    for (const std::string& input : node.inputs) {
      if (!input.empty() && !known.contains(input)) {
        refuse("{}: input '{}' is not computed before this node", node.label, input);
      }
    }
    if (!known.insert(node.output).second) {
      refuse("{}: '{}' is defined twice", node.label, node.output);
    }
  }
  for (const Port& output : graph.outputs) {
    if (!known.contains(output.name)) refuse("output '{}' is never computed", output.name);
  }
}

Graph convert(const onnx::ModelProto& model) {
  if (!model.has_graph()) refuse("contains no graph, wanted an ONNX model");
  check_operator_set(model);
  const onnx::GraphProto& proto = model.graph();
  if (static_cast<size_t>(proto.node_size()) > kMostNodes) {
    refuse("the graph has {} nodes, wanted at most {}", proto.node_size(), kMostNodes);
  }
  Graph graph;
  graph.name = proto.name();
  for (const auto& initializer : proto.initializer()) {
    graph.constants[initializer.name()] = read_tensor(initializer, initializer.name());
  }
  for (const auto& input : proto.input()) {
    if (!graph.constants.contains(input.name())) graph.inputs.push_back(read_port(input));
  }
  for (const auto& output : proto.output()) graph.outputs.push_back(read_port(output));
  for (const auto& node_proto : proto.node()) {
    Node node = read_node(node_proto);
    if (node.op != Operator::kConstant) {
      graph.nodes.push_back(std::move(node));
    } else if (node_proto.attribute_size() == 1) {
      graph.constants[node.output] = read_tensor(node_proto.attribute(0).t(), node.output);
    } else {
      refuse("{} has no value", node.label);
    }
  }
  for (const auto& entry : model.metadata_props()) graph.metadata[entry.key()] = entry.value();
  check_order(graph);
  return graph;
}

[[noreturn]] void refuse_length(uintmax_t bytes) {
  refuse("is {} bytes long, wanted at most {}", bytes, kMostFileBytes);
}

}  // namespace

Graph parse_onnx(std::string_view bytes) {
  if (bytes.size() > kMostFileBytes) refuse_length(bytes.size());
  onnx::ModelProto model;
  if (!model.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    refuse("is not a complete ONNX file: it is damaged or truncated");
  }
  return convert(model);
}

Graph read_onnx(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse("cannot be opened: {}", std::strerror(errno));
  std::error_code not_a_file;
  const uintmax_t length = std::filesystem::file_size(path, not_a_file);
  if (!not_a_file && length > kMostFileBytes) refuse_length(length);
  return parse_onnx(std::string(std::istreambuf_iterator<char>(file), {}));
}

}  // namespace bevloc::nn
