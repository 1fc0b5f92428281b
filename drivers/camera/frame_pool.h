// A fixed number of RGB pictures that a camera without hardware lends out and gets back.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/image.h"
#include "drivers/camera/frame_buffer.h"

namespace bevloc::drivers {

/// All memory is made by create(); borrowing and giving back neither allocate nor lock. The lowest
/// free picture is lent first: pictures that are never needed are never touched and not resident.
/// Thread safe.
class FramePool final : public FrameLender, public std::enable_shared_from_this<FramePool> {
 public:
  static constexpr int kMaxBuffers = 64;

  /// 1 to kMaxBuffers pictures.
  static std::shared_ptr<FramePool> create(int buffers, int width_px, int height_px);

  /// A picture with old pixels in it; empty when all are lent out.
  FrameBuffer borrow();

  /// To draw into a picture that was borrowed here and not yet shown to anybody.
  RgbImage& image(const FrameBuffer& buffer) { return images_[buffer.slot()]; }

  int buffers() const { return static_cast<int>(images_.size()); }
  int lent() const;

 private:
  FramePool(int buffers, int width_px, int height_px);
  void give_back(int slot) noexcept override;

  std::vector<RgbImage> images_;
  std::atomic<uint64_t> free_;  ///< bit i: picture i is here
};

}  // namespace bevloc::drivers
