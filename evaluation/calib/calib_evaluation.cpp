#include "evaluation/calib/calib_evaluation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_dump.h"
#include "common/option_checks.h"
#include "common/output_file.h"
#include "evaluation/calib/calib_report.h"
#include "evaluation/drive/error_statistics.h"
#include "evaluation/progress_bar.h"
#include "evaluation/town_seeds.h"
#include "pipeline/calibration/refine/refine_rig.h"

namespace bevloc::evaluation {
namespace {

/// The errors of one parameter over all cameras and drives. Cameras of which the parameter is not
/// observable count in `cameras` only.
struct ErrorSums {
  int cameras = 0;
  double before = 0.0;         ///< sum of the squared errors before the refinement
  std::vector<double> errors;  ///< absolute errors after the refinement
  int within_sigma = 0;        ///< errors within one sigma
  int within_three = 0;
};

void judge_camera(const CameraRefinement& camera, const CameraAdjustment& truth,
                  std::array<ErrorSums, kCameraParameters>& sums) {
  for (int p = 0; p < kCameraParameters; ++p) {
    ErrorSums& sum = sums[static_cast<size_t>(p)];
    ++sum.cameras;
    if (camera.unobservable[static_cast<size_t>(p)]) continue;
    const double error = camera.change[p] - truth[p];
    sum.before += truth[p] * truth[p];
    sum.errors.push_back(std::abs(error));
    sum.within_sigma += std::abs(error) <= camera.sigma[p];
    sum.within_three += std::abs(error) <= 3.0 * camera.sigma[p];
  }
}

double root_mean_square(double sum_of_squares, size_t count) {
  return count == 0 ? 0.0 : std::sqrt(sum_of_squares / static_cast<double>(count));
}

/// Prints one row for each parameter, and adds it to `json`.
void print_table(const std::array<ErrorSums, kCameraParameters>& sums, nlohmann::json& json) {
  fmt::print("{:15} {:>10} {:>10} {:>12} {:>10} {:>9} {:>9}\n", "error", "observable", "before RMS",
             "after median", "after RMS", "1 sigma", "3 sigma");
  for (size_t p = 0; p < kCameraParameters; ++p) {
    const ErrorSums& sum = sums[p];
    const CameraParameterInfo& info = kCameraParameterInfos[p];
    const size_t observable = sum.errors.size();
    const double squares =
        std::inner_product(sum.errors.begin(), sum.errors.end(), sum.errors.begin(), 0.0);
    const double before = root_mean_square(sum.before, observable) / info.per_unit;
    const double median = quantile_of(sum.errors, 0.5) / info.per_unit;
    const double after = root_mean_square(squares, observable) / info.per_unit;
    const double count = std::max(1.0, static_cast<double>(observable));
    fmt::print("{:15} {:>10} {:>10.3f} {:>12.3f} {:>10.3f} {:>7.0f} % {:>7.0f} %\n", info.key,
               fmt::format("{}/{}", observable, sum.cameras), before, median, after,
               100.0 * sum.within_sigma / count, 100.0 * sum.within_three / count);
    json[std::string(info.key)] = {{"observable", observable},
                                   {"cameras", sum.cameras},
                                   {"rms_before", before},
                                   {"median_after", median},
                                   {"rms_after", after},
                                   {"within_1_sigma", sum.within_sigma / count},
                                   {"within_3_sigma", sum.within_three / count}};
  }
}

}  // namespace

void CalibEvaluation::declare(CLI::App& eval) {
  auto* calib = eval.add_subcommand(
      "calib", "Refine calibrations with known errors from simulated recordings");
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
  std::array<ErrorSums, kCameraParameters> sums;
  nlohmann::json json;
  for (int i = 0; i < drives_; ++i) {
    SimulatedRecordingOptions options = options_;
    options.seed += static_cast<uint64_t>(i);
    SimulatedRecording recording(options);
    const MapIndex index(recording.map());
    const auto refinement = refine_rig(recording.rig(), index, recording, {});
    if (!refinement) return tl::unexpected(refinement.error());
    nlohmann::json drive = json_of(*refinement);
    drive["seed"] = options.seed;
    for (int c = 0; c < kCameraCount; ++c) {
      const CameraAdjustment& truth = recording.truth()[c];
      judge_camera(refinement->cameras[c], truth, sums);
      for (size_t p = 0; p < kCameraParameters; ++p) {
        const CameraParameterInfo& info = kCameraParameterInfos[p];
        drive["cameras"][std::string(kCameraNames[c])]["truth"][std::string(info.key)] =
            truth[static_cast<int>(p)] / info.per_unit;
      }
    }
    json["drives"].push_back(std::move(drive));
    show_progress(i + 1, drives_, "drives");
  }
  print_table(sums, json["errors"]);
  return write_option_file(json_file_, json_document(json));
}

}  // namespace bevloc::evaluation
