// Tasks whose output pixel depends on other input pixels: pooling, upsampling, the view transform.
#pragma once

#include <memory>

#include "pipeline/network/engines/xnnpack/task.h"
#include "pipeline/network/view/view_transform.h"

namespace bevloc::nn::xnnpack {

std::unique_ptr<Task> max_pool(const MaxPoolStep& step, const Value& input, const Value& output,
                               size_t from, size_t to);

/// Doubles the number of rows and columns. `linear` requires float elements.
std::unique_ptr<Task> upsampling(bool linear, const Value& input, size_t from, size_t to);

/// The view transform. uint8 features in `from` are not shifted, unlike other activations of this
/// engine. `entries` must outlive the task.
std::unique_ptr<Task> view_gather(const Value& features, const Value& output,
                                  const ViewEntries& entries, size_t from, size_t to);

}  // namespace bevloc::nn::xnnpack
