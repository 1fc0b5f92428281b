// Tasks that look at other cells of the image: pooling, upsampling, the view transform.
#pragma once

#include <memory>

#include "pipeline/network/view_transform.h"
#include "pipeline/network/xnnpack/task.h"

namespace bevloc::nn::xnnpack {

std::unique_ptr<Task> max_pool(const MaxPoolStep& step, const Value& input, const Value& output,
                               size_t from, size_t to);

/// Twice the rows and columns; `linear` for float only.
std::unique_ptr<Task> upsampling(bool linear, const Value& input, size_t from, size_t to);

/// 8-bit features in `from` are as the model has them: uint8 is not moved down. `entries` must
/// outlive the task.
std::unique_ptr<Task> view_gather(const Value& features, const Value& output,
                                  const ViewEntries& entries, size_t from, size_t to);

}  // namespace bevloc::nn::xnnpack
