#include "firmware/evaluation/network_report.h"

#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "firmware/evaluation/summary_format.h"

namespace bevloc::evaluation {

std::string table_of(const SetResult& result) {
  std::string text = fmt::format(
      "{}: {}\nIoU divider {:.3f}, crossing {:.3f}, boundary {:.3f}\n"
      "{:17} {:17}   {:17}   {:17}   {:17}   {:14}   {:11}   {:11}\n"
      "{:17} {:17}   {:17}   {:17}   {:17}   {:14}   {:11}   {:11}\n",
      sim::name_of(result.set), sim::describe(result.set), result.iou[0], result.iou[1],
      result.iou[2], "solver", "MAE", "RMSE", "median", "95 %", "NLL", "1 sigma, %", "3 sigma, %",
      "", "x m   y m   deg", "x m   y m   deg", "x m   y m   deg", "x m   y m   deg",
      "x    y    yaw", "x   y   yaw", "x   y   yaw");
  for (const ReadOut& read_out : result.read_outs) {
    const Summary s = summarise(read_out.outcomes);
    fmt::format_to(std::back_inserter(text),
                   "{:17} {:17}   {:17}   {:17}   {:17}   {:14}   {}   {}\n", read_out.name,
                   three(s.mae), three(s.rmse), three(s.median), three(s.p95), three(s.nll, 2),
                   percent(s.coverage_1s), percent(s.coverage_3s));
  }
  return text;
}

std::string to_json(const std::vector<SetResult>& results,
                    const NetworkEvaluationSubject& subject) {
  nlohmann::json json{{"model", subject.model},
                      {"map", subject.map},
                      {"scenes", subject.frames},
                      {"seed", subject.seed},
                      {"rows", nlohmann::json::array()}};
  for (const SetResult& result : results) {
    for (const ReadOut& read_out : result.read_outs) {
      nlohmann::json row = json_of(summarise(read_out.outcomes));
      row["set"] = sim::name_of(result.set);
      row["solver"] = read_out.name;
      row["iou"] = result.iou;
      json["rows"].push_back(std::move(row));
    }
  }
  return json.dump(2) + "\n";
}

std::string to_csv(const std::vector<SetResult>& results) {
  std::string text =
      "set,solver,scenes" + csv_columns() + ",iou_divider,iou_crossing,iou_boundary\n";
  for (const SetResult& result : results) {
    for (const ReadOut& read_out : result.read_outs) {
      const Summary summary = summarise(read_out.outcomes);
      fmt::format_to(std::back_inserter(text), "{},{},{}{},{:.6g},{:.6g},{:.6g}\n",
                     sim::name_of(result.set), read_out.name, summary.scenes, csv_values(summary),
                     result.iou[0], result.iou[1], result.iou[2]);
    }
  }
  return text;
}

}  // namespace bevloc::evaluation
