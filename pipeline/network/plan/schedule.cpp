#include "pipeline/network/plan/schedule.h"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace bevloc::nn {
namespace {

/// Assigns each output to its branch, and each step to the first branch that needs it.
void assign_branches(const Program& program, std::span<const Branch> branches, Schedule& schedule) {
  std::vector<size_t> branch_of_value(program.values.size(), branches.size());
  for (const ProgramPort& output : program.outputs) {
    const auto has_output = [&output](const Branch& branch) {
      return std::ranges::find(branch, output.name) != branch.end();
    };
    const auto branch = std::ranges::find_if(branches, has_output);
    assert(branch != branches.end());
    schedule.branch_of_output.push_back(static_cast<size_t>(branch - branches.begin()));
    size_t& first = branch_of_value[static_cast<size_t>(output.value)];
    first = std::min(first, schedule.branch_of_output.back());
  }
  schedule.branch_of_step.resize(program.steps.size());
  for (size_t i = program.steps.size(); i-- > 0;) {
    const Step& step = program.steps[i];
    schedule.branch_of_step[i] = branch_of_value[static_cast<size_t>(output_of(step))];
    for (const int id : inputs_of(step)) {
      size_t& first = branch_of_value[static_cast<size_t>(id)];
      first = std::min(first, schedule.branch_of_step[i]);
    }
  }
}

}  // namespace

Schedule make_schedule(const Program& program, std::span<const Branch> branches) {
  Schedule schedule;
  assign_branches(program, branches, schedule);
  schedule.order.resize(program.steps.size());
  std::iota(schedule.order.begin(), schedule.order.end(), size_t{0});
  std::ranges::stable_sort(schedule.order, {},
                           [&schedule](size_t step) { return schedule.branch_of_step[step]; });
  schedule.last_reader.resize(program.values.size(), 0);
  for (size_t i = 0; i < schedule.order.size(); ++i) {
    for (const int id : inputs_of(program.steps[schedule.order[i]])) {
      schedule.last_reader[static_cast<size_t>(id)] = i;
    }
  }
  for (const ProgramPort& output : program.outputs) {
    schedule.last_reader[static_cast<size_t>(output.value)] = program.steps.size();
  }
  return schedule;
}

}  // namespace bevloc::nn
