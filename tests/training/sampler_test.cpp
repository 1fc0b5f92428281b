#include "training/native/sampler.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "common/se2.h"
#include "pipeline/bev_grid.h"

namespace bevloc {
namespace {

// Sizes of the C interface (sampler.h).
constexpr size_t kCameras = 6;
constexpr size_t kPixels = 96 * 320;
constexpr size_t kImages = kCameras * 3 * kPixels;
constexpr size_t kRaster = 3 * 400 * 200;
constexpr size_t kViewTable = 8 * 5000;
constexpr size_t kMotions = kCameras * 3;
constexpr size_t kRig = kCameras * 15;
constexpr int kUsual = 0;
constexpr int kStrong = 1;
constexpr int kStreet = 2;
constexpr uint64_t kSamplesPerWorld = 16;

// A seed that training never uses.
constexpr uint64_t kSeed = 17;

struct Batch {
  explicit Batch(size_t count)
      : images(count * kImages),
        cameras(count),
        prior(count * kRaster),
        truth(count * kRaster),
        correction(count * 3),
        motions(count * kMotions),
        rigs(count * kRig) {}

  std::vector<uint8_t> images;
  std::vector<uint8_t> cameras;
  std::vector<uint8_t> prior;
  std::vector<uint8_t> truth;
  std::vector<float> correction;
  std::vector<float> motions;
  std::vector<float> rigs;

  size_t size() const { return cameras.size(); }
  bool operator==(const Batch&) const = default;
};

Batch sample(uint64_t first_sample, int count, int threads, double drop_probability,
             int nuisances = kUsual) {
  const std::unique_ptr<bevloc_sampler, decltype(&bevloc_sampler_destroy)> sampler(
      bevloc_sampler_create(kSeed, first_sample, threads, drop_probability, nuisances, nullptr),
      &bevloc_sampler_destroy);
  Batch batch(static_cast<size_t>(count));
  bevloc_sampler_next(sampler.get(), count, batch.images.data(), batch.cameras.data(),
                      batch.prior.data(), batch.truth.data(), batch.correction.data(),
                      batch.motions.data(), batch.rigs.data());
  return batch;
}

/// The last three samples of one world and the first two of the next, with missing cameras.
const Batch& two_worlds() {
  static const Batch batch = sample(kSamplesPerWorld - 3, 5, 1, 1.0);
  return batch;
}

TEST(Sampler, SamplesDoNotDependOnTheNumberOfThreads) {
  EXPECT_TRUE(sample(kSamplesPerWorld - 3, 5, 3, 1.0) == two_worlds());
}

TEST(Sampler, ResumesInTheMiddleOfAStream) {
  const Batch later = sample(kSamplesPerWorld - 1, 2, 1, 1.0);
  const Batch& whole = two_worlds();
  EXPECT_TRUE(
      std::equal(later.images.begin(), later.images.end(), whole.images.begin() + 2 * kImages));
  EXPECT_TRUE(
      std::equal(later.prior.begin(), later.prior.end(), whole.prior.begin() + 2 * kRaster));
  EXPECT_TRUE(
      std::equal(later.correction.begin(), later.correction.end(), whole.correction.begin() + 6));
}

TEST(Sampler, BatchesJoinWithoutAGap) {
  bevloc_sampler* sampler =
      bevloc_sampler_create(kSeed, kSamplesPerWorld - 3, 2, 1.0, kUsual, nullptr);
  const Batch& whole = two_worlds();
  for (size_t i = 0; i < whole.size(); ++i) {
    Batch one(1);
    bevloc_sampler_next(sampler, 1, one.images.data(), one.cameras.data(), one.prior.data(),
                        one.truth.data(), one.correction.data(), one.motions.data(),
                        one.rigs.data());
    EXPECT_EQ(one.cameras[0], whole.cameras[i]);
    EXPECT_TRUE(std::equal(one.images.begin(), one.images.end(),
                           whole.images.begin() + static_cast<std::ptrdiff_t>(i * kImages)));
  }
  bevloc_sampler_destroy(sampler);
}

TEST(Sampler, CanBeDestroyedWhileWorkersAreBusy) {
  for (int i = 0; i < 3; ++i)
    bevloc_sampler_destroy(bevloc_sampler_create(kSeed, 0, 2, 0.0, kUsual, nullptr));
}

TEST(Sampler, CorrectionsLieInTheirRangeAndDiffer) {
  const Batch& batch = two_worlds();
  for (size_t i = 0; i < batch.size(); ++i) {
    EXPECT_LE(std::abs(batch.correction[3 * i]), 2.0F);
    EXPECT_LE(std::abs(batch.correction[3 * i + 1]), 1.0F);
    EXPECT_LE(std::abs(batch.correction[3 * i + 2]), static_cast<float>(radians(2.0)));
    for (size_t j = 0; j < i; ++j) {
      EXPECT_NE(batch.correction[3 * i], batch.correction[3 * j]);
    }
  }
}

TEST(Sampler, MissingCamerasAreBlackAndTheOthersAreNot) {
  const Batch& batch = two_worlds();

  for (size_t i = 0; i < batch.size(); ++i) {
    const std::bitset<kCameras> cameras(batch.cameras[i]);
    EXPECT_GE(cameras.count(), kCameras - 2);
    EXPECT_LT(cameras.count(), kCameras);
    for (size_t camera = 0; camera < kCameras; ++camera) {
      const auto first =
          batch.images.begin() + static_cast<std::ptrdiff_t>(i * kImages + camera * 3 * kPixels);
      const auto [darkest, brightest] = std::minmax_element(first, first + 3 * kPixels);
      if (cameras[camera]) {
        EXPECT_GT(*brightest - *darkest, 10) << "an image of a present camera has no contrast";
      } else {
        EXPECT_EQ(*brightest, 0);
      }
    }
  }
  const Batch complete = sample(0, 2, 1, 0.0);
  for (const uint8_t cameras : complete.cameras) EXPECT_EQ(cameras, 0b111111);
}

/// The value of a raster channel, interpolated bilinearly; -1 outside.
double value_at(const uint8_t* channel, double row, double col) {
  const auto r = static_cast<int>(std::floor(row));
  const auto c = static_cast<int>(std::floor(col));
  if (r < 0 || c < 0 || r + 1 >= kRasterGrid.rows || c + 1 >= kRasterGrid.cols) return -1.0;
  const double v = row - r;
  const double u = col - c;
  const auto at = [channel](int y, int x) {
    return static_cast<double>(channel[y * kRasterGrid.cols + x]);
  };
  return (1 - v) * ((1 - u) * at(r, c) + u * at(r, c + 1)) +
         v * ((1 - u) * at(r + 1, c) + u * at(r + 1, c + 1));
}

/// Mean absolute difference between the truth raster and the prior raster moved by a correction: a
/// point p in the true vehicle frame is dT * p in the prior's frame.
double mismatch(const uint8_t* prior, const uint8_t* truth, const Se2& correction) {
  double sum = 0.0;
  double count = 0.0;
  for (int channel = 0; channel < kRasterChannels; ++channel) {
    const uint8_t* from = prior + static_cast<size_t>(channel) * kRasterGrid.cells();
    const uint8_t* to = truth + static_cast<size_t>(channel) * kRasterGrid.cells();
    for (int row = 0; row < kRasterGrid.rows; ++row) {
      for (int col = 0; col < kRasterGrid.cols; ++col) {
        const Eigen::Vector2d point =
            correction * Eigen::Vector2d(kRasterGrid.x_of_row(row), kRasterGrid.y_of_col(col));
        const double value =
            value_at(from, kRasterGrid.row_of_x(point.x()), kRasterGrid.col_of_y(point.y()));
        if (value < 0.0) continue;
        sum += std::abs(value - to[row * kRasterGrid.cols + col]);
        count += 1.0;
      }
    }
  }
  return sum / count;
}

TEST(Sampler, TheCorrectionTakesThePriorRasterToTheTrueOne) {
  const Batch& batch = two_worlds();
  for (size_t i = 0; i < batch.size(); ++i) {
    const uint8_t* prior = batch.prior.data() + i * kRaster;
    const uint8_t* truth = batch.truth.data() + i * kRaster;
    ASSERT_GT(*std::max_element(truth, truth + kRaster), 0) << "the raster is empty";
    const Se2 correction{batch.correction[3 * i], batch.correction[3 * i + 1],
                         batch.correction[3 * i + 2]};
    const double right = mismatch(prior, truth, correction);
    EXPECT_LT(right, 2.0);
    EXPECT_LT(5.0 * right, mismatch(prior, truth, correction.inverse()));
    EXPECT_LT(2.0 * right, mismatch(prior, truth, {}));
  }
}

TEST(Sampler, TheViewTableIsThatOfTheRigWithItsCameras) {
  std::vector<int32_t> index(kViewTable);
  std::vector<float> weight(kViewTable);
  bevloc_view_table(0b111111, index.data(), weight.data(), nullptr, nullptr);
  size_t seen = 0;
  for (size_t cell = 0; cell < 5000; ++cell) {
    float sum = 0.0F;
    for (size_t slot = 0; slot < 8; ++slot) sum += weight[slot * 5000 + cell];
    EXPECT_TRUE(sum == 0.0F || std::abs(sum - 1.0F) < 1e-4F);
    seen += sum > 0.0F ? 1 : 0;
  }
  EXPECT_GT(seen, 4000U);

  std::vector<float> front_only(kViewTable);
  bevloc_view_table(0b000010, index.data(), front_only.data(), nullptr, nullptr);
  EXPECT_NE(front_only, weight);
  for (size_t i = 0; i < kViewTable; ++i) {
    if (front_only[i] > 0.0F) {
      EXPECT_EQ(index[i] / 480, 1);
    }
  }
}

TEST(Sampler, OnlyStrongNuisancesMoveCamerasInSomeSamples) {
  const Batch usual = sample(0, kSamplesPerWorld, 1, 0.0);
  EXPECT_EQ(usual.motions, std::vector<float>(usual.motions.size()));
  const Batch strong = sample(0, kSamplesPerWorld, 1, 0.0, kStrong);
  EXPECT_TRUE(strong == sample(0, kSamplesPerWorld, 2, 0.0, kStrong));
  EXPECT_EQ(strong.correction, usual.correction);
  EXPECT_NE(strong.images, usual.images);
  size_t moved = 0;
  for (size_t i = 0; i < strong.size(); ++i) {
    const auto motions = strong.motions.begin() + static_cast<std::ptrdiff_t>(i * kMotions);
    moved += std::any_of(motions, motions + kMotions, [](float v) { return v != 0.0F; }) ? 1 : 0;
  }
  EXPECT_GT(moved, 0U);
  EXPECT_LT(moved, kSamplesPerWorld / 2);
}

TEST(Sampler, TheViewTableFollowsTheRig) {
  const Batch usual = sample(0, 1, 1, 0.0);
  std::vector<int32_t> index(kViewTable);
  std::vector<int32_t> own_index(kViewTable);
  std::vector<float> own(kViewTable);
  std::vector<float> of_sample(kViewTable);
  bevloc_view_table(0b111111, own_index.data(), own.data(), nullptr, nullptr);
  bevloc_view_table(0b111111, index.data(), of_sample.data(), nullptr, usual.rigs.data());
  EXPECT_EQ(index, own_index);
  for (size_t i = 0; i < kViewTable; ++i) EXPECT_NEAR(of_sample[i], own[i], 1e-3);
  std::vector<float> higher = usual.rigs;
  for (size_t camera = 0; camera < kCameras; ++camera) higher[camera * 15 + 14] += 0.5F;
  bevloc_view_table(0b111111, index.data(), of_sample.data(), nullptr, higher.data());
  EXPECT_NE(of_sample, own);
}

TEST(Sampler, StreetNuisancesHaveOtherRigsInSomeSamples) {
  const Batch street = sample(0, kSamplesPerWorld, 1, 0.0, kStreet);
  const Batch usual = sample(0, 1, 1, 0.0);
  size_t others = 0;
  for (size_t i = 0; i < street.size(); ++i) {
    const auto rig = street.rigs.begin() + static_cast<std::ptrdiff_t>(i * kRig);
    others += std::equal(rig, rig + kRig, usual.rigs.begin()) ? 0 : 1;
  }
  EXPECT_GT(others, 1U);
  EXPECT_LT(others, kSamplesPerWorld - 3);
}

TEST(Sampler, TheViewTableFollowsTheMotions) {
  std::vector<int32_t> index(kViewTable);
  std::vector<float> still(kViewTable);
  std::vector<float> zero_motion(kViewTable);
  std::vector<float> moved(kViewTable);
  std::vector<float> motions(kMotions);
  bevloc_view_table(0b111111, index.data(), still.data(), nullptr, nullptr);
  bevloc_view_table(0b111111, index.data(), zero_motion.data(), motions.data(), nullptr);
  EXPECT_EQ(zero_motion, still);
  motions[0] = 0.6F;
  bevloc_view_table(0b111111, index.data(), moved.data(), motions.data(), nullptr);
  EXPECT_NE(moved, still);
}

}  // namespace
}  // namespace bevloc
