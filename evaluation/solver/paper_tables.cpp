#include "evaluation/solver/paper_tables.h"

namespace bevloc::evaluation {
namespace {

PaperRow full(const char* input, int channels, const PerAxis& mae) {
  return {"Full", input, mae, {.channels = channels}, {SolverKind::kFullFft, SolverKind::kBlock}};
}

PaperRow decoupled(const char* input, const BevGrid& grid, int channels, double step_m,
                   const PerAxis& mae) {
  return {"Dec.",
          input,
          mae,
          {.grid = grid, .channels = channels, .step_m = step_m},
          {SolverKind::kDecoupledLiteral, SolverKind::kDecoupled, SolverKind::kDecoupledRefined}};
}

}  // namespace

std::vector<PaperTable> paper_tables() {
  return {
      {"Table III",
       {full("F", 16, {0.31, 0.14, 0.35}), decoupled("S", kFeatureGrid, 4, 0.2, {0.68, 0.25, 0.70}),
        decoupled("F", kFeatureGrid, 16, 0.2, {0.27, 0.14, 0.40}),
        decoupled("F", kFeatureGrid, 64, 0.2, {0.19, 0.13, 0.38})}},
      {"Table IV",
       {decoupled("F", kFeatureGrid, 16, 0.1, {0.26, 0.13, 0.40}),
        decoupled("F", kFeatureGrid, 16, 0.2, {0.27, 0.14, 0.40}),
        decoupled("F", kFeatureGrid, 16, 0.4, {0.26, 0.16, 0.40}),
        decoupled("F", kRasterGrid, 16, 0.1, {0.16, 0.14, 0.35}),
        decoupled("F", kRasterGrid, 16, 0.2, {0.16, 0.13, 0.35}),
        decoupled("F", kRasterGrid, 16, 0.4, {0.22, 0.16, 0.36})}}};
}

}  // namespace bevloc::evaluation
