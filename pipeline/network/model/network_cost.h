// Counts the operations and the memory traffic of a network per frameset, from its model file.
#pragma once

#include <cstdint>
#include <string>

#include "common/result.h"
#include "pipeline/network/model/program.h"

namespace bevloc {

/// Cost of one branch after lowering. Each step reads its inputs and weights once and writes its
/// output once.
struct BranchCost {
  uint64_t macs = 0;  ///< multiply-accumulate operations of convolutions and the view transform
  uint64_t weight_bytes = 0;
  uint64_t activation_bytes = 0;

  uint64_t bytes() const { return weight_bytes + activation_bytes; }
};

/// Costs of the branches of Network. `mask` does not include the image branch, which it needs.
struct NetworkCost {
  BranchCost images;
  BranchCost map;
  BranchCost mask;
};

/// Fails as Network::load() does if the file is wrong.
Result<NetworkCost> network_cost(const std::string& path);

namespace nn {

/// Cost of the steps that `output` needs, without the steps that the output `done` also needs. An
/// empty `done` excludes nothing.
BranchCost cost_of_branch(const Program& program, const std::string& output,
                          const std::string& done = {});

}  // namespace nn
}  // namespace bevloc
