#include "tests/fuzz/solver_request.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace bevloc::fuzz {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array kBadNumbers = {kNan, kInfinity, -kInfinity, 0.0, -1.0, -1e-300};

template <typename T>
auto pick(Random& random, const T& choices) {
  return choices[integer(random, 0, static_cast<int>(std::size(choices)) - 1)];
}

bool reads_spectrum(SolverKind kind) {
  return is_literal(kind) || kind == SolverKind::kDecoupled ||
         kind == SolverKind::kDecoupledRefined;
}

SolverKind draw_kind(Random& random) {
  const auto kinds = all_solver_kinds();
  const SolverKind kind = pick(random, kinds);
  // Their Fourier transforms take longer than all other solvers together.
  return reads_spectrum(kind) && integer(random, 0, 7) > 0 ? pick(random, kinds) : kind;
}

int draw_side(Random& random, SolverKind kind) {
  constexpr std::array kSmall = {4, 4, 5, 5, 8, 10};
  constexpr std::array kLarge = {16, 20, 25, 32, 40};
  if (integer(random, 0, 31) == 0) return pick(random, kLarge);
  return is_literal(kind) ? pick(random, kSmall) : integer(random, 3, 10);
}

BevGrid draw_grid(Random& random, SolverKind kind) {
  BevGrid grid{draw_side(random, kind), draw_side(random, kind), 0.0};
  // The yaw spectrum averages cells of 0.3 m or less, and needs at least 3 rows and columns then.
  grid.cell_m = uniform(random, std::min(grid.rows, grid.cols) < 12 ? 0.31 : 0.15, 0.62);
  return grid;
}

/// The range need not be a multiple of the step.
HypothesisAxis draw_axis(Random& random, double max_range) {
  const int half_count = std::min(integer(random, 1, 3), integer(random, 1, 12));
  const double step = uniform(random, 0.05, 0.999) * max_range / half_count;
  const double fraction = uniform(random, half_count == 1 ? 0.0 : -0.45, 0.45);
  return {(half_count + fraction) * step, step};
}

std::array<std::pair<const char*, float*>, 12> parameters_of(SolverParameters& p) {
  return {{{"joint_scale", &p.joint_scale},
           {"x_scale", &p.x_scale},
           {"y_scale", &p.y_scale},
           {"yaw_scale", &p.yaw_scale},
           {"refine_x_scale", &p.refine_x_scale},
           {"refine_y_scale", &p.refine_y_scale},
           {"refine_yaw_scale", &p.refine_yaw_scale},
           {"banded_x_scale", &p.banded_x_scale},
           {"banded_y_scale", &p.banded_y_scale},
           {"sigma_scale", &p.sigma_scale},
           {"score_scale", &p.score_scale},
           {"gem_omega", &p.gem_omega}}};
}

SolverParameters draw_parameters(Random& random, SolverKind kind) {
  SolverParameters parameters;
  const bool extreme = integer(random, 0, 15) == 0;
  for (auto [name, value] : parameters_of(parameters)) {
    *value = static_cast<float>(extreme ? log_uniform(random, 1e-37, 3e38)
                                        : log_uniform(random, 1.0, 1e4));
  }
  if (!extreme) parameters.sigma_scale = static_cast<float>(log_uniform(random, 0.1, 10.0));
  parameters.gem_omega =
      is_literal(kind) ? static_cast<float>(log_uniform(random, 0.1, 10.0)) : 1.0F;
  return parameters;
}

void spoil_grid(Random& random, SolverRequest& request) {
  constexpr std::array kSides = {
      0, -1, -5, 100'000, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
  request.culprit = "grid of";
  if (integer(random, 0, 1) == 0) {
    request.grid.rows = pick(random, kSides);
    if (integer(random, 0, 1) == 0) request.grid.cols = pick(random, kSides);
  } else {
    request.grid.cell_m = pick(random, kBadNumbers);
  }
}

void spoil_axis(Random& random, SolverRequest& request) {
  auto [name, axis] = pick(random, std::array{std::pair("of x", &request.hypotheses.x_m),
                                              std::pair("of y", &request.hypotheses.y_m),
                                              std::pair("of yaw", &request.hypotheses.yaw_rad)});
  request.culprit = name;
  switch (integer(random, 0, 4)) {
    case 0:
      axis->range = pick(random, kBadNumbers);
      break;
    case 1:
      axis->step = pick(random, kBadNumbers);
      break;
    case 2:
      axis->step = axis->range * 1.01;
      break;
    case 3:  // too many hypotheses
      axis->step = axis->range * log_uniform(random, 1e-300, 1e-7);
      break;
    default:
      axis->range += uniform(random, 10.0, 1e6);
      axis->step = axis->range;
  }
}

void spoil_parameter(Random& random, SolverRequest& request) {
  const auto [name, value] = pick(random, parameters_of(request.parameters));
  request.culprit = name;
  *value = static_cast<float>(pick(random, kBadNumbers));
}

void spoil(Random& random, SolverRequest& request) {
  request.acceptance = Acceptance::kMustNot;
  switch (integer(random, 0, 3)) {
    case 0:
      return spoil_grid(random, request);
    case 1:
      return spoil_axis(random, request);
    case 2:
      return spoil_parameter(random, request);
    default:
      constexpr std::array kChannels = {0, -1, 1'000'000'000, std::numeric_limits<int>::max(),
                                        std::numeric_limits<int>::min()};
      request.channels = pick(random, kChannels);
      request.culprit = "channels";
  }
}

/// Draws arguments near the limits, which the solver may accept or refuse.
void draw_at_the_limits(Random& random, SolverRequest& request) {
  request.acceptance = Acceptance::kMay;
  request.grid = {integer(random, 1, 12), integer(random, 1, 12), uniform(random, 0.05, 0.7)};
  request.hypotheses = {draw_axis(random, max_shift_m(request.grid)),
                        draw_axis(random, max_shift_m(request.grid)),
                        draw_axis(random, radians(kMaxYawRange_deg))};
  request.parameters.gem_omega = static_cast<float>(log_uniform(random, 1e-30, 1e30));
  if (integer(random, 0, 1) == 0) request.parameters.gem_omega = 1.0F;
}

}  // namespace

double log_uniform(Random& random, double low, double high) {
  return std::exp(uniform(random, std::log(low), std::log(high)));
}

SolverRequest draw_request(Random& random) {
  SolverRequest request;
  request.kind = draw_kind(random);
  request.grid = draw_grid(random, request.kind);
  request.channels = std::min(integer(random, 1, 20), integer(random, 1, 20));
  request.hypotheses = {draw_axis(random, max_shift_m(request.grid)),
                        draw_axis(random, max_shift_m(request.grid)),
                        draw_axis(random, radians(kMaxYawRange_deg))};
  request.parameters = draw_parameters(random, request.kind);
  const int dice = integer(random, 0, 7);
  if (dice == 0) spoil(random, request);
  if (dice == 1) draw_at_the_limits(random, request);
  return request;
}

std::string describe(const SolverRequest& request) {
  const HypothesisGrid& h = request.hypotheses;
  return fmt::format(
      "{} on {} x {} cells of {} m, {} channels, hypotheses x {}/{} y {}/{} yaw {}/{}, joint_scale "
      "{} x_scale {} sigma_scale {} gem_omega {}",
      name_of(request.kind), request.grid.rows, request.grid.cols, request.grid.cell_m,
      request.channels, h.x_m.range, h.x_m.step, h.y_m.range, h.y_m.step, h.yaw_rad.range,
      h.yaw_rad.step, request.parameters.joint_scale, request.parameters.x_scale,
      request.parameters.sigma_scale, request.parameters.gem_omega);
}

}  // namespace bevloc::fuzz
