#include "evaluation/solver/solver_report.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_dump.h"
#include "evaluation/solver/paper_tables.h"
#include "evaluation/summary_format.h"

namespace bevloc::evaluation {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;

std::string label(const SolverCase& solver_case) {
  return fmt::format("{:24} {:>7} {:>3} {:4.1f}", name_of(solver_case.solver),
                     size_name(solver_case.grid), solver_case.channels, solver_case.step_m);
}

const CaseResult* find(const std::vector<CaseResult>& results, const SolverCase& wanted) {
  const auto found = std::ranges::find(results, wanted, &CaseResult::solver_case);
  return found == results.end() ? nullptr : &*found;
}

/// The time of full-fft with the same grid, channels and step.
std::optional<double> reference_time_ms(const std::vector<CaseResult>& results,
                                        SolverCase solver_case) {
  solver_case.solver = SolverKind::kFullFft;
  const CaseResult* reference = find(results, solver_case);
  if (reference == nullptr) return std::nullopt;
  return summarise(reference->outcomes).time_ms;
}

/// Memory of a tensor framework that warps every hypothesis at once. Computed, not measured.
double batched_full_bytes(const SolverCase& solver_case) {
  return static_cast<double>(solver_case.hypotheses().count()) * solver_case.channels *
         solver_case.grid.cells() * sizeof(float);
}

template <typename Predicate>
std::vector<Outcome> outcomes_where(const CaseResult& result, Predicate wanted) {
  std::vector<Outcome> outcomes;
  std::ranges::copy_if(result.outcomes, std::back_inserter(outcomes), wanted, &Outcome::road);
  return outcomes;
}

std::vector<Outcome> on_road(const CaseResult& result, sim::RoadKind road) {
  return outcomes_where(result, [road](sim::RoadKind other) { return other == road; });
}

std::string road_row(std::string_view road, const Summary& s) {
  return fmt::format("{:22} {:6}   {:17}   {:17}   {:14}   {}   {}\n", road, s.scenes, three(s.mae),
                     three(s.median), three(s.nll, 2), percent(s.coverage_1s),
                     percent(s.coverage_3s));
}

std::string csv_line(const CaseResult& result, std::string_view road, const Summary& summary) {
  return fmt::format("{},{},{},{},{},{}{}{},{}\n", name_of(result.solver_case.solver),
                     size_name(result.solver_case.grid), result.solver_case.channels,
                     result.solver_case.step_m, road, summary.scenes, csv_values(summary),
                     csv_value(summary.time_ms), result.buffer_bytes);
}

std::string paper_row(const PaperRow& row, const std::vector<CaseResult>& results) {
  std::string text =
      fmt::format("{:6} {:>2} {:>7} {:>3} {:4.1f}   {:16}", row.solver, row.input,
                  size_name(row.ours.grid), row.ours.channels, row.ours.step_m, three(row.mae, 2));
  for (const SolverKind kind : row.our_solvers) {
    SolverCase ours = row.ours;
    ours.solver = kind;
    const CaseResult* result = find(results, ours);
    fmt::format_to(std::back_inserter(text), "   {} {}", name_of(kind),
                   result != nullptr ? three(summarise(result->outcomes).mae) : "not run");
  }
  return text + '\n';
}

}  // namespace

std::string accuracy_table(const std::vector<CaseResult>& results) {
  std::string text = fmt::format(
      "{:41}   {:17}   {:17}   {:17}   {:17}   {:14}   {:11}   {:11}\n"
      "{:41}   {:17}   {:17}   {:17}   {:17}   {:14}   {:11}   {:11}\n",
      "solver                      size   C step", "MAE", "RMSE", "95 %", "MAE, parabola", "NLL",
      "1 sigma", "3 sigma", "", "x m   y m   deg", "x m   y m   deg", "x m   y m   deg",
      "x m   y m   deg", "x    y    yaw", "x   y   yaw", "x   y   yaw");
  for (const CaseResult& result : results) {
    const Summary s = summarise(result.outcomes);
    fmt::format_to(
        std::back_inserter(text), "{}   {:17}   {:17}   {:17}   {:17}   {:14}   {}   {}\n",
        label(result.solver_case), three(s.mae), three(s.rmse), three(s.p95), three(s.parabola_mae),
        three(s.nll, 2), percent(s.coverage_1s), percent(s.coverage_3s));
  }
  return text;
}

std::string cost_table(const std::vector<CaseResult>& results) {
  std::string text = fmt::format("{:41}   {:>9}   {:>11}   {:>12}   {:>19}\n",
                                 "solver                      size   C step", "time, ms",
                                 "vs full-fft", "buffers, MiB", "vs batched full");
  for (const CaseResult& result : results) {
    const double time_ms = summarise(result.outcomes).time_ms;
    const auto reference_ms = reference_time_ms(results, result.solver_case);
    const double bytes = static_cast<double>(result.buffer_bytes);
    fmt::format_to(std::back_inserter(text), "{}   {:9.3f}   {:>11}   {:12.2f}   {:>19}\n",
                   label(result.solver_case), time_ms,
                   reference_ms ? fmt::format("1/{:.1f}", *reference_ms / time_ms) : "-",
                   bytes / kMiB,
                   fmt::format("1/{:.0f}", batched_full_bytes(result.solver_case) / bytes));
  }
  return text;
}

std::string road_table(const CaseResult& result) {
  std::string text =
      fmt::format("{:22} {:>6}   {:17}   {:17}   {:14}   {:11}   {:11}\n", "road", "scenes",
                  "MAE x m y m deg", "median", "NLL x y yaw", "1 sigma, %", "3 sigma, %");
  for (int road = 0; road < sim::kRoadKinds; ++road) {
    const auto kind = static_cast<sim::RoadKind>(road);
    text += road_row(sim::name(kind), summarise(on_road(result, kind)));
  }
  // A straight road with solid lines does not constrain x.
  const auto with_structure = outcomes_where(
      result, [](sim::RoadKind road) { return road != sim::RoadKind::kStraightSolid; });
  text += road_row("all but straight_solid", summarise(with_structure));
  text += road_row("all", summarise(result.outcomes));
  return text;
}

std::string paper_comparison(const std::vector<CaseResult>& results) {
  std::string text;
  for (const PaperTable& table : paper_tables()) {
    fmt::format_to(std::back_inserter(text), "{}, MAE x m, y m, deg\n{:27}   {:16}   {}\n",
                   table.title, "solver in   size   C step", "paper", "bevloc");
    for (const PaperRow& row : table.rows) text += paper_row(row, results);
  }
  return text;
}

std::string to_json(const std::vector<CaseResult>& results, const EvaluationOptions& options,
                    uint64_t seed) {
  nlohmann::json json{{"corruption", sim::name(options.corruption)},
                      {"scenes", options.scenes},
                      {"seed", seed},
                      {"rows", nlohmann::json::array()}};
  for (const CaseResult& result : results) {
    const Summary summary = summarise(result.outcomes);
    nlohmann::json row = json_of(summary);
    row["solver"] = name_of(result.solver_case.solver);
    row["size"] = size_name(result.solver_case.grid);
    row["channels"] = result.solver_case.channels;
    row["step_m"] = result.solver_case.step_m;
    row["time_ms"] = summary.time_ms;
    row["buffer_bytes"] = result.buffer_bytes;
    for (int road = 0; road < sim::kRoadKinds; ++road) {
      const auto kind = static_cast<sim::RoadKind>(road);
      row["roads"][sim::name(kind)] = json_of(summarise(on_road(result, kind)));
    }
    json["rows"].push_back(std::move(row));
  }
  return json_document(json);
}

std::string to_csv(const std::vector<CaseResult>& results) {
  std::string text = "solver,size,channels,step_m,road,scenes" + csv_columns();
  text += ",time_ms,buffer_bytes\n";
  for (const CaseResult& result : results) {
    text += csv_line(result, "all", summarise(result.outcomes));
    for (int road = 0; road < sim::kRoadKinds; ++road) {
      const auto kind = static_cast<sim::RoadKind>(road);
      text += csv_line(result, sim::name(kind), summarise(on_road(result, kind)));
    }
  }
  return text;
}

}  // namespace bevloc::evaluation
