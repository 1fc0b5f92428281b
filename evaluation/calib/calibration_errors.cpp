#include "evaluation/calib/calibration_errors.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "evaluation/calib/calib_report.h"
#include "evaluation/quantile.h"

namespace bevloc::evaluation {
namespace {

double root_mean_square(double sum_of_squares, size_t count) {
  return count == 0 ? 0.0 : std::sqrt(sum_of_squares / static_cast<double>(count));
}

}  // namespace

void CalibrationErrors::add(uint64_t seed, const RigRefinement& refinement, const Truth& truth) {
  nlohmann::json drive = json_of(refinement);
  drive["seed"] = seed;
  for (size_t c = 0; c < kCameraCount; ++c) {
    judge_camera(refinement.cameras[c], truth[c]);
    nlohmann::json& camera = drive["cameras"][std::string(kCameraNames[c])];
    for (size_t p = 0; p < kCameraParameters; ++p) {
      const CameraParameterInfo& info = kCameraParameterInfos[p];
      camera["truth"][std::string(info.key)] = truth[c][static_cast<int>(p)] / info.per_unit;
    }
  }
  drives_.push_back(std::move(drive));
}

void CalibrationErrors::leave_out(uint64_t seed, std::string_view why) {
  left_out_.push_back({{"seed", seed}, {"why", why}});
}

void CalibrationErrors::judge_camera(const CameraRefinement& camera,
                                     const CameraAdjustment& truth) {
  for (int p = 0; p < kCameraParameters; ++p) {
    ErrorSums& sum = sums_[static_cast<size_t>(p)];
    ++sum.cameras;
    if (camera.unobservable[static_cast<size_t>(p)]) continue;
    const double error = camera.change[p] - truth[p];
    sum.squares_before += truth[p] * truth[p];
    sum.errors.push_back(std::abs(error));
    sum.within_sigma += std::abs(error) <= camera.sigma[p];
    sum.within_three += std::abs(error) <= 3.0 * camera.sigma[p];
  }
}

CalibrationErrors::Row CalibrationErrors::row_of(size_t parameter) const {
  const ErrorSums& sum = sums_[parameter];
  const double per_unit = kCameraParameterInfos[parameter].per_unit;
  const size_t observable = sum.errors.size();
  const double squares_after =
      std::inner_product(sum.errors.begin(), sum.errors.end(), sum.errors.begin(), 0.0);
  const double count = std::max(1.0, static_cast<double>(observable));
  return {.observable = observable,
          .cameras = sum.cameras,
          .rms_before = root_mean_square(sum.squares_before, observable) / per_unit,
          .median_after = quantile_of(sum.errors, 0.5) / per_unit,
          .rms_after = root_mean_square(squares_after, observable) / per_unit,
          .share_within_sigma = sum.within_sigma / count,
          .share_within_three = sum.within_three / count};
}

std::string CalibrationErrors::to_table() const {
  std::string text =
      fmt::format("{:15} {:>10} {:>10} {:>12} {:>10} {:>9} {:>9}\n", "error", "observable",
                  "before RMS", "after median", "after RMS", "1 sigma", "3 sigma");
  for (size_t p = 0; p < kCameraParameters; ++p) {
    const Row row = row_of(p);
    text +=
        fmt::format("{:15} {:>10} {:>10.3f} {:>12.3f} {:>10.3f} {:>7.0f} % {:>7.0f} %\n",
                    kCameraParameterInfos[p].key, fmt::format("{}/{}", row.observable, row.cameras),
                    row.rms_before, row.median_after, row.rms_after, 100.0 * row.share_within_sigma,
                    100.0 * row.share_within_three);
  }
  return text;
}

nlohmann::json CalibrationErrors::to_json() const {
  nlohmann::json json{{"drives", drives_}, {"left_out", left_out_}};
  for (size_t p = 0; p < kCameraParameters; ++p) {
    const Row row = row_of(p);
    json["errors"][std::string(kCameraParameterInfos[p].key)] = {
        {"observable", row.observable},
        {"cameras", row.cameras},
        {"rms_before", row.rms_before},
        {"median_after", row.median_after},
        {"rms_after", row.rms_after},
        {"within_1_sigma", row.share_within_sigma},
        {"within_3_sigma", row.share_within_three}};
  }
  return json;
}

}  // namespace bevloc::evaluation
