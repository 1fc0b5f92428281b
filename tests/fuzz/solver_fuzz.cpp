// Solves random cases and checks the results. Usage: solver_fuzz --cases N --seed S. At the first
// failure it prints the seed that reproduces it and exits with 1.
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "tests/fuzz/nasty_features.h"
#include "tests/fuzz/solver_invariants.h"
#include "tests/fuzz/solver_request.h"

namespace bevloc::fuzz {
namespace {

/// Cases per solver. Making a solver takes longer than a solve, and sharing one also tests that no
/// case affects the next.
constexpr std::int64_t kCasesPerSolver = 24;

struct Statistics {
  std::int64_t cases = 0;
  std::int64_t solvers = 0;
  std::int64_t refusals = 0;
  std::int64_t matched = 0;
  std::int64_t without_evidence = 0;
};

SolverResult solve(Solver& solver, const SolverRequest& request, const FeaturePair& pair) {
  SolverResult result;
  solver.solve({pair.bev, request.channels, request.grid},
               {pair.map, request.channels, request.grid}, result);
  return result;
}

bool same(const SolverResult& a, const SolverResult& b) {
  return a.evidence == b.evidence && a.x_probability == b.x_probability &&
         a.y_probability == b.y_probability && a.yaw_probability == b.yaw_probability &&
         a.covariance == b.covariance;
}

Status check_evidence(const SolverResult& result, const FeaturePair& pair) {
  const bool none = has_no_structure(pair.bev_sort) || has_no_structure(pair.map_sort);
  const bool good = has_structure(pair.bev_sort) && has_structure(pair.map_sort);
  if (none && result.evidence != Evidence::kNone)
    return fail("found Evidence::kGood for features without structure");
  if (good && result.evidence != Evidence::kGood)
    return fail("found Evidence::kNone for features with structure");
  return {};
}

Status check_solves(Random& random, Solver& solver, const SolverRequest& request,
                    std::int64_t cases, Statistics& statistics) {
  std::optional<std::pair<FeaturePair, SolverResult>> first;
  for (std::int64_t i = 0; i < cases; ++i) {
    FeaturePair pair = draw_features(random, request);
    SolverResult result = solve(solver, request, pair);
    Status status = check_result(result, request.hypotheses, request.parameters.score_scale);
    if (status) status = check_evidence(result, pair);
    if (!status) {
      return fail("case {}, {} on {}: {}", i, name_of(pair.bev_sort), name_of(pair.map_sort),
                  status.error().message);
    }
    const bool matched = result.evidence == Evidence::kGood;
    (matched ? statistics.matched : statistics.without_evidence) += 1;
    if (matched && !first) first.emplace(std::move(pair), std::move(result));
  }
  if (first && !same(solve(solver, request, first->first), first->second)) {
    return fail("{} on {}: found another result after {} cases", name_of(first->first.bev_sort),
                name_of(first->first.map_sort), cases);
  }
  return {};
}

/// Draws one solver and solves `cases` cases with it, or checks that it was refused.
Status check_solver(std::uint64_t seed, std::int64_t cases, Statistics& statistics) {
  Random random(seed);
  const SolverRequest request = draw_request(random);
  auto solver = make_solver(request.kind, request.grid, request.channels, request.hypotheses,
                            request.parameters);
  ++statistics.solvers;
  Status status;
  if (!solver) {
    ++statistics.refusals;
    const std::string& message = solver.error().message;
    if (request.acceptance == Acceptance::kMust)
      status = fail("refused valid arguments: {}", message);
    if (message.find(request.culprit) == std::string::npos) {
      status = fail("found error \"{}\", wanted one that names \"{}\"", message, request.culprit);
    }
  } else if (request.acceptance == Acceptance::kMustNot) {
    status = fail("accepted invalid arguments: {}", request.culprit);
  } else {
    status = check_solves(random, **solver, request, cases, statistics);
  }
  if (!status) return fail("{}: {}", describe(request), status.error().message);
  return {};
}

Status check_group(std::uint64_t seed, std::int64_t cases, Statistics& statistics) {
  try {
    return check_solver(seed, cases, statistics);
  } catch (const std::exception& error) {
    return fail("exception: {}", error.what());
  }
}

/// The number in `text`; 0 if it is not a whole number.
std::int64_t number_of(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() ? number : 0;
}

int run(std::int64_t cases, std::uint64_t seed) {
  Statistics statistics;
  for (std::uint64_t group = seed; statistics.cases < cases; ++group) {
    const std::int64_t solved = statistics.matched + statistics.without_evidence;
    const std::int64_t left = std::min(kCasesPerSolver, cases - statistics.cases);
    if (const Status status = check_group(group, left, statistics); !status) {
      fmt::print(stderr, "solver_fuzz --cases {} --seed {} fails: {}\n", kCasesPerSolver, group,
                 status.error().message);
      return EXIT_FAILURE;
    }
    // A refusal counts as one case.
    statistics.cases +=
        std::max<std::int64_t>(1, statistics.matched + statistics.without_evidence - solved);
  }
  fmt::print("{} cases: {} solvers requested, {} refused; {} solves with evidence, {} without\n",
             statistics.cases, statistics.solvers, statistics.refusals, statistics.matched,
             statistics.without_evidence);
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace bevloc::fuzz

int main(int argc, char** argv) {
  std::int64_t cases = 20'000;
  std::int64_t seed = 1;
  for (int i = 1; i < argc; i += 2) {
    const std::string_view option = argv[i];
    std::int64_t* target = option == "--cases" ? &cases : option == "--seed" ? &seed : nullptr;
    const std::string_view value = i + 1 < argc ? argv[i + 1] : "";
    if (target != nullptr) *target = bevloc::fuzz::number_of(value);
    if (target == nullptr || *target <= 0) {
      fmt::print(stderr, "solver_fuzz: found \"{} {}\", wanted --cases N or --seed S\n", option,
                 value);
      return EXIT_FAILURE;
    }
  }
  return bevloc::fuzz::run(cases, seed);
}
