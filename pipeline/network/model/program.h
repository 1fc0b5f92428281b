// The program that the engine runs: the graph of a model, lowered to a few kinds of steps. It knows
// neither memory layouts nor the engine.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/network/model/graph.h"

namespace bevloc::nn {

/// An activation [n, c, h, w] with real values scale * element. The zero point is always 0.
struct Value {
  std::array<int64_t, 4> dims{};
  ElementType type = ElementType::kFloat32;
  float scale = 1.0F;  ///< during lowering, 0 for a model input whose scale is not known yet
};

uint64_t element_count(const Value& value);
uint64_t size_in_bytes(const Value& value);

/// Convolution, then the sum with a residual, then ReLU.
struct ConvStep {
  int input = 0;
  int output = 0;
  int residual = -1;  ///< -1 if there is none
  bool relu = false;
  /// [out, in / groups, rows, cols]: int8 with a scale per output channel, or float without scales.
  Tensor weights;
  std::vector<float> weight_scale;
  std::vector<float> bias;  ///< real values; empty without a bias
  int64_t groups = 1;
  std::array<int64_t, 2> strides{1, 1};
  std::array<int64_t, 2> dilations{1, 1};
  std::array<int64_t, 4> pads{};  ///< top, left, bottom, right
};

/// The weights of a convolution with int8 weights.
std::span<const int8_t> int8_weights(const ConvStep& step);

struct MaxPoolStep {
  int input = 0;
  int output = 0;
  std::array<int64_t, 2> kernel{};
  std::array<int64_t, 2> strides{1, 1};
  std::array<int64_t, 4> pads{};  ///< top, left, bottom, right
};

/// Doubles the number of rows and columns: nearest neighbour, or linear at half-pixel positions.
struct UpsampleStep {
  int input = 0;
  int output = 0;
  bool linear = false;
};

/// Sum of two activations, then ReLU.
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

/// Converts an activation to another element type or scale.
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

/// Concatenates along the channels. All inputs have the same type and scale.
struct ConcatStep {
  std::vector<int> inputs;
  int output = 0;
};

/// The view transform: gathers output [1, c, rows, cols] from input [cameras, c, h, w], as the view
/// table says.
struct ViewStep {
  int input = 0;
  int output = 0;
};

using Step = std::variant<ConvStep, MaxPoolStep, UpsampleStep, AddStep, ReluStep, ConvertStep,
                          RearrangeStep, ConcatStep, ViewStep>;

/// Indices of the values that a step reads, and of the value that it writes.
std::vector<int> inputs_of(const Step& step);
int output_of(const Step& step);

/// Names of the model's inputs for the view table.
inline constexpr const char* kViewIndexPort = "view_index";
inline constexpr const char* kViewWeightPort = "view_weight";

/// An input or output of the program.
struct ProgramPort {
  std::string name;
  int value = 0;
  Shape shape;
};

struct Program {
  std::vector<Value> values;
  std::vector<Step> steps;           ///< each step comes after those that compute its inputs
  std::vector<ProgramPort> inputs;   ///< inputs without the view table
  std::vector<ProgramPort> outputs;  ///< real values
};

/// For each value, whether `output` depends on it. If there is no such output, all are false.
std::vector<bool> needed_values(const Program& program, const std::string& output);

}  // namespace bevloc::nn
