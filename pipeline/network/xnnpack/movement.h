// Tasks that move elements without computing.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pipeline/network/xnnpack/task.h"

namespace bevloc::nn::xnnpack {

/// A model input, dense [n, c, h, w], as an activation.
std::unique_ptr<Task> import_input(const Value& value, size_t from, size_t to);

/// An activation as real values, dense [n, c, h, w].
std::unique_ptr<Task> export_output(const Value& value, size_t from, size_t to);

/// Between int8 elements and uint8 ones that are 128 higher.
std::unique_ptr<Task> move_by_128(size_t from, size_t to, size_t bytes);
void move_by_128(const std::byte* from, std::byte* to, size_t bytes);

/// output[i] = input[source[i]], both in row-major [n, c, h, w] order.
std::unique_ptr<Task> rearrangement(const RearrangeStep& step, const Value& input,
                                    const Value& output, size_t from, size_t to);

/// Copies `from_bytes` of each pixel to a place within the `to_bytes` of the output's pixel.
std::unique_ptr<Task> channel_copy(size_t pixels, size_t from, size_t from_bytes, size_t to,
                                   size_t to_bytes, size_t place);

}  // namespace bevloc::nn::xnnpack
