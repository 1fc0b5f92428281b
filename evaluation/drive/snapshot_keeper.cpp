#include "evaluation/drive/snapshot_keeper.h"

#include <algorithm>

namespace bevloc::evaluation {
namespace {

/// The weighted number of drawn cells. Crossings count most, because they constrain x.
double map_content(std::span<const uint8_t> raster) {
  constexpr std::array<double, kRasterChannels> kWeights = {1.0, 4.0, 1.0};
  const auto plane = static_cast<size_t>(kRasterGrid.cells());
  double content = 0.0;
  for (size_t channel = 0; channel < kWeights.size(); ++channel) {
    const auto cells = raster.subspan(channel * plane, plane);
    content +=
        kWeights[channel] * static_cast<double>(std::count_if(cells.begin(), cells.end(),
                                                              [](uint8_t v) { return v > 0; }));
  }
  return content;
}

RgbImage copy_of(const RgbView& view) {
  RgbImage image(view.width, view.height);
  for (int v = 0; v < view.height; ++v) std::copy_n(view.row(v), 3 * view.width, image.row(v));
  return image;
}

}  // namespace

void SnapshotKeeper::observe(const firmware::VisionSnapshot& snapshot) {
  if (snapshot.range != SearchRange::kTracking) return;
  if (!first_tracked_) first_tracked_ = snapshot.frameset.time;
  if (snapshot.frameset.time - *first_tracked_ < kSettling) return;
  if (snapshot.report.match.evidence != Evidence::kGood) return;
  const double content = map_content(snapshot.map_raster);
  if (content < kImprovement * best_content_) return;
  best_content_ = content;

  Kept& kept = kept_.emplace();
  kept.frame_time = snapshot.frameset.time;
  SheetContent& sheet = kept.content;
  sheet.present = snapshot.frameset.present;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (sheet.present[camera]) {
      sheet.images[camera] = copy_of(snapshot.frameset.frames[camera].pixels());
    }
  }
  const std::span<const float> mask = snapshot.perceived_mask();
  sheet.mask_logits.assign(mask.begin(), mask.end());
  sheet.matched_at = snapshot.report.prior;
  sheet.reference_from_exposure = snapshot.reference_from_exposure;
  sheet.solution = snapshot.solution;
  sheet.hypotheses = snapshot.hypotheses;
}

}  // namespace bevloc::evaluation
