#include "evaluation/network/rig_command.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_dump.h"
#include "common/option_checks.h"
#include "common/output_file.h"
#include "common/shipped_file.h"
#include "evaluation/check_outputs.h"
#include "evaluation/network/network_evaluation.h"
#include "evaluation/progress_bar.h"
#include "evaluation/summary_format.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/network/model/model_rig.h"
#include "pipeline/preprocessing/view_check.h"
#include "sim/samples/random_rig.h"

namespace bevloc::evaluation {
namespace {

constexpr std::string_view kSolver = "banded+refine";

/// The errors of the daemon's solver.
Summary summary_of(const SetResult& result) {
  const auto read_out = std::ranges::find(result.read_outs, kSolver, &ReadOut::name);
  return summarise(read_out->outcomes);
}

PerAxis ratio_of(const PerAxis& a, const PerAxis& b) {
  PerAxis ratio{};
  for (size_t axis = 0; axis < ratio.size(); ++axis) ratio[axis] = a[axis] / b[axis];
  return ratio;
}

}  // namespace

void RigCommand::declare(CLI::App& eval) {
  auto* rig = eval.add_subcommand(
      "rig", "Compare the accuracy with a rig with that of the simulator's own");
  auto* drawn =
      rig->add_option("--random", drawn_seed_, "Draw a rig with this seed, instead of a file")
          ->check(whole_number());
  rig->add_option("file", rig_file_, "Calibration of the cameras")->excludes(drawn);
  rig->add_option("--write", drawn_file_, "Write the drawn rig to this file")
      ->check(output_file())
      ->needs(drawn);
  rig->add_option("--model", model_, "ONNX file")->capture_default_str();
  rig->add_option("--frames", frames_, "Number of samples with each rig")
      ->check(CLI::Range(1, kMostFrames))
      ->capture_default_str();
  rig->add_option("--seed", seed_, "Seed of the samples")
      ->check(CLI::Range(uint64_t{0}, kSampleSeeds - 1))
      ->capture_default_str();
  rig->add_option("--json", json_file_, "Write both results to this file")->check(output_file());
  rig->footer(
      "Examples:\n"
      "  bevloc eval rig config/rig_van.yaml\n"
      "  bevloc eval rig rig.yaml --frames 500 --json rig.json\n"
      "  bevloc eval rig --random 7 --write rig_7.yaml");
}

Result<RigCommand::NamedRig> RigCommand::chosen_rig() const {
  if (drawn_seed_) {
    const Rig rig = sim::random_rig(1.0, *drawn_seed_);
    if (const Status written = write_option_file(drawn_file_, format_rig(rig)); !written) {
      return tl::unexpected(written.error());
    }
    return NamedRig{fmt::format("random rig {}", *drawn_seed_), rig};
  }
  if (rig_file_.empty())
    return fail("bevloc eval rig: found no rig, wanted a file or --random SEED");
  auto rig = read_rig(rig_file_);
  if (!rig) return tl::unexpected(rig.error());
  return NamedRig{rig_file_, std::move(*rig)};
}

Status RigCommand::run() const {
  const std::string model = given_or_shipped(model_);
  if (Status others = check_outputs({json_file_, drawn_file_}, {rig_file_, model}); !others) {
    return others;
  }
  const auto rig = chosen_rig();
  if (!rig) return tl::unexpected(rig.error());
  auto evaluation = NetworkEvaluation::create(model);
  if (!evaluation) return tl::unexpected(evaluation.error());
  if (const Status fits = check_rig_fits(evaluation->model_rig(), rig->rig); !fits) {
    fmt::print(stderr, "{}: bevlocd refuses it: {}\n", rig->name, fits.error().message);
  }
  const auto warning = check_views(rig->rig, rig->name);
  if (!warning) {
    fmt::print(stderr, "bevlocd refuses {}\n", warning.error().message);
  } else if (!warning->empty()) {
    fmt::print(stderr, "{}\n", *warning);
  }
  sim::SampleStream stream;
  stream.first_seed = first_seed_of(seed_);
  stream.nuisances = sim::nuisances_of(sim::NuisanceSet::kStandard);
  int done = 0;
  const auto progress = [&] { show_progress(++done, 2 * frames_); };
  const Summary usual = summary_of(evaluation->run(stream, frames_, progress));
  stream.rig = &rig->rig;
  const Summary found = summary_of(evaluation->run(stream, frames_, progress));
  fmt::print(
      "{}, {} samples, {}; along, across (m), yaw (degrees)\n"
      "                        MAE                 95 %                within 3 sigma, %\n"
      "simulator's own rig     {}   {}   {}\n"
      "{:22}  {}   {}   {}\n"
      "ratio                   {}   {}\n",
      evaluation->model_name(), frames_, kSolver, three(usual.mae), three(usual.p95),
      percent(usual.coverage_3s), rig->name, three(found.mae), three(found.p95),
      percent(found.coverage_3s), three(ratio_of(found.mae, usual.mae), 2),
      three(ratio_of(found.p95, usual.p95), 2));
  const nlohmann::json json{{"rig", rig->name},
                            {"model", evaluation->model_name()},
                            {"own", json_of(usual)},
                            {"given", json_of(found)}};
  return write_option_file(json_file_, json_document(json));
}

}  // namespace bevloc::evaluation
