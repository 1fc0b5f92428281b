// In which order the steps of a program run, when its branches run apart.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pipeline/network/engine.h"
#include "pipeline/network/program.h"

namespace bevloc::nn {

/// Each step belongs to the first branch that needs it; later branches find its result there.
struct Schedule {
  std::vector<size_t> branch_of_step;
  std::vector<size_t> branch_of_output;
  std::vector<size_t> order;        ///< steps as they run: branch by branch
  std::vector<size_t> last_reader;  ///< position in that order, by value; its end for outputs
};

/// Each output of the program must be in one branch.
Schedule make_schedule(const Program& program, std::span<const Branch> branches);

}  // namespace bevloc::nn
