// Makes the XNNPACK operator of a convolution step.
#pragma once

#include <memory>
#include <vector>

#include <xnnpack.h>

#include "pipeline/network/engines/xnnpack/task.h"
#include "pipeline/network/model/program.h"

namespace bevloc::nn::xnnpack {

/// Real value of one unit of the sum of products, by output channel. 1 for float weights.
std::vector<float> sum_scale(const ConvStep& step, const Value& input);

/// A convolution with int8 weights and 8-bit input and output, including bias, ReLU and rounding,
/// but no residual. Throws LoadError if XNNPACK does not support it.
std::unique_ptr<Task> quantized_convolution(const ConvStep& step, const Value& input,
                                            const Value& output, size_t from, size_t to);

/// A convolution from float to float, including the bias, and ReLU if `relu` is set.
///
/// With float weights, input and output are real values. With int8 weights, the input holds the
/// elements of the quantized input as floats, and the output the sums in units of sum_scale().
/// These sums are integers and exact below 2^24, which 1,000 products of 8 by 7 bits cannot exceed.
/// Throws LoadError if XNNPACK does not support it.
std::unique_ptr<Task> float_convolution(const ConvStep& step, const Value& input, bool relu,
                                        size_t from, size_t to);

}  // namespace bevloc::nn::xnnpack
