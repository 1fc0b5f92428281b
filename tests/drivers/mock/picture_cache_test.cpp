#include "drivers/mock/picture_cache.h"

#include <gtest/gtest.h>

#include "tests/drivers/mock/mock_rig.h"

namespace bevloc::drivers {
namespace {

RgbImage flat(uint8_t value) {
  RgbImage image(4, 3);
  std::ranges::fill(image.pixels, value);
  return image;
}

TEST(PictureCache, FindsWhatItKept) {
  PictureCache cache;
  RgbImage image = flat(0);
  EXPECT_FALSE(cache.find(1, image));
  cache.keep(1, flat(7));
  ASSERT_TRUE(cache.find(1, image));
  EXPECT_EQ(image.pixels, flat(7).pixels);
  EXPECT_EQ(cache.counters().found, 1U);
  EXPECT_EQ(cache.counters().bytes, 36U);
  cache.clear();
  EXPECT_FALSE(cache.find(1, image));
  EXPECT_EQ(cache.counters().bytes, 0U);
}

TEST(PictureCache, KeepsNoMoreThanItHasRoomFor) {
  PictureCache cache(80);
  for (uint64_t key = 0; key < 5; ++key) cache.keep(key, flat(1));
  EXPECT_EQ(cache.counters().kept, 2U);
  EXPECT_LE(cache.counters().bytes, 80U);
}

/// Scenes of equal and of different worlds, cameras and noise.
class CachedScenes : public testing::Test {
 protected:
  static std::shared_ptr<MockScene> scene(uint64_t seed, uint64_t noise_seed,
                                          std::shared_ptr<PictureCache> cache) {
    const auto world = std::make_shared<const sim::World>(sim::generate_world(seed));
    const auto drive = std::make_shared<const sim::Drive>(*world, seed, 10.0);
    return std::make_shared<MockScene>(world, drive, sim::Conditions{}, noise_seed,
                                       std::move(cache));
  }
  static Pixels draw(MockScene& scene, const sim::MountedCamera& camera, int time_ms) {
    RgbImage image(camera.now.intrinsics.width_px, camera.now.intrinsics.height_px);
    scene.draw(1, camera, std::chrono::milliseconds(time_ms), image);
    return image.pixels;
  }

  const CameraModel camera_ = small_front_camera().true_rig.cameras[1];
};

TEST_F(CachedScenes, EqualScenesShareTheirPicturesAndGetTheSamePixels) {
  const auto cache = std::make_shared<PictureCache>();
  const auto alone = scene(2006, 1, nullptr);
  const auto first = scene(2006, 1, cache);
  const auto second = scene(2006, 1, cache);
  const Pixels drawn = draw(*first, camera_, 700);
  EXPECT_EQ(cache->counters().found, 0U);
  EXPECT_EQ(draw(*second, camera_, 700), drawn);
  EXPECT_EQ(cache->counters().found, 1U);
  EXPECT_EQ(draw(*alone, camera_, 700), drawn);
}

TEST_F(CachedScenes, WhatDiffersIsDrawnAnew) {
  const auto cache = std::make_shared<PictureCache>();
  const auto base = scene(2006, 1, cache);
  draw(*base, camera_, 700);
  draw(*base, camera_, 800);
  CameraModel turned = camera_;
  turned.vehicle_from_camera.translation_m.x() += 0.001;
  draw(*base, turned, 700);
  draw(*base, {turned, camera_}, 700);
  draw(*scene(2006, 2, cache), camera_, 700);
  draw(*scene(2007, 1, cache), camera_, 700);
  EXPECT_EQ(cache->counters().found, 0U);
  EXPECT_EQ(cache->counters().kept, 6U);
}

}  // namespace
}  // namespace bevloc::drivers
