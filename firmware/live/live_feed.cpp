#include "firmware/live/live_feed.h"

#include <algorithm>
#include <cstring>

namespace bevloc::firmware {

LiveFeed::LiveFeed(const Rig& rig, int hypotheses) {
  size_t largest = 0;
  for (const CameraModel& camera : rig.cameras) {
    largest = std::max(
        largest, static_cast<size_t>(3) * camera.intrinsics.width_px * camera.intrinsics.height_px);
  }
  sample_.bytes.resize(largest);
  sample_.mask.reserve(static_cast<size_t>(kRasterChannels) * kRasterGrid.cells());
  for (std::vector<float>& axis : sample_.probabilities) axis.reserve(hypotheses);
}

void LiveFeed::set_viewers(int viewers) {
  if (viewers_ == 0) {
    State full = State::kFull;
    state_.compare_exchange_strong(full, State::kFree);
  }
  viewers_ = viewers;
}

void LiveFeed::offer(const VisionSnapshot& snapshot) {
  if (viewers_.load(std::memory_order_relaxed) == 0) return;
  const Time time = snapshot.frameset.time;
  if (time >= latest_ && time - latest_ < kPicturePeriod) return;
  State free = State::kFree;
  if (!state_.compare_exchange_strong(free, State::kWriting)) return;
  latest_ = time;
  copy(snapshot);
  state_ = State::kFull;
}

bool LiveFeed::take(const std::function<void(const LiveSample&)>& draw) {
  State full = State::kFull;
  if (!state_.compare_exchange_strong(full, State::kReading)) return false;
  draw(sample_);
  state_ = State::kFree;
  return true;
}

void LiveFeed::copy(const VisionSnapshot& snapshot) {
  sample_.frame_time = snapshot.frameset.time;
  sample_.present = snapshot.report.present;
  sample_.prior = snapshot.report.prior;
  sample_.match = snapshot.report.match;
  sample_.hypotheses = snapshot.hypotheses;
  sample_.probabilities[0] = snapshot.solution.x_probability;
  sample_.probabilities[1] = snapshot.solution.y_probability;
  sample_.probabilities[2] = snapshot.solution.yaw_probability;
  sample_.camera = next_camera_;
  next_camera_ = (next_camera_ + 1) % kCameraCount;
  sample_.reference_from_exposure = snapshot.reference_from_exposure[sample_.camera];
  sample_.has_image = false;
  if (snapshot.frameset.present[sample_.camera]) {
    copy_image(snapshot.frameset.frames[sample_.camera].image());
  }
  sample_.has_mask =
      sample_.frame_time < latest_mask_ || sample_.frame_time - latest_mask_ >= kMaskPeriod;
  if (!sample_.has_mask) return;
  latest_mask_ = sample_.frame_time;
  const std::span<const float> mask = snapshot.perceived_mask();
  sample_.mask.assign(mask.begin(), mask.end());
}

bool LiveFeed::copy_plane(const ImagePlane& from, const PlaneSize& size, size_t& used,
                          ImagePlane& to) {
  if (used + size.bytes() > sample_.bytes.size()) return false;
  uint8_t* const start = sample_.bytes.data() + used;
  for (int row = 0; row < size.rows; ++row) {
    std::memcpy(start + size.row_bytes * row, from.data + row * from.stride_bytes, size.row_bytes);
  }
  used += size.bytes();
  to = {start, static_cast<std::ptrdiff_t>(size.row_bytes)};
  return true;
}

void LiveFeed::copy_image(const ImageView& image) {
  sample_.image = image;
  size_t used = 0;
  sample_.has_image = true;
  for (size_t plane = 0; plane < image.planes.size() && sample_.has_image; ++plane) {
    sample_.has_image = copy_plane(image.planes[plane], plane_size(image, plane), used,
                                   sample_.image.planes[plane]);
  }
}

}  // namespace bevloc::firmware
