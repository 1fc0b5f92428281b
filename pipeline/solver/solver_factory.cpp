#include "pipeline/solver/solver_factory.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/ranges.h>

#include "pipeline/solver/banded_matcher.h"
#include "pipeline/solver/grid_limits.h"
#include "pipeline/solver/reference/block_matcher.h"
#include "pipeline/solver/reference/decoupled_matcher.h"
#include "pipeline/solver/reference/full_fft_matcher.h"
#include "pipeline/solver/reference/full_matcher.h"
#include "pipeline/solver/reference/literal_matcher.h"

namespace bevloc {
namespace {

constexpr std::array<std::pair<std::string_view, SolverKind>, kSolverKinds> kNames{{
    {"full", SolverKind::kFull},
    {"full-fft", SolverKind::kFullFft},
    {"decoupled-literal", SolverKind::kDecoupledLiteral},
    {"decoupled-literal+refine", SolverKind::kDecoupledLiteralRefined},
    {"decoupled", SolverKind::kDecoupled},
    {"decoupled+refine", SolverKind::kDecoupledRefined},
    {"banded", SolverKind::kBanded},
    {"banded+refine", SolverKind::kBandedRefined},
    {"block", SolverKind::kBlock},
    {"block+refine", SolverKind::kBlockRefined},
}};

/// The most channels x rows x columns. It is far beyond any use, as are the limits of the
/// hypotheses.
constexpr int kMaxFeatures = 1 << 24;

// Limits of the grids of matchers that set no limits of their own. The memory of block matching
// grows with the area of the grid, and block sizes in cells must fit an int.
constexpr int kLeastGridSide = 3;
constexpr double kLeastCell_m = 0.001;
constexpr double kMaxGridSide_m = 80.0;

bool is_positive(double value) {
  return std::isfinite(value) && value > 0.0;
}

Status check_axis(std::string_view name, const HypothesisAxis& axis, double max_range) {
  if (is_sound(axis, max_range)) return {};
  return fail(
      "hypotheses of {}: found range {} and step {}, wanted 0 < step <= range <= {} and at most {} "
      "steps",
      name, axis.range, axis.step, max_range, kMaxHalfCount);
}

Status check_parameters(SolverKind kind, const SolverParameters& parameters) {
  for (const auto& [name, value] :
       {std::pair("joint_scale", parameters.joint_scale), std::pair("x_scale", parameters.x_scale),
        std::pair("y_scale", parameters.y_scale), std::pair("yaw_scale", parameters.yaw_scale),
        std::pair("refine_x_scale", parameters.refine_x_scale),
        std::pair("refine_y_scale", parameters.refine_y_scale),
        std::pair("refine_yaw_scale", parameters.refine_yaw_scale),
        std::pair("sigma_scale", parameters.sigma_scale),
        std::pair("score_scale", parameters.score_scale),
        std::pair("banded_x_scale", parameters.banded_x_scale),
        std::pair("banded_y_scale", parameters.banded_y_scale),
        std::pair("gem_omega", parameters.gem_omega)}) {
    if (!is_positive(value)) {
      return fail("solver parameter {}: found {}, wanted a finite number above 0", name, value);
    }
  }
  if (parameters.gem_omega != 1.0F && !is_literal(kind)) {
    return fail("solver parameter gem_omega: found {}, wanted 1 (the arithmetic mean)",
                parameters.gem_omega);
  }
  return {};
}

Status check_size(const BevGrid& grid) {
  if (std::min(grid.rows, grid.cols) >= kLeastGridSide && grid.cell_m >= kLeastCell_m &&
      std::max(grid.rows, grid.cols) * grid.cell_m <= kMaxGridSide_m) {
    return {};
  }
  return refuse_grid(
      grid, fmt::format("at least {} rows and columns of cells of at least {} m, and sides of at "
                        "most {} m",
                        kLeastGridSide, kLeastCell_m, kMaxGridSide_m));
}

Status check_grid(SolverKind kind, const BevGrid& grid) {
  if (grid.rows <= 0 || grid.rows > kMaxGridSide || grid.cols <= 0 || grid.cols > kMaxGridSide ||
      !(grid.cell_m >= kLeastCell_m) ||
      !(std::max(grid.rows, grid.cols) * grid.cell_m <= kMaxGridSide_m)) {
    return refuse_grid(grid, fmt::format("1 to {} rows and columns of cells of at least {} m, and "
                                         "sides of at most {} m",
                                         kMaxGridSide, kLeastCell_m, kMaxGridSide_m));
  }
  switch (kind) {
    case SolverKind::kDecoupledLiteral:
    case SolverKind::kDecoupledLiteralRefined:
      return LiteralMatcher::check_grid(grid);
    case SolverKind::kDecoupled:
    case SolverKind::kDecoupledRefined:
      return DecoupledMatcher::check_grid(grid);
    default:
      return check_size(grid);
  }
}

Status check(SolverKind kind, const BevGrid& grid, int channels, const HypothesisGrid& hypotheses) {
  if (auto status = check_grid(kind, grid); !status) return status;
  const int max_channels = kMaxFeatures / grid.cells();
  if (channels <= 0 || channels > max_channels) {
    return fail("solver: found {} channels, wanted 1 to {}", channels, max_channels);
  }
  const double max_range_m = max_shift_m(grid);
  if (auto status = check_axis("x", hypotheses.x_m, max_range_m); !status) return status;
  if (auto status = check_axis("y", hypotheses.y_m, max_range_m); !status) return status;
  if (auto status = check_axis("yaw", hypotheses.yaw_rad, radians(kMaxYawRange_deg)); !status) {
    return status;
  }
  if (const double count = count_of(hypotheses); count > kMaxHypotheses) {
    return fail("hypotheses: found {} in all, wanted at most {}", count, kMaxHypotheses);
  }
  return {};
}

std::unique_ptr<Matcher> make_matcher(SolverKind kind, const BevGrid& grid, int channels,
                                      const HypothesisGrid& hypotheses,
                                      const SolverParameters& parameters) {
  switch (kind) {
    case SolverKind::kFull:
      return std::make_unique<FullMatcher>(grid, channels, hypotheses, parameters);
    case SolverKind::kFullFft:
      return std::make_unique<FullFftMatcher>(grid, channels, hypotheses, parameters);
    case SolverKind::kDecoupledLiteral:
    case SolverKind::kDecoupledLiteralRefined:
      return std::make_unique<LiteralMatcher>(grid, channels, hypotheses, parameters);
    case SolverKind::kDecoupled:
    case SolverKind::kDecoupledRefined:
      return std::make_unique<DecoupledMatcher>(grid, channels, hypotheses, parameters);
    case SolverKind::kBanded:
    case SolverKind::kBandedRefined:
      return std::make_unique<BandedMatcher>(grid, channels, hypotheses, parameters);
    case SolverKind::kBlock:
    case SolverKind::kBlockRefined:
      return std::make_unique<BlockMatcher>(grid, channels, hypotheses, parameters);
  }
  return nullptr;
}

}  // namespace

bool is_sound(const HypothesisAxis& axis, double max_range) {
  return is_positive(axis.step) && is_positive(axis.range) && axis.step <= axis.range &&
         axis.range / axis.step <= kMaxHalfCount && axis.farthest() <= max_range;
}

double count_of(const HypothesisGrid& hypotheses) {
  return static_cast<double>(hypotheses.x_m.count()) * hypotheses.y_m.count() *
         hypotheses.yaw_rad.count();
}

Result<SolverKind> solver_kind_from(std::string_view name) {
  std::vector<std::string_view> known;
  for (const auto& [candidate, kind] : kNames) {
    if (candidate == name) return kind;
    known.push_back(candidate);
  }
  return fail("solver: found \"{}\", wanted one of {}", name, fmt::join(known, ", "));
}

std::string_view name_of(SolverKind kind) {
  const auto found =
      std::ranges::find(kNames, kind, &std::pair<std::string_view, SolverKind>::second);
  assert(found != kNames.end());
  return found->first;
}

std::array<SolverKind, kSolverKinds> all_solver_kinds() {
  std::array<SolverKind, kSolverKinds> kinds{};
  std::ranges::transform(kNames, kinds.begin(), &std::pair<std::string_view, SolverKind>::second);
  return kinds;
}

bool is_literal(SolverKind kind) {
  return kind == SolverKind::kDecoupledLiteral || kind == SolverKind::kDecoupledLiteralRefined;
}

bool is_refined(SolverKind kind) {
  return kind == SolverKind::kDecoupledLiteralRefined || kind == SolverKind::kDecoupledRefined ||
         kind == SolverKind::kBandedRefined || kind == SolverKind::kBlockRefined;
}

Result<std::unique_ptr<Solver>> make_solver(SolverKind kind, const BevGrid& grid, int channels,
                                            const HypothesisGrid& hypotheses,
                                            const SolverParameters& parameters) {
  if (auto status = check(kind, grid, channels, hypotheses); !status) {
    return tl::unexpected(status.error());
  }
  if (auto status = check_parameters(kind, parameters); !status) {
    return tl::unexpected(status.error());
  }
  return std::make_unique<Solver>(grid, channels, hypotheses, parameters,
                                  make_matcher(kind, grid, channels, hypotheses, parameters),
                                  is_refined(kind) ? Refine::kYes : Refine::kNo);
}

}  // namespace bevloc
