#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "common/se2.h"
#include "pipeline/bev_grid.h"
#include "training/native/sample_queue.h"
#include "training/native/sample_record.h"

namespace bevloc {
namespace {

using sim::kSamplesPerWorld;
using sim::Sample;
using sim::SampleStream;
using sim::TrainingNuisances;

constexpr size_t kPixels = static_cast<size_t>(kNetworkHeightPx) * kNetworkWidthPx;
constexpr size_t kViewTable = 8 * 5000;

// A seed that training never uses.
constexpr uint64_t kSeed = 17;

SampleStream stream(double drop_probability, const TrainingNuisances& nuisances = {}) {
  SampleStream found;
  found.first_seed = kSeed;
  found.nuisances.missing_cameras.probability = drop_probability;
  found.training = nuisances;
  return found;
}

/// Samples as the records that training reads.
using Records = std::vector<std::vector<uint8_t>>;

struct Batch {
  std::vector<TrainingSample> samples;
  Records records;
};

Batch read(SampleQueue& queue, int count) {
  Batch batch;
  for (int i = 0; i < count; ++i) {
    batch.samples.push_back(queue.next());
    write_sample_record(batch.samples.back().content(), batch.records.emplace_back());
  }
  return batch;
}

Batch sample(uint64_t first_sample, int count, int threads, double drop_probability,
             const TrainingNuisances& nuisances = {}) {
  SampleQueue queue(stream(drop_probability, nuisances), nullptr, first_sample, threads);
  return read(queue, count);
}

/// The last three samples of one world and the first two of the next, with missing cameras.
const Batch& two_worlds() {
  static const Batch batch = sample(kSamplesPerWorld - 3, 5, 1, 1.0);
  return batch;
}

TEST(Sampler, SamplesDoNotDependOnTheNumberOfThreads) {
  EXPECT_EQ(sample(kSamplesPerWorld - 3, 5, 3, 1.0).records, two_worlds().records);
}

TEST(Sampler, ResumesInTheMiddleOfAStream) {
  const Records& whole = two_worlds().records;
  EXPECT_EQ(sample(kSamplesPerWorld - 1, 2, 1, 1.0).records,
            Records(whole.begin() + 2, whole.begin() + 4));
}

TEST(Sampler, BatchesJoinWithoutAGap) {
  SampleQueue queue(stream(1.0), nullptr, kSamplesPerWorld - 3, 2);
  for (const std::vector<uint8_t>& record : two_worlds().records) {
    EXPECT_EQ(read(queue, 1).records[0], record);
  }
}

TEST(Sampler, CanBeDestroyedWhileWorkersAreBusy) {
  for (int i = 0; i < 3; ++i) SampleQueue(stream(0.0), nullptr, 0, 2);
}

TEST(Sampler, CorrectionsLieInTheirRangeAndDiffer) {
  const std::vector<TrainingSample>& samples = two_worlds().samples;
  for (size_t i = 0; i < samples.size(); ++i) {
    const Se2& correction = samples[i].sample.correction;
    EXPECT_LE(std::abs(correction.x_m), 2.0);
    EXPECT_LE(std::abs(correction.y_m), 1.0);
    EXPECT_LE(std::abs(correction.yaw_rad), radians(2.0));
    for (size_t j = 0; j < i; ++j) EXPECT_NE(correction.x_m, samples[j].sample.correction.x_m);
  }
}

TEST(Sampler, MissingCamerasAreBlackAndTheOthersAreNot) {
  for (const auto& [sample, table] : two_worlds().samples) {
    const CameraMask cameras = sample.cameras;
    EXPECT_GE(cameras.count(), kCameraCount - 2U);
    EXPECT_LT(cameras.count(), static_cast<size_t>(kCameraCount));
    for (size_t camera = 0; camera < kCameraCount; ++camera) {
      const auto first = sample.images.begin() + static_cast<std::ptrdiff_t>(camera * 3 * kPixels);
      const auto [darkest, brightest] = std::minmax_element(first, first + 3 * kPixels);
      if (cameras[camera]) {
        EXPECT_GT(*brightest - *darkest, 10) << "an image of a present camera has no contrast";
      } else {
        EXPECT_EQ(*brightest, 0);
      }
    }
  }
  for (const auto& [sample, table] : sample(0, 2, 1, 0.0).samples) {
    EXPECT_TRUE(sample.cameras.all());
  }
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
  for (const auto& [sample, table] : two_worlds().samples) {
    const uint8_t* prior = sample.raster_prior.data();
    const uint8_t* truth = sample.raster_truth.data();
    ASSERT_GT(*std::ranges::max_element(sample.raster_truth), 0) << "the raster is empty";
    const double right = mismatch(prior, truth, sample.correction);
    EXPECT_LT(right, 2.0);
    EXPECT_LT(5.0 * right, mismatch(prior, truth, sample.correction.inverse()));
    EXPECT_LT(2.0 * right, mismatch(prior, truth, {}));
  }
}

TEST(Sampler, TheViewTableIsThatOfTheRigWithItsCameras) {
  const Rig& own = sim::nominal_network_rig();
  for (const auto& [sample, table] : two_worlds().samples) {
    const ViewTable expected = make_view_table(own, sample.cameras, kFeatureGrid);
    EXPECT_EQ(table.index, expected.index);
    EXPECT_EQ(table.weight, expected.weight);
  }
}

bool any_motion(const Sample& sample) {
  return std::ranges::any_of(sample.reference_from_exposure, [](const Se2& motion) {
    return motion.x_m != 0.0 || motion.y_m != 0.0 || motion.yaw_rad != 0.0;
  });
}

TEST(Sampler, OnlyStrongNuisancesMoveCamerasInSomeSamples) {
  const Batch usual = sample(0, kSamplesPerWorld, 1, 0.0);
  const Batch strong = sample(0, kSamplesPerWorld, 1, 0.0, sim::strong_nuisances());
  const Batch last_eight = sample(kSamplesPerWorld - 8, 8, 2, 0.0, sim::strong_nuisances());
  EXPECT_EQ(Records(strong.records.end() - 8, strong.records.end()), last_eight.records);
  size_t moved = 0;
  for (size_t i = 0; i < kSamplesPerWorld; ++i) {
    EXPECT_FALSE(any_motion(usual.samples[i].sample));
    EXPECT_EQ(strong.samples[i].sample.correction.x_m, usual.samples[i].sample.correction.x_m);
    EXPECT_NE(strong.samples[i].sample.images, usual.samples[i].sample.images);
    if (!any_motion(strong.samples[i].sample)) continue;
    EXPECT_NE(strong.samples[i].table.weight, usual.samples[i].table.weight);
    ++moved;
  }
  EXPECT_GT(moved, 0U);
  EXPECT_LT(moved, kSamplesPerWorld / 2);
}

TEST(Sampler, StreetNuisancesHaveOtherRigsInSomeSamples) {
  const Batch street = sample(0, kSamplesPerWorld, 1, 0.0, sim::street_nuisances());
  const Rig& own = sim::nominal_network_rig();
  size_t others = 0;
  for (const auto& [sample, table] : street.samples) {
    const auto& rig = sample.rig;
    const bool other = rig.cameras[0].vehicle_from_camera.translation_m !=
                       own.cameras[0].vehicle_from_camera.translation_m;
    if (!other || any_motion(sample)) continue;
    EXPECT_NE(table.weight, make_view_table(own, sample.cameras, kFeatureGrid).weight);
    ++others;
  }
  EXPECT_GT(others, 1U);
  EXPECT_LT(others, kSamplesPerWorld - 3);
}

TEST(Sampler, RecordsHoldTheSampleInTheirStatedOrder) {
  const Batch& batch = two_worlds();
  ASSERT_EQ(sample_stream_header().size(), 40U);
  EXPECT_EQ(std::memcmp(sample_stream_header().data(), "bevlocS1", 8), 0);
  for (size_t i = 0; i < batch.records.size(); ++i) {
    const auto& [sample, table] = batch.samples[i];
    const std::vector<uint8_t>& record = batch.records[i];
    ASSERT_EQ(record.size(), sample_record_size());
    const uint8_t* at = record.data();
    const auto expect = [&at](const void* bytes, size_t size) {
      EXPECT_EQ(std::memcmp(at, bytes, size), 0);
      at += size;
    };
    expect(sample.images.data(), sample.images.size());
    expect(sample.raster_prior.data(), sample.raster_prior.size());
    expect(sample.raster_truth.data(), sample.raster_truth.size());
    expect(table.index.data(), kViewTable * sizeof(int32_t));
    expect(table.weight.data(), kViewTable * sizeof(float));
    const float x = static_cast<float>(sample.correction.x_m);
    expect(&x, sizeof x);
    at += 2 * sizeof(float);
    const auto cameras = static_cast<uint32_t>(sample.cameras.to_ulong());
    expect(&cameras, sizeof cameras);
    EXPECT_EQ(at, record.data() + record.size());
  }
}

}  // namespace
}  // namespace bevloc
