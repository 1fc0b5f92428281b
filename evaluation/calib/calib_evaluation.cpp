#include "evaluation/calib/calib_evaluation.h"

#include <cmath>

#include <fmt/format.h>

#include "common/json_dump.h"
#include "common/option_checks.h"
#include "common/output_file.h"
#include "evaluation/calib/calibration_errors.h"
#include "evaluation/progress_bar.h"
#include "evaluation/town_seeds.h"
#include "pipeline/calibration/refine/refine_rig.h"

namespace bevloc::evaluation {
namespace {

/// Fails if the recording of a drive has too few framesets to be refined.
Status check_framesets(const SimulatedRecordingOptions& options) {
  const auto framesets = static_cast<int>(std::ceil(options.duration_s / options.interval_s));
  if (framesets >= kLeastFramesets) return {};
  return fail(
      "--duration: found {} s with --interval {}, which gives {} framesets, wanted {} or more; "
      "drive longer or shorten the interval",
      options.duration_s, options.interval_s, framesets, kLeastFramesets);
}

/// Refines the recording of one drive and judges the result.
Status judge_drive(const SimulatedRecordingOptions& options, CalibrationErrors& errors) {
  SimulatedRecording recording(options);
  const MapIndex index(recording.map());
  const auto refinement = refine_rig(recording.rig(), index, recording, {});
  if (!refinement) return tl::unexpected(refinement.error());
  errors.add(options.seed, *refinement, recording.truth());
  return {};
}

}  // namespace

void CalibEvaluation::declare(CLI::App& eval) {
  auto* calib =
      eval.add_subcommand("calib", "Refine calibrations with known errors from simulated drives");
  calib->add_option("--first-seed", options_.seed, "Seed of the first drive")
      ->check(whole_number())
      ->capture_default_str();
  calib->add_option("--drives", drives_, "Number of drives, each with the next seed")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  calib->add_option("--duration", options_.duration_s, "Length of a drive, seconds")
      ->check(number_between(5.0, 600.0))
      ->capture_default_str();
  calib->add_option("--interval", options_.interval_s, "Time between two framesets, seconds")
      ->check(number_between(0.05, 10.0))
      ->capture_default_str();
  calib->add_option("--json", json_file_, "Write the errors to this file")->check(output_file());
  calib->footer(
      "Examples:\n"
      "  bevloc eval calib --first-seed 401 --drives 5 --json errors.json");
}

Status CalibEvaluation::run() const {
  if (Status towns = check_town_seeds("--first-seed", options_.seed, drives_); !towns) return towns;
  if (Status enough = check_framesets(options_); !enough) return enough;
  CalibrationErrors errors;
  for (int i = 0; i < drives_; ++i) {
    SimulatedRecordingOptions options = options_;
    options.seed += static_cast<uint64_t>(i);
    if (const Status judged = judge_drive(options, errors); !judged) {
      errors.leave_out(options.seed, judged.error().message);
      fmt::print(stderr, "seed {}: this drive does not count: {}\n", options.seed,
                 judged.error().message);
    }
    show_progress(i + 1, drives_, "drives");
  }
  if (errors.drives() == 0) {
    return fail("bevloc eval calib: found no drive that can be refined, wanted one or more");
  }
  fmt::print("{}", errors.to_table());
  return write_option_file(json_file_, json_document(errors.to_json()));
}

}  // namespace bevloc::evaluation
