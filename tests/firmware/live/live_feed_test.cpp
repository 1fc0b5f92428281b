// Tests what the vision thread copies for the live page, and that it costs nothing without viewers.
#include "firmware/live/live_feed.h"

#include <gtest/gtest.h>

#include "evaluation/bench/allocation_count.h"
#include "tests/firmware/live/hand_made_localization.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;

class LiveFeedTest : public testing::Test {
 protected:
  /// Offers the localization as of this time. Returns whether there was a copy.
  bool offer_at(int time_ms) {
    made_.frameset.time = Time(milliseconds(time_ms));
    feed_.offer(made_.snapshot());
    return feed_.take([this](const LiveSample& sample) {
      camera_ = sample.camera;
      has_image_ = sample.has_image;
      has_mask_ = sample.has_mask;
      if (has_image_) grey_ = sample.image.planes[0].data[0];
      prior_ = sample.prior;
      moved_m_ = sample.reference_from_exposure.x_m;
      likeliest_ = sample.probabilities[0][2];
    });
  }

  HandMadeLocalization made_;
  LiveFeed feed_{made_.rig, 5};
  int camera_ = -1;
  bool has_image_ = false;
  bool has_mask_ = false;
  int grey_ = 0;
  Se2 prior_;
  double moved_m_ = 0.0;
  float likeliest_ = 0.0F;
};

TEST_F(LiveFeedTest, CopiesNothingWithoutViewers) {
  EXPECT_FALSE(offer_at(1000));
  EXPECT_EQ(made_.masks_computed, 0);
}

TEST_F(LiveFeedTest, AFirstViewerGetsNothingThatWasCopiedForEarlierOnes) {
  const auto take = [this] { return feed_.take([](const LiveSample&) {}); };
  made_.frameset.time = Time(milliseconds(1000));
  feed_.set_viewers(1);
  feed_.offer(made_.snapshot());
  feed_.set_viewers(0);
  feed_.set_viewers(1);
  EXPECT_FALSE(take());
  made_.frameset.time = Time(milliseconds(2000));
  feed_.offer(made_.snapshot());
  feed_.set_viewers(2);
  EXPECT_TRUE(take()) << "a further viewer takes nothing from the first one";
}

TEST_F(LiveFeedTest, CopiesOneCameraAfterTheOther) {
  for (int camera = 0; camera < kCameraCount; ++camera) made_.motions[camera].x_m = 0.1 * camera;
  feed_.set_viewers(1);
  for (int i = 0; i < 2 * kCameraCount; ++i) {
    ASSERT_TRUE(offer_at(1000 + 100 * i));
    EXPECT_EQ(camera_, i % kCameraCount);
    ASSERT_TRUE(has_image_);
    EXPECT_EQ(grey_, 10 * camera_ + 10);
    EXPECT_EQ(moved_m_, 0.1 * camera_);
  }
  EXPECT_EQ(prior_.x_m, 5.0);
  EXPECT_EQ(likeliest_, 0.5F);
}

TEST_F(LiveFeedTest, KeepsToItsRates) {
  feed_.set_viewers(1);
  int copies = 0;
  for (int time_ms = 1000; time_ms < 3000; time_ms += 20) copies += offer_at(time_ms) ? 1 : 0;
  EXPECT_EQ(copies, 20);
  EXPECT_EQ(made_.masks_computed, 2);
}

TEST_F(LiveFeedTest, AMissingCameraHasNoImage) {
  feed_.set_viewers(1);
  made_.frameset.present.reset(0);
  ASSERT_TRUE(offer_at(1000));
  EXPECT_FALSE(has_image_);
  EXPECT_TRUE(has_mask_);
}

TEST(PlaneSize, RoundsSharedChromaUp) {
  ImageView image;
  image.width = 5;
  image.height = 3;
  const auto is = [&image](PixelFormat format, size_t plane, size_t row_bytes, int rows) {
    image.format = format;
    const PlaneSize size = plane_size(image, plane);
    return size.row_bytes == row_bytes && size.rows == rows;
  };
  EXPECT_TRUE(is(PixelFormat::kRgb24, 0, 15, 3));
  EXPECT_TRUE(is(PixelFormat::kRgb24, 1, 0, 0));
  EXPECT_TRUE(is(PixelFormat::kYuyv, 0, 12, 3));
  EXPECT_TRUE(is(PixelFormat::kNv12, 0, 5, 3));
  EXPECT_TRUE(is(PixelFormat::kNv12, 1, 6, 2));
  EXPECT_TRUE(is(PixelFormat::kBayerRggb, 0, 5, 3));
  image.bytes_used = 77;
  EXPECT_TRUE(is(PixelFormat::kMjpeg, 0, 77, 1));
}

TEST_F(LiveFeedTest, DoesNotWaitForTheDrawingThread) {
  feed_.set_viewers(1);
  made_.frameset.time = Time(milliseconds(1000));
  feed_.offer(made_.snapshot());
  feed_.take([this](const LiveSample& sample) {
    made_.frameset.time = Time(milliseconds(5000));
    made_.report.prior.x_m = 99.0;
    feed_.offer(made_.snapshot());  // while the copy is being read
    EXPECT_EQ(sample.prior.x_m, 5.0);
  });
  EXPECT_FALSE(feed_.take([](const LiveSample&) {}));
}

TEST_F(LiveFeedTest, AnImageThatIsLargerThanTheCalibrationIsNotCopied) {
  feed_.set_viewers(1);
  const auto large = drivers::FramePool::create(1, 640, 360);
  made_.frameset.frames[0].buffer = large->borrow();
  ASSERT_TRUE(offer_at(1000));
  EXPECT_FALSE(has_image_);
}

TEST_F(LiveFeedTest, OfferingAllocatesNothing) {
  feed_.set_viewers(1);
  made_.frameset.time = Time(milliseconds(1000));
  const VisionSnapshot snapshot = made_.snapshot();
  const uint64_t before = bench::allocation_count();
  feed_.offer(snapshot);
  EXPECT_EQ(bench::allocation_count(), before);
  EXPECT_TRUE(feed_.take([](const LiveSample&) {}));
}

}  // namespace
}  // namespace bevloc::firmware
