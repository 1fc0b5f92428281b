#include "evaluation/solver/read_out_case.h"

#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/format.h>

namespace bevloc::evaluation {
namespace {

constexpr std::array<SolverKind, 5> kSolvers{SolverKind::kFullFft, SolverKind::kBlock,
                                             SolverKind::kDecoupled, SolverKind::kDecoupledRefined,
                                             SolverKind::kBandedRefined};

int channels_of(SolverInput input) {
  return input == SolverInput::kFeatures ? SolverCase{}.channels : 4;
}

void add(const ReadOutCase& read_out, std::vector<ReadOutCase>& cases) {
  if (std::ranges::find(cases, read_out) == cases.end()) cases.push_back(read_out);
}

/// The paper's Table III: each solver with the daemon's grid and steps.
void add_solvers(SolverInput input, std::vector<ReadOutCase>& cases) {
  for (const SolverKind kind : kSolvers) {
    add({input, {.solver = kind, .channels = channels_of(input)}}, cases);
  }
}

/// The paper's Table IV: the decoupled solvers, except the literal one, which has no learned
/// scales. The network's features have one size; masks have two.
void add_sizes_and_steps(SolverInput input, std::vector<ReadOutCase>& cases) {
  for (SolverCase solver_case : table_four_cases()) {
    const SolverKind kind = solver_case.solver;
    if (kind != SolverKind::kDecoupled && kind != SolverKind::kDecoupledRefined) continue;
    if (input == SolverInput::kFeatures && !(solver_case.grid == kFeatureGrid)) continue;
    solver_case.channels = channels_of(input);
    add({input, solver_case}, cases);
  }
}

}  // namespace

const char* name_of(SolverInput input) {
  switch (input) {
    case SolverInput::kFeatures:
      return "F";
    case SolverInput::kMasks:
      return "S";
    case SolverInput::kTrueMasks:
      return "T";
  }
  return "unknown";
}

std::string label_of(const ReadOutCase& read_out) {
  const SolverCase& solver_case = read_out.solver_case;
  const bool resized = !(solver_case.grid == kFeatureGrid);
  std::string label(name_of(solver_case.solver));
  if (read_out.input != SolverInput::kFeatures) label.append(" ").append(name_of(read_out.input));
  if (resized) label.append(" ").append(size_name(solver_case.grid));
  if (solver_case.step_m != SolverCase{}.step_m) {
    fmt::format_to(std::back_inserter(label), " {}", solver_case.step_m);
  }
  return label;
}

std::vector<ReadOutCase> read_out_cases(ReadOutRows rows) {
  std::vector<ReadOutCase> cases;
  if (rows == ReadOutRows::kBaselines) return cases;
  add_solvers(SolverInput::kFeatures, cases);
  if (rows == ReadOutRows::kSolvers) return cases;
  add_solvers(SolverInput::kMasks, cases);
  for (const SolverInput input : {SolverInput::kFeatures, SolverInput::kMasks}) {
    add_sizes_and_steps(input, cases);
  }
  add_solvers(SolverInput::kTrueMasks, cases);
  return cases;
}

}  // namespace bevloc::evaluation
