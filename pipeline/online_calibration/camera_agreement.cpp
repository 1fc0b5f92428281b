#include "pipeline/online_calibration/camera_agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bevloc {
namespace {

constexpr double kFade_s = 20.0;
constexpr double kLeastSeen_s = 15.0;
/// A camera that was not used for longer than this is judged as if it were new, because what it
/// showed before may have been dirt.
constexpr double kLongestAbsence_s = 5.0;
/// With fewer cameras, two wrong ones could make up the median.
constexpr size_t kLeastCameras = 4;
// The share of a swapped camera is mostly below 0.4. That of a camera at its own place is mostly
// 0.6 or more.
constexpr double kContradictingShare = 0.4;
constexpr double kAgreeingShare = 0.5;
/// A camera contradicts the map if its share stays below kContradictingShare for this long. In
/// drives without a fault, the share of a single camera stayed below it for 1 s or less.
constexpr double kLeastContradicted_s = 4.0;
// In drives without a fault, the shares of both cameras of one side stayed below it for 23 s or
// less. Therefore one second counts as 0.1 s if the share of the other camera is not known or is
// below kWellAgreeingShare.
constexpr double kWellAgreeingShare = 0.7;
constexpr double kHiddenSideRate = 0.1;
/// Least agreement of the median camera. If it is lower, no camera is judged.
constexpr double kLeastMedian = 0.1;

/// The other camera that sees the same side of the road; -1 for the front and the back one.
constexpr std::array<int, kCameraCount> kSameSide = {3, -1, 5, 0, -1, 2};

double agreement(const SeenByCamera& seen) {
  const double squares = seen.map_square * seen.bev_square;
  return squares > 0.0 ? seen.product / std::sqrt(squares) : 0.0;
}

SeenByCamera faded(const SeenByCamera& before, const SeenByCamera& now, double kept) {
  return {kept * before.product + now.product, kept * before.map_square + now.map_square,
          kept * before.bev_square + now.bev_square};
}

}  // namespace

void CameraAgreement::add(const std::array<SeenByCamera, kCameraCount>& seen, CameraMask used,
                          double step_s) {
  const double kept = std::exp(-step_s / kFade_s);
  CameraMask judged;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    Seen& summed = cameras_[camera];
    if (!used[camera]) {
      summed.absent_s += step_s;
      if (summed.absent_s > kLongestAbsence_s) summed = {};
      continue;
    }
    summed.absent_s = 0.0;
    summed.sums = faded(summed.sums, seen[camera], kept);
    summed.time_s += step_s;
    judged[camera] = summed.time_s >= kLeastSeen_s;
  }
  std::array<double, kCameraCount> shares{};
  if (!shares_of(judged, shares)) return;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (!judged[camera]) continue;
    double& contradicted_s = cameras_[camera].contradicted_s;
    const double limit = contradicting_[camera] ? kAgreeingShare : kContradictingShare;
    if (shares[camera] >= limit) {
      contradicted_s = 0.0;
      contradicting_[camera] = false;
      continue;
    }
    const int other = kSameSide[camera];
    const bool is_side_hidden =
        other >= 0 && (!judged[other] || shares[other] < kWellAgreeingShare);
    contradicted_s += is_side_hidden ? kHiddenSideRate * step_s : step_s;
    if (contradicted_s >= kLeastContradicted_s) contradicting_.set(static_cast<size_t>(camera));
  }
}

bool CameraAgreement::shares_of(CameraMask judged, std::array<double, kCameraCount>& shares) const {
  std::array<double, kCameraCount> sorted{};
  sorted.fill(std::numeric_limits<double>::infinity());
  for (int camera = 0; camera < kCameraCount; ++camera) {
    shares[camera] = agreement(cameras_[camera].sums);
    if (judged[camera]) sorted[camera] = shares[camera];
  }
  if (judged.count() < kLeastCameras) return false;
  std::ranges::sort(sorted);
  // If two cameras are in the middle, this is the better one. With four cameras of which two are
  // swapped, it is then one at its own place.
  const double median = sorted[judged.count() / 2];
  if (median < kLeastMedian) return false;
  for (double& share : shares) share /= median;
  return true;
}

}  // namespace bevloc
