// Follows data movement (Reshape, Transpose, DepthToSpace, SpaceToDepth) without moving anything:
// which element of an activation does each element of a tensor come from?
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/network/graph.h"

namespace bevloc::nn {

/// A tensor whose elements are those of one activation in another order.
class LayoutTrace {
 public:
  LayoutTrace() = default;
  explicit LayoutTrace(Shape shape) : shape_(std::move(shape)) {}
  LayoutTrace(Shape shape, std::vector<int32_t> source);

  const Shape& shape() const { return shape_; }
  bool is_identity() const { return source_.empty(); }

  /// Element of the activation that the i-th element of the tensor comes from (both row-major).
  int32_t source(int64_t i) const {
    return is_identity() ? static_cast<int32_t>(i) : source_[static_cast<size_t>(i)];
  }
  std::vector<int32_t> sources() const;

  /// `shape` must have as many elements.
  LayoutTrace reshaped(Shape shape) const;
  /// Axis i of the result is axis permutation[i] of this one.
  LayoutTrace transposed(const std::vector<int64_t>& permutation) const;

 private:
  Shape shape_;
  std::vector<int32_t> source_;  ///< empty: the order is the activation's own
};

/// The data movement of one node; `constants` holds the shapes that Reshape wants. Throws
/// LoadError.
LayoutTrace traced_through(const LayoutTrace& input, const Node& node,
                           const std::map<std::string, Tensor>& constants);

}  // namespace bevloc::nn
