#include "evaluation/network/network_report.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_dump.h"
#include "evaluation/summary_format.h"

namespace bevloc::evaluation {
namespace {

std::string label_of(const ReadOut& read_out) {
  return read_out.solver_case ? label_of(*read_out.solver_case) : read_out.name;
}

/// The keys that describe a solver's input. All are null if the method is no solver.
nlohmann::json json_of(const std::optional<ReadOutCase>& read_out) {
  nlohmann::json json{
      {"input", nullptr}, {"size", nullptr}, {"channels", nullptr}, {"step_m", nullptr}};
  if (!read_out) return json;
  const SolverCase& c = read_out->solver_case;
  json["input"] = name_of(read_out->input);
  json["size"] = size_name(c.grid);
  json["channels"] = c.channels;
  json["step_m"] = c.step_m;
  return json;
}

/// The same values as the last columns of a CSV line.
std::string csv_of(const std::optional<ReadOutCase>& read_out) {
  if (!read_out) return ",,,,";
  const SolverCase& c = read_out->solver_case;
  return fmt::format(",{},{},{},{}", name_of(read_out->input), size_name(c.grid), c.channels,
                     c.step_m);
}

}  // namespace

std::string table_of(const SetResult& result) {
  size_t width = 0;
  for (const ReadOut& read_out : result.read_outs) {
    width = std::max(width, label_of(read_out).size());
  }
  std::string text = fmt::format(
      "{}: {}\nIoU divider {:.3f}, crossing {:.3f}, boundary {:.3f}\n"
      "{:{}} {:17}   {:17}   {:17}   {:17}   {:14}   {:11}   {:11}\n"
      "{:{}} {:17}   {:17}   {:17}   {:17}   {:14}   {:11}   {:11}\n",
      sim::name_of(result.set), sim::describe(result.set), result.iou[0], result.iou[1],
      result.iou[2], "solver", width, "MAE", "RMSE", "median", "95 %", "NLL", "1 sigma, %",
      "3 sigma, %", "", width, "x m   y m   deg", "x m   y m   deg", "x m   y m   deg",
      "x m   y m   deg", "x    y    yaw", "x   y   yaw", "x   y   yaw");
  for (const ReadOut& read_out : result.read_outs) {
    const Summary s = summarise(read_out.outcomes);
    fmt::format_to(std::back_inserter(text),
                   "{:{}} {:17}   {:17}   {:17}   {:17}   {:14}   {}   {}\n", label_of(read_out),
                   width, three(s.mae), three(s.rmse), three(s.median), three(s.p95),
                   three(s.nll, 2), percent(s.coverage_1s), percent(s.coverage_3s));
  }
  return text;
}

std::string to_json(const std::vector<SetResult>& results,
                    const NetworkEvaluationSubject& subject) {
  nlohmann::json json{{"model", subject.model},
                      {"map", subject.map},
                      {"scenes", subject.samples},
                      {"seed", subject.seed},
                      {"rows", nlohmann::json::array()}};
  for (const SetResult& result : results) {
    for (const ReadOut& read_out : result.read_outs) {
      nlohmann::json row = json_of(summarise(read_out.outcomes));
      row["set"] = sim::name_of(result.set);
      row["solver"] = read_out.name;
      row["iou"] = result.iou;
      row.update(json_of(read_out.solver_case));
      json["rows"].push_back(std::move(row));
    }
  }
  return json_document(json);
}

std::string to_csv(const std::vector<SetResult>& results) {
  std::string text = "set,solver,scenes" + csv_columns() +
                     ",iou_divider,iou_crossing,iou_boundary" + ",input,size,channels,step_m\n";
  for (const SetResult& result : results) {
    for (const ReadOut& read_out : result.read_outs) {
      const Summary summary = summarise(read_out.outcomes);
      fmt::format_to(std::back_inserter(text), "{},{},{}{},{:.6g},{:.6g},{:.6g}{}\n",
                     sim::name_of(result.set), read_out.name, summary.scenes, csv_values(summary),
                     result.iou[0], result.iou[1], result.iou[2], csv_of(read_out.solver_case));
    }
  }
  return text;
}

}  // namespace bevloc::evaluation
