// Tracks where the elements of a tensor come from through Reshape, Transpose, DepthToSpace and
// SpaceToDepth, so that several of them become at most one copy.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/network/model/graph.h"

namespace bevloc::nn {

/// The layout of a tensor that has the elements of one activation in another order or shape.
class LayoutTrace {
 public:
  LayoutTrace() = default;
  /// The layout of the activation itself.
  explicit LayoutTrace(Shape shape) : shape_(std::move(shape)) {}
  LayoutTrace(Shape shape, std::vector<int32_t> source);

  const Shape& shape() const { return shape_; }
  /// Whether the order of the elements is that of the activation.
  bool is_identity() const { return source_ == nullptr; }

  /// Index in the activation of the tensor's element i. Both indices are row-major.
  int32_t source(int64_t i) const {
    return is_identity() ? static_cast<int32_t>(i) : (*source_)[static_cast<size_t>(i)];
  }
  /// source(i) of all elements.
  std::vector<int32_t> sources() const;

  /// `shape` must have the same number of elements.
  LayoutTrace reshaped(Shape shape) const;
  /// Axis i of the result is axis permutation[i] of this tensor.
  LayoutTrace transposed(const std::vector<int64_t>& permutation) const;

 private:
  /// The source is shared, because a file may give one layout to many tensors.
  using Source = std::shared_ptr<const std::vector<int32_t>>;
  LayoutTrace(Shape shape, Source source) : shape_(std::move(shape)), source_(std::move(source)) {}

  Shape shape_;
  Source source_;  ///< null if the order is that of the activation
};

/// The layout of the node's output. `constants` holds the shapes for Reshape. A node of another
/// operator does not change the layout. Throws LoadError.
LayoutTrace traced_through(const LayoutTrace& input, const Node& node,
                           const std::map<std::string, Tensor>& constants);

}  // namespace bevloc::nn
