// What a network has to do for one frameset, counted from the graph of its file.
#pragma once

#include <cstdint>
#include <string>

#include "common/result.h"
#include "pipeline/network/program.h"

namespace bevloc {

/// Of one branch, as the engine's program has it: after folding, each step reads its inputs and
/// weights once and writes its output once.
struct BranchCost {
  uint64_t macs = 0;  ///< of convolutions and of the view transform
  uint64_t weight_bytes = 0;
  uint64_t activation_bytes = 0;

  uint64_t bytes() const { return weight_bytes + activation_bytes; }
};

/// The branches of Network; the mask's is what comes on top of the images'.
struct NetworkCost {
  BranchCost images;
  BranchCost map;
  BranchCost mask;
};

/// Errors: those of Network::load() that are about the file.
Result<NetworkCost> network_cost(const std::string& path);

namespace nn {

/// Of the steps that the output `output` needs, without those that the output `done` needs too
/// (none if it is empty).
BranchCost cost_of_branch(const Program& program, const std::string& output,
                          const std::string& done = {});

}  // namespace nn
}  // namespace bevloc
