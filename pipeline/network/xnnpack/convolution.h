// A convolution step as an XNNPACK operator.
#pragma once

#include <memory>
#include <vector>

#include <xnnpack.h>

#include "pipeline/network/program.h"
#include "pipeline/network/xnnpack/task.h"

namespace bevloc::nn::xnnpack {

/// Real value of one unit of the sum of products, by output channel; 1 for float.
std::vector<float> sum_scale(const ConvStep& step, const Value& input);

/// Bias, ReLU and rounding inside; no residual. int8 weights, 8-bit input and output.
/// Throws LoadError where XNNPACK cannot do it.
std::unique_ptr<Task> quantized_convolution(const ConvStep& step, const Value& input,
                                            const Value& output, size_t from, size_t to);

/// From float to float, with the bias. Float weights: real values, and with `relu` ReLU. int8
/// weights: the input's elements to sums in units of sum_scale(). These are integers, and exact
/// while they are below 2^24, which any 1,000 products of 8 by 7 bits are.
std::unique_ptr<Task> float_convolution(const ConvStep& step, const Value& input, bool relu,
                                        size_t from, size_t to);

}  // namespace bevloc::nn::xnnpack
