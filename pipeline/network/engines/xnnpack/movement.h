// Tasks that copy elements in another order or type.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pipeline/network/engines/xnnpack/task.h"

namespace bevloc::nn::xnnpack {

/// Converts a model input, dense [n, c, h, w], to an activation.
std::unique_ptr<Task> import_input(const Value& value, size_t from, size_t to);

/// Converts an activation to real values, dense [n, c, h, w].
std::unique_ptr<Task> export_output(const Value& value, size_t from, size_t to);

/// Converts between int8 elements and the uint8 elements that are 128 larger, in either direction.
std::unique_ptr<Task> shift_by_128(size_t from, size_t to, size_t bytes);
void shift_by_128(const std::byte* from, std::byte* to, size_t bytes);

/// Runs a RearrangeStep between channel-last activations.
std::unique_ptr<Task> rearrangement(const RearrangeStep& step, const Value& input,
                                    const Value& output, size_t from, size_t to);

/// Copies each pixel, of `from_bytes` bytes, into the output's pixel, of `to_bytes` bytes, at the
/// offset `offset`.
std::unique_ptr<Task> channel_copy(size_t pixels, size_t from, size_t from_bytes, size_t to,
                                   size_t to_bytes, size_t offset);

}  // namespace bevloc::nn::xnnpack
