#include "evaluation/calib/calib_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "evaluation/summary_format.h"

namespace bevloc::evaluation {
namespace {

constexpr int kLeastFound = 60;
constexpr double kLeastOfBest = 0.35;
/// If a camera finds less than this share of the mapped paint, its pictures do not fit the map.
constexpr double kLeastShare = 0.05;
constexpr double kOff_deg = 0.2;
constexpr double kOffSigmas = 3.0;
constexpr std::array<int, 3> kRotations{kPitch, kYaw, kRoll};

double share_of(const CameraRefinement& camera) {
  return camera.looked_at > 0 ? static_cast<double>(camera.found) / camera.looked_at : 0.0;
}

double best_share_of(const RigRefinement& checked) {
  double best = 0.0;
  for (const CameraRefinement& camera : checked.cameras) {
    if (camera.found >= kLeastFound) best = std::max(best, share_of(camera));
  }
  return best;
}

double in_unit(const CameraAdjustment& of, int parameter) {
  return of[parameter] / kCameraParameterInfos[static_cast<size_t>(parameter)].per_unit;
}

/// "+0.123 +- 0.012", or why there is no change.
std::string text_of_change(const CameraRefinement& camera, int parameter, int digits) {
  if (camera.kept[static_cast<size_t>(parameter)]) return "kept";
  if (camera.unobservable[static_cast<size_t>(parameter)]) return "not observable";
  return fmt::format("{:+.{}f} +- {:.{}f}", in_unit(camera.change, parameter), digits,
                     in_unit(camera.sigma, parameter), digits);
}

std::string_view name_of(CameraVerdict verdict) {
  switch (verdict) {
    case CameraVerdict::kGood:
      return "good";
    case CameraVerdict::kOff:
      return "off";
    case CameraVerdict::kMismatch:
      return "mismatch";
    case CameraVerdict::kTooLittle:
      return "too little paint";
    case CameraVerdict::kNoPictures:
      return "no pictures";
  }
  return "";
}

std::string advice_on(CameraVerdict verdict, size_t camera, const std::string& folder) {
  switch (verdict) {
    case CameraVerdict::kGood:
      return "";
    case CameraVerdict::kOff:
      return "refine it with `bevloc calib refine`";
    case CameraVerdict::kMismatch:
      return "check cable, name, lens model and mounting of this camera; if all cameras are so, "
             "check the map, the reference poses and the clock";
    case CameraVerdict::kTooLittle:
      return "record a drive past more painted lines";
    case CameraVerdict::kNoPictures:
      return fmt::format("the folder {} is missing",
                         (std::filesystem::path(folder) / kCameraNames[camera]).string());
  }
  return "";
}

std::array<CameraVerdict, kCameraCount> verdicts_of(const CalibrationCheck& check) {
  std::array<CameraVerdict, kCameraCount> verdicts{};
  const double best = best_share_of(check.refinement);
  for (size_t c = 0; c < kCameraCount; ++c) {
    verdicts[c] = check.recorded[c] ? verdict_on(check.refinement.cameras[c], best)
                                    : CameraVerdict::kNoPictures;
  }
  return verdicts;
}

}  // namespace

CameraVerdict verdict_on(const CameraRefinement& camera, double best_share) {
  if (camera.looked_at < kLeastFound) return CameraVerdict::kTooLittle;
  if (share_of(camera) < std::max(kLeastShare, kLeastOfBest * best_share))
    return CameraVerdict::kMismatch;
  if (camera.found < kLeastFound) return CameraVerdict::kTooLittle;
  for (const int axis : kRotations) {
    if (camera.unobservable[static_cast<size_t>(axis)]) return CameraVerdict::kTooLittle;
  }
  for (const int axis : kRotations) {
    const double off_deg = std::abs(in_unit(camera.change, axis));
    if (off_deg > kOff_deg && off_deg > kOffSigmas * in_unit(camera.sigma, axis)) {
      return CameraVerdict::kOff;
    }
  }
  return CameraVerdict::kGood;
}

bool all_good(const CalibrationCheck& check) {
  const auto verdicts = verdicts_of(check);
  return check.recorded.any() && std::ranges::all_of(verdicts, [](CameraVerdict verdict) {
           return verdict == CameraVerdict::kGood || verdict == CameraVerdict::kNoPictures;
         });
}

std::string text_of(const CalibrationCheck& check) {
  std::string text = fmt::format(
      "{} framesets. The angles say how the camera must be turned so that the map's lines lie on "
      "the paint, with one sigma.\n"
      "{:12} {:>13} {:>9}  {:>15} {:>15} {:>15}  verdict\n",
      check.refinement.frames, "camera", "paint found", "off, px", "pitch, deg", "yaw, deg",
      "roll, deg");
  const auto verdicts = verdicts_of(check);
  for (size_t c = 0; c < kCameraCount; ++c) {
    const CameraRefinement& camera = check.refinement.cameras[c];
    text += fmt::format("{:12} {:>13} {:>9} ", kCameraNames[c],
                        fmt::format("{} of {}", camera.found, camera.looked_at),
                        number_or_dash(camera.before_px, 1));
    for (const int axis : kRotations) {
      text += fmt::format(" {:>15}", text_of_change(camera, axis, 2));
    }
    const std::string advice = advice_on(verdicts[c], c, check.folder);
    text += fmt::format("  {}{}{}\n", name_of(verdicts[c]), advice.empty() ? "" : ": ", advice);
  }
  return text;
}

std::string text_of(const RigRefinement& refinement) {
  std::string text = fmt::format("{} framesets. Change of each parameter, with one sigma.\n{:15}",
                                 refinement.frames, "");
  for (const std::string_view name : kCameraNames) text += fmt::format(" {:>16}", name);
  for (int p = 0; p < kCameraParameters; ++p) {
    text += fmt::format("\n{:15}", kCameraParameterInfos[static_cast<size_t>(p)].key);
    for (const CameraRefinement& camera : refinement.cameras) {
      text += fmt::format(" {:>16}", text_of_change(camera, p, 3));
    }
  }
  text += fmt::format("\n{:15}", "paint found");
  for (const CameraRefinement& camera : refinement.cameras) {
    text += fmt::format(" {:>16}", fmt::format("{} of {}", camera.found, camera.looked_at));
  }
  text += fmt::format("\n{:15}", "tie points");
  for (const CameraRefinement& camera : refinement.cameras) {
    text += fmt::format(" {:>16}", camera.ties);
  }
  text += fmt::format("\n{:15}", "off, px");
  for (const CameraRefinement& camera : refinement.cameras) {
    text += fmt::format(" {:>16}", fmt::format("{} -> {}", number_or_dash(camera.before_px, 2),
                                               number_or_dash(camera.after_px, 2)));
  }
  return text + "\n";
}

std::string time_offsets_of(const RigRefinement& refinement) {
  std::string text;
  for (size_t c = 0; c < kCameraCount; ++c) {
    const CameraRefinement& camera = refinement.cameras[c];
    if (camera.kept[kTimeOffset] || camera.unobservable[kTimeOffset]) continue;
    const double offset_s = camera.change[kTimeOffset];
    if (std::abs(offset_s) < 3.0 * camera.sigma[kTimeOffset]) continue;
    text += fmt::format(
        "{}: pictures are taken {:.1f} ms {} than their time stamps say; correct the time stamps "
        "where they are made, because a rig file has no time offset\n",
        kCameraNames[c], 1e3 * std::abs(offset_s), offset_s > 0.0 ? "later" : "earlier");
  }
  return text;
}

nlohmann::json json_of(const RigRefinement& refinement) {
  nlohmann::json json{{"framesets", refinement.frames}};
  for (int c = 0; c < kCameraCount; ++c) {
    const CameraRefinement& camera = refinement.cameras[c];
    nlohmann::json& entry = json["cameras"][std::string(kCameraNames[c])];
    entry = {{"looked_at", camera.looked_at},
             {"found", camera.found},
             {"ties", camera.ties},
             {"before_px", camera.before_px},
             {"after_px", camera.after_px}};
    for (int p = 0; p < kCameraParameters; ++p) {
      const std::string key(kCameraParameterInfos[static_cast<size_t>(p)].key);
      if (camera.kept[static_cast<size_t>(p)]) {
        entry["kept"].push_back(key);
      } else if (camera.unobservable[static_cast<size_t>(p)]) {
        entry["unobservable"].push_back(key);
      } else {
        entry["change"][key] = in_unit(camera.change, p);
        entry["sigma"][key] = in_unit(camera.sigma, p);
      }
    }
  }
  return json;
}

nlohmann::json json_of(const CalibrationCheck& check) {
  nlohmann::json json = json_of(check.refinement);
  const auto verdicts = verdicts_of(check);
  for (size_t c = 0; c < kCameraCount; ++c) {
    json["cameras"][std::string(kCameraNames[c])]["verdict"] = name_of(verdicts[c]);
  }
  return json;
}

}  // namespace bevloc::evaluation
