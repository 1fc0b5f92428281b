// The order in which the engine runs the steps of a program, branch by branch.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pipeline/network/model/program.h"
#include "pipeline/network/plan/branch.h"
#include "pipeline/network/plan/storage_plan.h"

namespace bevloc::nn {

/// A step belongs to the first branch that needs it. Later branches read its result.
struct Schedule {
  std::vector<size_t> branch_of_step;
  std::vector<size_t> branch_of_output;
  std::vector<size_t> order;        ///< indices of the steps, in the order in which they run
  std::vector<size_t> last_reader;  ///< by value: position in `order`; order.size() for outputs
};

/// Each output of the program must be in exactly one branch.
Schedule make_schedule(const Program& program, std::span<const Branch> branches);

/// Walks through the schedule as the engine runs it. In each branch, calls
/// add_step(step, position in the order) for its steps, then add_output(index) for its outputs.
template <typename AddStep, typename AddOutput>
void walk(const Program& program, const Schedule& schedule, size_t branches, StoragePlan& storages,
          const AddStep& add_step, const AddOutput& add_output) {
  size_t position = 0;
  for (size_t branch = 0; branch < branches; ++branch) {
    storages.begin_branch(branch);
    for (; position < schedule.order.size(); ++position) {
      const size_t step = schedule.order[position];
      if (schedule.branch_of_step[step] != branch) break;
      add_step(program.steps[step], position);
    }
    for (size_t i = 0; i < program.outputs.size(); ++i) {
      if (schedule.branch_of_output[i] == branch) add_output(i);
    }
  }
}

}  // namespace bevloc::nn
