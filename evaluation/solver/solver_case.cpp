#include "evaluation/solver/solver_case.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace bevloc::evaluation {
namespace {

struct AxisScales {
  float x = 0.0F;
  float y = 0.0F;
  float yaw = 0.0F;
};

struct HandMadeScales {
  int channels;
  int rows;
  float full;
  float block;
  AxisScales refine;
  AxisScales decoupled;
  AxisScales literal;
  AxisScales banded;  ///< yaw is not used
};

constexpr std::array<HandMadeScales, 5> kHandMadeScales{{
    {16, 100, 250, 350, {175, 300, 500}, {60, 250, 175}, {90, 175, 125}, {125, 175, 0}},
    {3, 100, 125, 175, {90, 400, 250}, {46, 175, 150}, {46, 90, 65}, {125, 175, 0}},
    {4, 100, 125, 175, {90, 400, 250}, {46, 175, 150}, {46, 90, 65}, {125, 175, 0}},
    {64, 100, 250, 350, {175, 300, 500}, {60, 250, 175}, {90, 175, 125}, {125, 175, 0}},
    {16, 400, 250, 350, {100, 500, 180}, {50, 250, 175}, {125, 175, 480}, {125, 175, 0}},
}};

}  // namespace

HypothesisGrid SolverCase::hypotheses() const {
  HypothesisGrid hypotheses;
  hypotheses.x_m.step = step_m;
  hypotheses.y_m.step = step_m;
  hypotheses.yaw_rad.step = radians(step_m);
  return hypotheses;
}

bool SolverCase::operator==(const SolverCase& other) const {
  return solver == other.solver && grid.rows == other.grid.rows && grid.cols == other.grid.cols &&
         channels == other.channels && step_m == other.step_m;
}

std::string size_name(const BevGrid& grid) {
  return fmt::format("{}x{}", grid.rows, grid.cols);
}

std::vector<SolverCase> variant_cases() {
  std::vector<SolverCase> cases;
  for (const SolverKind kind : all_solver_kinds()) cases.push_back({.solver = kind});
  return cases;
}

std::vector<SolverCase> table_three_cases() {
  std::vector<SolverCase> cases;
  for (const int channels : {3, 4, 16, 64}) {
    for (const SolverKind kind :
         {SolverKind::kFullFft, SolverKind::kDecoupledLiteral, SolverKind::kDecoupled,
          SolverKind::kDecoupledRefined, SolverKind::kBlock}) {
      cases.push_back({.solver = kind, .channels = channels});
    }
  }
  return cases;
}

std::vector<SolverCase> table_four_cases() {
  std::vector<SolverCase> cases;
  for (const BevGrid& grid : {kFeatureGrid, kRasterGrid}) {
    for (const double step_m : {0.1, 0.2, 0.4}) {
      for (const SolverKind kind :
           {SolverKind::kDecoupledLiteral, SolverKind::kDecoupled, SolverKind::kDecoupledRefined}) {
        cases.push_back({.solver = kind, .grid = grid, .step_m = step_m});
      }
    }
    cases.push_back({.solver = SolverKind::kFullFft, .grid = grid});
  }
  return cases;
}

SolverParameters hand_made_parameters(const SolverCase& solver_case) {
  const auto found = std::ranges::find_if(kHandMadeScales, [&](const HandMadeScales& scales) {
    return scales.channels == solver_case.channels && scales.rows == solver_case.grid.rows;
  });
  const HandMadeScales& scales = found != kHandMadeScales.end() ? *found : kHandMadeScales.front();
  const AxisScales& axes = is_literal(solver_case.solver) ? scales.literal : scales.decoupled;
  const bool block =
      solver_case.solver == SolverKind::kBlock || solver_case.solver == SolverKind::kBlockRefined;
  return {.joint_scale = block ? scales.block : scales.full,
          .x_scale = axes.x,
          .y_scale = axes.y,
          .yaw_scale = axes.yaw,
          .refine_x_scale = scales.refine.x,
          .refine_y_scale = scales.refine.y,
          .refine_yaw_scale = scales.refine.yaw,
          .banded_x_scale = scales.banded.x,
          .banded_y_scale = scales.banded.y};
}

}  // namespace bevloc::evaluation
