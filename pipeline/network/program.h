// What the executor runs: the model's graph after quantisation, activation, sums and data movement
// have been folded into a few kinds of steps. Knows no memory layout and no engine.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/network/graph.h"

namespace bevloc::nn {

/// An activation: [n, c, h, w], real value = scale * element. The zero point is always 0.
struct Value {
  std::array<int64_t, 4> dims{};
  ElementType type = ElementType::kFloat32;
  float scale = 1.0F;  ///< 0 while a model input's scale is not known yet
};

/// Convolution, then the sum with a residual, then ReLU.
struct ConvStep {
  int input = 0;
  int output = 0;
  int residual = -1;
  bool relu = false;
  /// [out, in / groups, rows, cols]: int8 with a scale per output channel, or float without.
  Tensor weights;
  std::vector<float> weight_scale;
  std::vector<float> bias;  ///< real values; empty without bias
  int64_t groups = 1;
  std::array<int64_t, 2> strides{1, 1};
  std::array<int64_t, 2> dilations{1, 1};
  std::array<int64_t, 4> pads{};  ///< top, left, bottom, right
};

struct MaxPoolStep {
  int input = 0;
  int output = 0;
  std::array<int64_t, 2> kernel{};
  std::array<int64_t, 2> strides{1, 1};
  std::array<int64_t, 4> pads{};
};

/// Twice as many rows and columns.
struct UpsampleStep {
  int input = 0;
  int output = 0;
  bool linear = false;
};

struct AddStep {
  int left = 0;
  int right = 0;
  int output = 0;
  bool relu = false;
};

struct ReluStep {
  int input = 0;
  int output = 0;
};

/// The same real values in another element type or scale.
struct ConvertStep {
  int input = 0;
  int output = 0;
};

/// output[i] = input[source[i]], both in row-major [n, c, h, w] order.
struct RearrangeStep {
  int input = 0;
  int output = 0;
  std::vector<int32_t> source;
};

/// Along the channels; all have one type and scale.
struct ConcatStep {
  std::vector<int> inputs;
  int output = 0;
};

/// The view transform: output [1, c, rows, cols] gathers from input [cameras, c, h, w] by the
/// view table.
struct ViewStep {
  int input = 0;
  int output = 0;
};

using Step = std::variant<ConvStep, MaxPoolStep, UpsampleStep, AddStep, ReluStep, ConvertStep,
                          RearrangeStep, ConcatStep, ViewStep>;

/// The values that a step reads.
std::vector<int> inputs_of(const Step& step);
int output_of(const Step& step);

/// The view table's ports in the model.
inline constexpr const char* kViewIndexPort = "view_index";
inline constexpr const char* kViewWeightPort = "view_weight";

struct ProgramPort {
  std::string name;
  int value = 0;
  Shape shape;
};

struct Program {
  std::vector<Value> values;
  std::vector<Step> steps;
  std::vector<ProgramPort> inputs;   ///< without the view table
  std::vector<ProgramPort> outputs;  ///< real values
};

}  // namespace bevloc::nn
