#include "pipeline/network/network_cost.h"

#include <algorithm>

#include "pipeline/network/load_error.h"
#include "pipeline/network/lowering.h"
#include "pipeline/network/onnx_reader.h"
#include "pipeline/network/view_table.h"

namespace bevloc {
namespace nn {
namespace {

uint64_t elements(const Value& value) {
  uint64_t count = 1;
  for (const int64_t dim : value.dims) count *= static_cast<uint64_t>(dim);
  return count;
}

uint64_t bytes(const Value& value) {
  return elements(value) * size_in_bytes(value.type);
}

/// By step; none if the program has no such output.
std::vector<bool> steps_for(const Program& program, const std::string& output) {
  std::vector<bool> wanted_values(program.values.size(), false);
  for (const ProgramPort& port : program.outputs) {
    if (port.name == output) wanted_values[static_cast<size_t>(port.value)] = true;
  }
  std::vector<bool> wanted(program.steps.size(), false);
  for (size_t i = program.steps.size(); i-- > 0;) {
    const Step& step = program.steps[i];
    if (!wanted_values[static_cast<size_t>(output_of(step))]) continue;
    wanted[i] = true;
    for (const int input : inputs_of(step)) wanted_values[static_cast<size_t>(input)] = true;
  }
  return wanted;
}

void add_convolution(const ConvStep& step, const Value& output, BranchCost& cost) {
  const Shape& shape = step.weights.shape;  // [out, in / groups, rows, cols]
  cost.macs += elements(output) * static_cast<uint64_t>(shape[1] * shape[2] * shape[3]);
  cost.weight_bytes += step.weights.bytes.size() + step.bias.size() * sizeof(float);
}

void add_view(const Value& output, BranchCost& cost) {
  cost.macs += kViewSlots * elements(output);
  const uint64_t cells = elements(output) / static_cast<uint64_t>(output.dims[1]);
  cost.weight_bytes += kViewSlots * cells * (sizeof(int32_t) + sizeof(float));
}

}  // namespace

BranchCost cost_of_branch(const Program& program, const std::string& output,
                          const std::string& done) {
  const std::vector<bool> wanted = steps_for(program, output);
  const std::vector<bool> already = steps_for(program, done);
  BranchCost cost;
  for (size_t i = 0; i < program.steps.size(); ++i) {
    if (!wanted[i] || already[i]) continue;
    const Step& step = program.steps[i];
    const Value& result = program.values[static_cast<size_t>(output_of(step))];
    cost.activation_bytes += bytes(result);
    for (const int input : inputs_of(step)) {
      cost.activation_bytes += bytes(program.values[static_cast<size_t>(input)]);
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
  try {
    const nn::Program program = nn::lower(nn::read_onnx(path));
    return NetworkCost{nn::cost_of_branch(program, "bev_features"),
                       nn::cost_of_branch(program, "map_features"),
                       nn::cost_of_branch(program, "bev_mask", "bev_features")};
  } catch (const nn::LoadError& error) {
    return fail("{}: {}", path, error.what());
  } catch (const std::exception& error) {
    return fail("{}: cannot be loaded: {}", path, error.what());
  }
}

}  // namespace bevloc
