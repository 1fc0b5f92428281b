#include "evaluation/calib/calib_report.h"

#include <algorithm>
#include <array>
#include <cmath>

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
  }
  return "";
}

std::string_view advice_on(CameraVerdict verdict) {
  switch (verdict) {
    case CameraVerdict::kGood:
      return "";
    case CameraVerdict::kOff:
      return "refine it with `bevloc calib refine`";
    case CameraVerdict::kMismatch:
      return "check cable, name, lens model and mounting of this camera; if it is so for all of "
             "them: the map, the reference poses and the clock";
    case CameraVerdict::kTooLittle:
      return "record a drive past more painted lines";
  }
  return "";
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

bool all_good(const RigRefinement& checked) {
  const double best = best_share_of(checked);
  return std::ranges::all_of(checked.cameras, [best](const CameraRefinement& camera) {
    return verdict_on(camera, best) == CameraVerdict::kGood;
  });
}

std::string text_of_check(const RigRefinement& checked) {
  std::string text = fmt::format(
      "{} framesets. Turned by: what would lay the map on the paint, with one sigma.\n"
      "{:12} {:>13} {:>9}  {:>15} {:>15} {:>15}  verdict\n",
      checked.frames, "camera", "paint found", "off, px", "pitch, deg", "yaw, deg", "roll, deg");
  const double best = best_share_of(checked);
  for (int c = 0; c < kCameraCount; ++c) {
    const CameraRefinement& camera = checked.cameras[c];
    const CameraVerdict verdict = verdict_on(camera, best);
    text += fmt::format("{:12} {:>13} {:>9} ", kCameraNames[c],
                        fmt::format("{} of {}", camera.found, camera.looked_at),
                        number_or_dash(camera.before_px, 1));
    for (const int axis : kRotations) {
      text += fmt::format(" {:>15}", text_of_change(camera, axis, 2));
    }
    const std::string_view advice = advice_on(verdict);
    text += fmt::format("  {}{}{}\n", name_of(verdict), advice.empty() ? "" : ": ", advice);
  }
  return text;
}

std::string text_of_refinement(const RigRefinement& refinement) {
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

nlohmann::json json_of(const RigRefinement& refinement, bool with_verdicts) {
  nlohmann::json json{{"framesets", refinement.frames}};
  const double best = best_share_of(refinement);
  for (int c = 0; c < kCameraCount; ++c) {
    const CameraRefinement& camera = refinement.cameras[c];
    nlohmann::json& entry = json["cameras"][std::string(kCameraNames[c])];
    entry = {{"looked_at", camera.looked_at},
             {"found", camera.found},
             {"ties", camera.ties},
             {"before_px", camera.before_px},
             {"after_px", camera.after_px}};
    if (with_verdicts) entry["verdict"] = name_of(verdict_on(camera, best));
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

}  // namespace bevloc::evaluation
