// Models: reads and lowers them, and checks that no step reaches beyond the values that it reads
// and writes, because the engine relies on it.
#include <algorithm>
#include <cmath>

#include "pipeline/network/model/limits.h"
#include "pipeline/network/model/load_error.h"
#include "pipeline/network/model/lowering.h"
#include "pipeline/network/model/network_cost.h"
#include "pipeline/network/model/onnx_reader.h"
#include "tests/fuzz/targets.h"

namespace bevloc::fuzz {
namespace {

using nn::Program;
using nn::Value;

/// Whether a window at every place of the output covers at least one cell of the input, and ends
/// within the padded input.
bool fits(int64_t in, int64_t out, int64_t window, int64_t stride, int64_t before, int64_t after) {
  return before < window && after < window && out >= 1 &&
         (out - 1) * stride + window <= in + before + after;
}

bool fits(const Value& in, const Value& out, std::array<int64_t, 2> window,
          const std::array<int64_t, 2>& strides, const std::array<int64_t, 4>& pads) {
  return in.dims[0] == out.dims[0] &&
         fits(in.dims[2], out.dims[2], window[0], strides[0], pads[0], pads[2]) &&
         fits(in.dims[3], out.dims[3], window[1], strides[1], pads[1], pads[3]);
}

class StepChecker {
 public:
  explicit StepChecker(const Program& program) : program_(program) {}

  void operator()(const nn::ConvStep& step) const {
    const nn::Shape& w = step.weights.shape;
    const std::array<int64_t, 2> window{(w[2] - 1) * step.dilations[0] + 1,
                                        (w[3] - 1) * step.dilations[1] + 1};
    expect(fits(in(step), out(step), window, step.strides, step.pads), "a window beyond the image");
    expect(in(step).dims[1] == w[1] * step.groups && out(step).dims[1] == w[0], "other channels");
    expect(step.bias.empty() || std::ssize(step.bias) == w[0], "a bias of another length");
    expect(step.weight_scale.empty() || std::ssize(step.weight_scale) == w[0], "scales missing");
    const size_t bytes = nn::size_in_bytes(step.weights.type) * nn::element_count(w);
    expect(step.weights.bytes.size() == bytes, "weights missing");
    if (step.residual >= 0) expect(value(step.residual).dims == out(step).dims, "another residual");
  }
  void operator()(const nn::MaxPoolStep& step) const {
    expect(fits(in(step), out(step), step.kernel, step.strides, step.pads), "a window outside");
    expect(in(step).dims[1] == out(step).dims[1], "other channels");
  }
  void operator()(const nn::RearrangeStep& step) const {
    expect(step.source.size() == nn::element_count(out(step)), "another number of elements");
    const auto end = static_cast<int32_t>(nn::element_count(in(step)));
    expect(std::ranges::all_of(step.source, [end](int32_t i) { return i >= 0 && i < end; }),
           "an element from outside the input");
  }
  void operator()(const nn::AddStep& step) const {
    expect(value(step.left).dims == out(step).dims && value(step.right).dims == out(step).dims,
           "a sum of different shapes");
  }
  void operator()(const nn::ConcatStep& step) const {
    int64_t channels = 0;
    for (const int input : step.inputs) {
      channels += value(input).dims[1];
      expect(value(input).dims[2] == out(step).dims[2], "parts with other rows");
      expect(value(input).dims[3] == out(step).dims[3], "parts with other columns");
    }
    expect(channels == out(step).dims[1], "another number of channels");
  }
  void operator()(const nn::UpsampleStep& step) const {
    expect(4 * nn::element_count(in(step)) == nn::element_count(out(step)), "not twice the size");
  }
  void operator()(const nn::ViewStep& step) const {
    expect(in(step).dims[1] == out(step).dims[1], "other channels");
  }
  template <typename OneToOne>
  void operator()(const OneToOne& step) const {
    expect(nn::element_count(in(step)) == nn::element_count(out(step)), "another size");
  }

 private:
  const Value& value(int id) const {
    expect(id >= 0 && static_cast<size_t>(id) < program_.values.size(), "an unknown value");
    return program_.values[static_cast<size_t>(id)];
  }
  template <typename Step>
  const Value& in(const Step& step) const {
    return value(step.input);
  }
  template <typename Step>
  const Value& out(const Step& step) const {
    return value(step.output);
  }

  const Program& program_;
};

}  // namespace

void run_onnx(Bytes bytes) {
  try {
    const Program program = nn::lower(nn::parse_onnx(text_of(bytes)));
    for (const Value& value : program.values) {
      expect(std::isfinite(value.scale) && value.scale > 0.0F, "a value without a scale");
      expect(nn::element_count(value) <= nn::kMostElements, "a value that is too large");
    }
    for (const nn::Step& step : program.steps) std::visit(StepChecker(program), step);
    for (const nn::ProgramPort& port : program.outputs) {
      nn::cost_of_branch(program, port.name);
    }
  } catch (const nn::LoadError&) {
  }
}

}  // namespace bevloc::fuzz
