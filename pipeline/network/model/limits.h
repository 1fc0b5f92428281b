// Bounds of what a model may ask for. The loader refuses a damaged file by them before it computes
// or allocates anything from its numbers. The shipped network stays far below each bound.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "pipeline/network/model/graph.h"

namespace bevloc::nn {

inline constexpr size_t kMostFileBytes = size_t{256} << 20U;
inline constexpr size_t kMostNodes = 2048;
inline constexpr size_t kMostAxes = 8;
/// Elements of one tensor. Indices into it therefore fit into int32.
inline constexpr int64_t kMostElements = int64_t{1} << 24U;
/// Elements of all activations, layouts and copied constants together.
inline constexpr int64_t kMostElementsTogether = int64_t{1} << 27U;
/// The largest stride, dilation and block size.
inline constexpr int64_t kLargestStep = 64;
/// The largest window of a pooling along one axis.
inline constexpr int64_t kLargestWindow = 64;
/// The most products in one sum of an int8 convolution. Their sum stays below 2^30.
inline constexpr int64_t kMostProducts = 32768;
/// Bounds of quantization scales. The product of two, divided by a third, fits into a float.
inline constexpr float kSmallestScale = 1e-15F;
inline constexpr float kLargestScale = 1e9F;

/// The number of elements. Throws LoadError if an axis is not positive, or if there are more axes
/// or elements than the bounds allow; `what` names the tensor in the message.
int64_t checked_element_count(const Shape& shape, const std::string& what);

}  // namespace bevloc::nn
