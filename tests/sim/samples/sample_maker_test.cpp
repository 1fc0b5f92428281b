#include "sim/samples/sample_maker.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <span>

#include <gtest/gtest.h>

#include "pipeline/map/map_loader.h"
#include "sim/sim_rig.h"
#include "tests/support/turned_rig.h"

namespace bevloc::sim {
namespace {

constexpr uint64_t kSeed = 17;
constexpr size_t kCount = 3;
constexpr size_t kImageSize = kImagesSize / kCameraCount;

std::vector<Sample> make(const SampleStream& stream) {
  std::vector<Sample> samples;
  make_samples_of_world(stream, 0, 0, [&samples](Sample&& sample) {
    samples.push_back(std::move(sample));
    return samples.size() < kCount;
  });
  return samples;
}

SampleStream stream_of(NuisanceSet set, uint64_t seed = kSeed) {
  return {seed, nuisances_of(set), nullptr};
}

/// Made once for all tests.
const std::vector<Sample>& samples_of(NuisanceSet set) {
  static std::map<NuisanceSet, std::vector<Sample>> made;
  std::vector<Sample>& samples = made[set];
  if (samples.empty()) samples = make(stream_of(set));
  return samples;
}

std::span<const uint8_t> image_of(const Sample& sample, size_t camera) {
  return std::span(sample.images).subspan(camera * kImageSize, kImageSize);
}

bool same_image(const Sample& a, const Sample& b, size_t camera) {
  return std::ranges::equal(image_of(a, camera), image_of(b, camera));
}

double brightness(const std::vector<Sample>& samples) {
  double sum = 0.0;
  for (const Sample& sample : samples) {
    sum = std::accumulate(sample.images.begin(), sample.images.end(), sum);
  }
  return sum;
}

class NuisanceSetTest : public testing::TestWithParam<NuisanceSet> {};

TEST_P(NuisanceSetTest, ShowsTheSamePlacesFromTheSamePriors) {
  for (size_t i = 0; i < kCount; ++i) {
    const Sample& sample = samples_of(GetParam())[i];
    const Sample& usual = samples_of(NuisanceSet::kSixCameras)[i];
    EXPECT_EQ(sample.correction.x_m, usual.correction.x_m);
    EXPECT_EQ(sample.correction.y_m, usual.correction.y_m);
    EXPECT_EQ(sample.correction.yaw_rad, usual.correction.yaw_rad);
    EXPECT_TRUE(sample.raster_truth == usual.raster_truth);
    const bool other_map =
        GetParam() == NuisanceSet::kMapErrors || GetParam() == NuisanceSet::kMapHabits;
    EXPECT_EQ(sample.raster_prior == usual.raster_prior, !other_map);
  }
}

TEST_P(NuisanceSetTest, ChangesTheImagesUnlessItAffectsOtherParts) {
  const bool same_images =
      GetParam() == NuisanceSet::kSixCameras || GetParam() == NuisanceSet::kMapErrors ||
      GetParam() == NuisanceSet::kMapHabits || GetParam() == NuisanceSet::kMissingCamera;
  size_t changed = 0;
  for (size_t i = 0; i < kCount; ++i) {
    const Sample& sample = samples_of(GetParam())[i];
    const Sample& usual = samples_of(NuisanceSet::kSixCameras)[i];
    for (size_t camera = 0; camera < kCameraCount; ++camera) {
      if (!sample.cameras[camera]) continue;
      changed += same_image(sample, usual, camera) ? 0 : 1;
    }
  }
  if (same_images) {
    EXPECT_EQ(changed, 0U);
  } else {
    EXPECT_GT(changed, kCameraCount) << "the usual sample may already have such images";
  }
}

TEST_P(NuisanceSetTest, LeavesOutCamerasOnlyInTheirSets) {
  for (const Sample& sample : samples_of(GetParam())) {
    if (GetParam() == NuisanceSet::kMissingCamera) {
      EXPECT_EQ(sample.cameras.count(), kCameraCount - 1U);
    } else if (GetParam() != NuisanceSet::kStandard) {
      EXPECT_TRUE(sample.cameras.all());
    }
    for (size_t camera = 0; camera < kCameraCount; ++camera) {
      const auto shown = image_of(sample, camera);
      const bool black = std::ranges::all_of(shown, [](uint8_t value) { return value == 0; });
      EXPECT_EQ(black, !sample.cameras[camera]);
    }
  }
}

TEST_P(NuisanceSetTest, ASampleDependsOnTheSeedAndItsNumberAlone) {
  const Sample& last = samples_of(GetParam()).back();
  make_samples_of_world(stream_of(GetParam()), 0, kCount - 1, [&last](const Sample& again) {
    EXPECT_TRUE(again.images == last.images);
    EXPECT_EQ(again.cameras, last.cameras);
    EXPECT_TRUE(again.raster_prior == last.raster_prior);
    return false;
  });
}

INSTANTIATE_TEST_SUITE_P(AllSets, NuisanceSetTest, testing::ValuesIn(all_nuisance_sets()),
                         [](const auto& parameter) {
                           return std::string(name_of(parameter.param));
                         });

TEST(SampleMaker, StandardSometimesLeavesOutCameras) {
  SampleStream stream = stream_of(NuisanceSet::kStandard);
  size_t incomplete = 0;
  make_samples_of_world(stream, 0, 0, [&incomplete](const Sample& sample) {
    incomplete += sample.cameras.all() ? 0 : 1;
    EXPECT_GE(sample.cameras.count(), kCameraCount - 2U);
    return true;
  });
  EXPECT_GT(incomplete, 0U);
  EXPECT_LT(incomplete, kSamplesPerWorld / 2);
}

TEST(SampleMaker, SeedsGiveDifferentSamples) {
  const std::vector<Sample> other = make(stream_of(NuisanceSet::kSixCameras, kSeed + 1));
  for (size_t i = 0; i < kCount; ++i) {
    const Sample& sample = samples_of(NuisanceSet::kSixCameras)[i];
    EXPECT_NE(sample.correction.x_m, other[i].correction.x_m);
    EXPECT_TRUE(sample.raster_truth != other[i].raster_truth);
  }
}

TEST(SampleMaker, ARigReplacesTheSimulatorsOwn) {
  SampleStream stream = stream_of(NuisanceSet::kSixCameras);
  Rig rig = nominal_rig();
  stream.rig = &rig;
  const std::vector<Sample>& own = samples_of(NuisanceSet::kSixCameras);
  EXPECT_EQ(make(stream)[0].images, own[0].images) << "the own rig, given as a rig";
  rig.cameras[1].vehicle_from_camera.translation_m.z() += 0.5;
  const Intrinsics& back = rig.cameras[4].intrinsics;
  const double right = back.width_px;
  const double bottom = back.height_px;
  rig.cameras[4].own_body_px = {
      {-1, bottom / 2}, {right, bottom / 2}, {right, bottom}, {-1, bottom}};
  const Sample changed = make(stream)[0];
  for (size_t camera = 0; camera < kCameraCount; ++camera) {
    EXPECT_EQ(same_image(changed, own[0], camera), camera != 1 && camera != 4) << camera;
  }
  const auto black = [](const Sample& sample) {
    return std::ranges::count(image_of(sample, 4), 0);
  };
  EXPECT_GT(black(changed), black(own[0]) + 3 * kNetworkWidthPx);
}

TEST(SampleMaker, WhatTheCamerasOfARigDoNotShowIsBlack) {
  SampleStream stream = stream_of(NuisanceSet::kSixCameras);
  Rig rig = nominal_rig();
  stream.rig = &rig;
  rig.cameras[1] = test::turned_down(rig, 40.0).cameras[1];
  rig.cameras[4] = test::turned_down(rig, -20.0).cameras[4];
  const Sample sample = make(stream)[0];
  EXPECT_EQ(std::ranges::count(image_of(sample, 1), 0), kImageSize) << "it sees the ground only";
  const auto black_in_row = [&sample](size_t row) {
    size_t count = 0;
    for (size_t colour = 0; colour < 3; ++colour) {
      const size_t first = (colour * kNetworkHeightPx + row) * kNetworkWidthPx;
      count += std::ranges::count(image_of(sample, 4).subspan(first, kNetworkWidthPx), 0);
    }
    return count;
  };
  EXPECT_EQ(black_in_row(kNetworkHeightPx - 1), 3U * kNetworkWidthPx) << "below its image";
  EXPECT_LT(black_in_row(static_cast<size_t>(kNetworkHorizonRow)), kNetworkWidthPx);
}

/// The samples of the training must not depend on the images that a drawn rig would have.
TEST(SampleMaker, ADrawnRigHasNoBlackEdges) {
  SampleStream stream = stream_of(NuisanceSet::kSixCameras);
  stream.nuisances.rig_variety = 1.0;
  const std::vector<Sample> drawn = make(stream);
  const Rig rig = test::turned_down(nominal_rig(), 40.0);
  stream.rig = &rig;
  const std::vector<Sample> beside_a_given_one = make(stream);
  for (size_t i = 0; i < kCount; ++i) {
    EXPECT_TRUE(beside_a_given_one[i].images == drawn[i].images);
  }
}

TEST(SampleMaker, NightIsDark) {
  EXPECT_LT(1.5 * brightness(samples_of(NuisanceSet::kNight)),
            brightness(samples_of(NuisanceSet::kClean)));
}

TEST(SampleMaker, DressesAMapAnewForEachWorld) {
  const auto map = load_map(BEVLOC_SOURCE_DIR "/tests/pipeline/map/fixtures/street.osm");
  ASSERT_TRUE(map) << map.error().message;
  SampleStream stream = stream_of(NuisanceSet::kClean);
  stream.map = &*map;
  const std::vector<Sample> samples = make(stream);
  for (const Sample& sample : samples) {
    EXPECT_GT(*std::ranges::max_element(sample.raster_truth), 0) << "the map is drawn";
  }
  ++stream.first_seed;
  EXPECT_TRUE(make(stream).front().images != samples.front().images);
}

bool is_still(const Sample& sample) {
  return std::ranges::all_of(sample.reference_from_exposure, [](const Se2& motion) {
    return motion.x_m == 0.0 && motion.y_m == 0.0 && motion.yaw_rad == 0.0;
  });
}

TEST(SampleMaker, ReportsTheMotionBetweenUnsynchronisedExposures) {
  double farthest_m = 0.0;
  for (size_t i = 0; i < kCount; ++i) {
    EXPECT_TRUE(is_still(samples_of(NuisanceSet::kSixCameras)[i]));
    const Sample& known = samples_of(NuisanceSet::kUnsynchronised)[i];
    const Sample& unknown = samples_of(NuisanceSet::kUnsynchronisedUncompensated)[i];
    EXPECT_FALSE(is_still(known));
    EXPECT_TRUE(is_still(unknown));
    EXPECT_TRUE(known.images == unknown.images);
    for (const Se2& motion : known.reference_from_exposure) {
      farthest_m = std::max(farthest_m, std::abs(motion.x_m));
      EXPECT_LT(std::abs(motion.y_m), 0.05);
    }
  }
  EXPECT_GT(farthest_m, 0.2);
  EXPECT_LT(farthest_m, 1.05) << "50 ms at 20 m/s, and a little error";
}

TEST(SampleMaker, SharesOfZeroChangeNothing) {
  SampleStream stream = stream_of(NuisanceSet::kSixCameras);
  stream.training = strong_nuisances();
  for (Strengthening* strengthening :
       {&stream.training.camera_spread_s, &stream.training.calibration_factor,
        &stream.training.body_tilt_rad, &stream.training.extra_vehicles,
        &stream.training.paint_wear_factor, &stream.training.map_errors}) {
    strengthening->share = 0.0;
  }
  const std::vector<Sample> samples = make(stream);
  for (size_t i = 0; i < kCount; ++i) {
    EXPECT_TRUE(samples[i].images == samples_of(NuisanceSet::kSixCameras)[i].images);
    EXPECT_TRUE(samples[i].raster_prior == samples_of(NuisanceSet::kSixCameras)[i].raster_prior);
  }
}

TEST(SampleMaker, AStrongerSampleDependsOnItsNumberAlone) {
  SampleStream stream = stream_of(NuisanceSet::kSixCameras);
  stream.training = strong_nuisances();
  const std::vector<Sample> samples = make(stream);
  EXPECT_TRUE(samples[0].images != samples_of(NuisanceSet::kSixCameras)[0].images);
  make_samples_of_world(stream, 0, kCount - 1, [&samples](const Sample& last) {
    EXPECT_TRUE(last.images == samples.back().images);
    EXPECT_TRUE(last.raster_prior == samples.back().raster_prior);
    return false;
  });
}

}  // namespace
}  // namespace bevloc::sim
