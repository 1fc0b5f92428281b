#include "evaluation/bench/bench_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_dump.h"

namespace bevloc::bench {
namespace {

constexpr double kGiga = 1e9;
constexpr double kMega = 1e6;
constexpr double kMiB = 1 << 20;

double macs_per_s(const StageResult& stage) {
  return stage.time.p50_ms > 0.0 ? kMs_per_s * stage.work.macs / stage.time.p50_ms : 0.0;
}

double share_of_peak(const StageResult& stage, const MachinePeak& peak) {
  return peak.macs_per_s() > 0.0 ? macs_per_s(stage) / peak.macs_per_s() : 0.0;
}

/// The text of a value. It is empty for 0, which stands for an unknown value.
std::string cell(double value, int decimals) {
  return value == 0.0 ? "" : fmt::format("{:.{}f}", value, decimals);
}

std::string row(const StageResult& stage, const MachinePeak& peak, bool counted) {
  const double ideal_ms = kMs_per_s * ideal_s(stage.work, peak);
  const TimeSummary& time = stage.time;
  return fmt::format(
      "{:16} {:>7.3f} {:>7.3f} {:>7.3f} {:>7.3f} {:>7} {:>7} {:>7} {:>7} {:>6} {:>8}\n", stage.name,
      time.p50_ms, time.p90_ms, time.p99_ms, time.max_ms,
      counted ? fmt::format("{:.1f}", stage.allocations) : "-", cell(stage.work.bytes / kMiB, 2),
      cell(stage.work.macs / kMega, 1), cell(macs_per_s(stage) / kGiga, 1),
      cell(100.0 * share_of_peak(stage, peak), 0), cell(ideal_ms, 3));
}

bool is_measured(const MachinePeak& peak) {
  return peak.copy_bytes_per_s > 0.0;
}

std::string machine_lines(const BenchResult& result) {
  const MachinePeak& peak = result.peak;
  const std::string lines =
      fmt::format("{}, {} frames at {} places, threads: {}\n{}, {}\n", result.model, result.frames,
                  result.places, result.threads, result.processor, result.instruction_set);
  if (!is_measured(peak)) return lines + "the machine's peak was not measured\n\n";
  const std::string matmul =
      peak.matmul_macs_per_s > 0.0
          ? fmt::format(", matrix product {:.0f}", peak.matmul_macs_per_s / kGiga)
          : "";
  return lines +
         fmt::format("peak of int8: {:.0f} GMAC/s (convolution {:.0f}{}); copy: {:.1f} GB/s\n\n",
                     peak.macs_per_s() / kGiga, peak.convolution_macs_per_s / kGiga, matmul,
                     peak.copy_bytes_per_s / kGiga);
}

/// The line with the sum of the ideal times; empty if the peak of the machine was not measured.
std::string ideals_line(double ideals_ms, double whole_ms) {
  if (ideals_ms <= 0.0) return "";
  return fmt::format("{:16} {:>7.3f}   the whole frame takes {:.2f} times as long\n",
                     "sum of ideals", ideals_ms, whole_ms / ideals_ms);
}

std::string frame_lines(const BenchResult& result) {
  const double whole_ms = result.whole_frame->time.p50_ms;
  const double ideals_ms = result.sum_of_ideals_ms();
  return row(*result.whole_frame, result.peak, result.allocations_counted) +
         fmt::format(
             "{:16} {:>7.3f}\n{:16} {:>7.3f}   (pose trail, queues, health, cache misses between "
             "stages)\n"
             "{}",
             "sum of stages", result.sum_of_stages_ms(), "unattributed", result.outside_ms(),
             ideals_line(ideals_ms, whole_ms));
}

std::string memory_lines(const MemoryResult& memory) {
  return fmt::format(
      "\nmemory of a daemon, MiB: program {:.0f}, map {:.0f}, appliance {:.0f}; sum {:.0f}\n"
      "memory of this bench, with its images ({:.0f}) and a second network: {:.0f}, peak {:.0f}\n",
      memory.program_mib, memory.map_mib, memory.appliance_mib, memory.daemon_mib(),
      memory.images_mib, memory.process.now_mib, memory.process.peak_mib);
}

nlohmann::json or_null(bool known, double value) {
  return known ? nlohmann::json(value) : nlohmann::json();
}

nlohmann::json json_of(const StageResult& stage, const MachinePeak& peak, bool counted) {
  nlohmann::json json{
      {"name", stage.name},
      {"in_frame", stage.in_frame},
      {"p50_ms", stage.time.p50_ms},
      {"p90_ms", stage.time.p90_ms},
      {"p99_ms", stage.time.p99_ms},
      {"max_ms", stage.time.max_ms},
      {"bytes", stage.work.bytes},
      {"gmac", stage.work.macs / kGiga},
      {"gmac_per_s", macs_per_s(stage) / kGiga},
      {"share_of_peak", or_null(is_measured(peak), share_of_peak(stage, peak))},
      {"ideal_ms", or_null(is_measured(peak), kMs_per_s * ideal_s(stage.work, peak))},
      {"allocations", or_null(counted, stage.allocations)}};
  return json;
}

nlohmann::json json_of(const MemoryResult& memory) {
  return {{"program_mib", memory.program_mib},     {"map_mib", memory.map_mib},
          {"appliance_mib", memory.appliance_mib}, {"daemon_mib", memory.daemon_mib()},
          {"pictures_mib", memory.images_mib},     {"resident_mib", memory.process.now_mib},
          {"peak_mib", memory.process.peak_mib}};
}

}  // namespace

std::string table_of(const BenchResult& result) {
  const bool counted = result.allocations_counted;
  std::string text = machine_lines(result);
  text += fmt::format("{:16} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>6} {:>8}\n",
                      "stage, ms", "p50", "p90", "p99", "max", "allocs", "MiB", "MMAC", "GMAC/s",
                      "% peak", "ideal ms");
  bool in_frame = true;
  for (const StageResult& stage : result.stages) {
    if (in_frame && !stage.in_frame) {
      if (result.whole_frame) text += frame_lines(result);
      text += "\noutside the frame\n";
      in_frame = false;
    }
    text += row(stage, result.peak, counted);
  }
  return text + memory_lines(result.memory);
}

std::string table_of(const SweepResult& sweep) {
  std::string text = sweep.about + "\n\n";
  for (const std::string& column : sweep.columns) text += fmt::format("{:>16}", column);
  text += "\n";
  for (const std::vector<double>& values : sweep.rows) {
    for (const double value : values) text += fmt::format("{:>16.6g}", value);
    text += "\n";
  }
  return text;
}

std::string to_json(const BenchResult& result) {
  nlohmann::json json{{"model", result.model},
                      {"frames", result.frames},
                      {"threads", result.threads},
                      {"places", result.places},
                      {"processor", result.processor},
                      {"instruction_set", result.instruction_set},
                      {"peak",
                       {{"convolution_gmac_per_s", result.peak.convolution_macs_per_s / kGiga},
                        {"matmul_gmac_per_s", result.peak.matmul_macs_per_s / kGiga},
                        {"gmac_per_s", result.peak.macs_per_s() / kGiga},
                        {"copy_gb_per_s", result.peak.copy_bytes_per_s / kGiga}}},
                      {"memory", json_of(result.memory)},
                      {"stages", nlohmann::json::array()}};
  const bool counted = result.allocations_counted;
  for (const StageResult& stage : result.stages) {
    json["stages"].push_back(json_of(stage, result.peak, counted));
  }
  if (result.whole_frame) {
    const double ideals_ms = result.sum_of_ideals_ms();
    nlohmann::json frame = json_of(*result.whole_frame, result.peak, counted);
    for (const char* key :
         {"name", "in_frame", "bytes", "gmac", "gmac_per_s", "share_of_peak", "ideal_ms"}) {
      frame.erase(key);
    }
    frame["sum_of_stages_ms"] = result.sum_of_stages_ms();
    frame["outside_ms"] = result.outside_ms();
    const bool measured = is_measured(result.peak);
    frame["sum_of_ideals_ms"] = or_null(measured, ideals_ms);
    frame["times_ideal"] = or_null(measured, result.whole_frame->time.p50_ms / ideals_ms);
    json["frame"] = frame;
  }
  return json_document(json);
}

std::string to_json(const std::vector<SweepResult>& sweeps) {
  nlohmann::json json{{"sweeps", nlohmann::json::object()}};
  for (const SweepResult& sweep : sweeps) {
    nlohmann::json rows = nlohmann::json::array();
    for (const std::vector<double>& values : sweep.rows) {
      nlohmann::json named;
      for (size_t i = 0; i < values.size(); ++i) named[sweep.columns[i]] = values[i];
      rows.push_back(named);
    }
    json["sweeps"][sweep.name] = rows;
  }
  return json_document(json);
}

}  // namespace bevloc::bench
