#include "pipeline/network/model/layout_trace.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "pipeline/network/model/limits.h"
#include "pipeline/network/model/load_error.h"

namespace bevloc::nn {
namespace {

std::vector<int64_t> strides_of(const Shape& shape) {
  std::vector<int64_t> strides(shape.size(), 1);
  for (size_t i = shape.size(); i-- > 1;) strides[i - 1] = strides[i] * shape[i];
  return strides;
}

/// The output shape of a Reshape node. In its shape input, 0 means the size of the input's axis,
/// and -1 the size that makes the number of elements match.
Shape wanted_shape(const Node& node, const Shape& input, const Tensor& shape_tensor) {
  Shape wanted = shape_tensor.integers();
  for (size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i] == 0 && i < input.size()) wanted[i] = input[i];
  }
  const auto free_axis = std::ranges::find(wanted, -1);
  if (free_axis != wanted.end()) {
    *free_axis = 1;
    const int64_t rest = checked_element_count(wanted, node.label);
    *free_axis = element_count(input) / rest;
  }
  const bool positive = std::ranges::all_of(wanted, [](int64_t n) { return n > 0; });
  if (!positive || checked_element_count(wanted, node.label) != element_count(input)) {
    refuse("{}: shape {} cannot be reshaped to {}", node.label, to_string(input),
           to_string(shape_tensor.integers()));
  }
  return wanted;
}

LayoutTrace reshape(const LayoutTrace& input, const Node& node,
                    const std::map<std::string, Tensor>& constants) {
  const auto shape = node.has_input(1) ? constants.find(node.inputs[1]) : constants.end();
  if (shape == constants.end()) refuse("{}: the shape is not a constant", node.label);
  if (node.integer("allowzero", 0) != 0) refuse("{}: allowzero is not supported", node.label);
  return input.reshaped(wanted_shape(node, input.shape(), shape->second));
}

LayoutTrace transpose(const LayoutTrace& input, const Node& node) {
  std::vector<int64_t> reversed(input.shape().size());
  std::iota(reversed.rbegin(), reversed.rend(), int64_t{0});
  const std::vector<int64_t> permutation = node.integers("perm", reversed);
  std::vector<int64_t> sorted = permutation;
  std::ranges::sort(sorted);
  std::ranges::reverse(reversed);
  if (sorted != reversed) {
    refuse("{}: {} is not a permutation of {} axes", node.label, to_string(permutation),
           input.shape().size());
  }
  return input.transposed(permutation);
}

int64_t block_size(const Node& node, const Shape& shape) {
  const int64_t block = node.integer("blocksize", 0);
  if (shape.size() != 4 || block < 1 || block > kLargestStep) {
    refuse("{}: shape is {} and blocksize {}, wanted 4 axes and a blocksize of 1 to {}", node.label,
           to_string(shape), block, kLargestStep);
  }
  return block;
}

LayoutTrace depth_to_space(const LayoutTrace& input, const Node& node) {
  const Shape& shape = input.shape();
  const int64_t b = block_size(node, shape);
  const std::string mode = node.text("mode", "DCR");
  if (shape[1] % (b * b) != 0 || (mode != "DCR" && mode != "CRD")) {
    refuse("{}: {} channels in mode '{}' cannot be arranged in blocks of {}x{}", node.label,
           shape[1], mode, b, b);
  }
  const int64_t n = shape[0];
  const int64_t c = shape[1] / (b * b);
  const int64_t h = shape[2];
  const int64_t w = shape[3];
  const LayoutTrace blocks =
      mode == "DCR" ? input.reshaped({n, b, b, c, h, w}).transposed({0, 3, 4, 1, 5, 2})
                    : input.reshaped({n, c, b, b, h, w}).transposed({0, 1, 4, 2, 5, 3});
  return blocks.reshaped({n, c, h * b, w * b});
}

LayoutTrace space_to_depth(const LayoutTrace& input, const Node& node) {
  const Shape& shape = input.shape();
  const int64_t b = block_size(node, shape);
  if (shape[2] % b != 0 || shape[3] % b != 0) {
    refuse("{}: {}x{} cells cannot be split into blocks of {}x{}", node.label, shape[2], shape[3],
           b, b);
  }
  const int64_t n = shape[0];
  const int64_t c = shape[1];
  const int64_t h = shape[2] / b;
  const int64_t w = shape[3] / b;
  return input.reshaped({n, c, h, b, w, b})
      .transposed({0, 3, 5, 1, 2, 4})
      .reshaped({n, b * b * c, h, w});
}

}  // namespace

LayoutTrace::LayoutTrace(Shape shape, std::vector<int32_t> source) : shape_(std::move(shape)) {
  int32_t next = 0;
  if (std::ranges::all_of(source, [&next](int32_t i) { return i == next++; })) return;
  source_ = std::make_shared<const std::vector<int32_t>>(std::move(source));
}

std::vector<int32_t> LayoutTrace::sources() const {
  if (!is_identity()) return *source_;
  std::vector<int32_t> identity(static_cast<size_t>(element_count(shape_)));
  std::iota(identity.begin(), identity.end(), 0);
  return identity;
}

LayoutTrace LayoutTrace::reshaped(Shape shape) const {
  assert(element_count(shape) == element_count(shape_));
  return {std::move(shape), source_};
}

LayoutTrace LayoutTrace::transposed(const std::vector<int64_t>& permutation) const {
  const std::vector<int64_t> strides = strides_of(shape_);
  Shape shape(permutation.size());
  std::vector<int64_t> step(permutation.size());
  for (size_t axis = 0; axis < permutation.size(); ++axis) {
    shape[axis] = shape_[static_cast<size_t>(permutation[axis])];
    step[axis] = strides[static_cast<size_t>(permutation[axis])];
  }
  std::vector<int32_t> source(static_cast<size_t>(element_count(shape)));
  std::vector<int64_t> position(shape.size(), 0);
  int64_t here = 0;
  for (int32_t& entry : source) {
    entry = this->source(here);
    for (size_t axis = shape.size(); axis-- > 0;) {
      here += step[axis];
      if (++position[axis] < shape[axis]) break;
      here -= step[axis] * shape[axis];
      position[axis] = 0;
    }
  }
  return {std::move(shape), std::move(source)};
}

LayoutTrace traced_through(const LayoutTrace& input, const Node& node,
                           const std::map<std::string, Tensor>& constants) {
  switch (node.op) {
    case Operator::kReshape:
      return reshape(input, node, constants);
    case Operator::kTranspose:
      return transpose(input, node);
    case Operator::kDepthToSpace:
      return depth_to_space(input, node);
    case Operator::kSpaceToDepth:
      return space_to_depth(input, node);
    default:
      return input;
  }
}

}  // namespace bevloc::nn
