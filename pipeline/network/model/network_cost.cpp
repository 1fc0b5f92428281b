#include "pipeline/network/model/network_cost.h"

#include "pipeline/network/model/load_error.h"
#include "pipeline/network/model/lowering.h"
#include "pipeline/network/model/onnx_reader.h"
#include "pipeline/network/view/view_table.h"

namespace bevloc {
namespace nn {
namespace {

void add_convolution(const ConvStep& step, const Value& output, BranchCost& cost) {
  const Shape& shape = step.weights.shape;  // [out, in / groups, rows, cols]
  cost.macs += element_count(output) * static_cast<uint64_t>(shape[1] * shape[2] * shape[3]);
  cost.weight_bytes += step.weights.bytes.size() + step.bias.size() * sizeof(float);
}

void add_view(const Value& output, BranchCost& cost) {
  cost.macs += kViewSlots * element_count(output);
  const uint64_t cells = element_count(output) / static_cast<uint64_t>(output.dims[1]);
  cost.weight_bytes += kViewSlots * cells * (sizeof(int32_t) + sizeof(float));
}

}  // namespace

BranchCost cost_of_branch(const Program& program, const std::string& output,
                          const std::string& done) {
  const std::vector<bool> needed = needed_values(program, output);
  const std::vector<bool> already = needed_values(program, done);
  BranchCost cost;
  for (const Step& step : program.steps) {
    const auto id = static_cast<size_t>(output_of(step));
    if (!needed[id] || already[id]) continue;
    const Value& result = program.values[id];
    cost.activation_bytes += size_in_bytes(result);
    for (const int input : inputs_of(step)) {
      cost.activation_bytes += size_in_bytes(program.values[static_cast<size_t>(input)]);
    }
    if (const auto* convolution = std::get_if<ConvStep>(&step)) {
      add_convolution(*convolution, result, cost);
    } else if (std::holds_alternative<ViewStep>(step)) {
      add_view(result, cost);
    }
  }
  return cost;
}

}  // namespace nn

Result<NetworkCost> network_cost(const std::string& path) {
  return nn::loaded(path, [&]() -> Result<NetworkCost> {
    const nn::Program program = nn::lower(nn::read_onnx(path));
    return NetworkCost{nn::cost_of_branch(program, "bev_features"),
                       nn::cost_of_branch(program, "map_features"),
                       nn::cost_of_branch(program, "bev_mask", "bev_features")};
  });
}

}  // namespace bevloc
