#include "pipeline/localization/localizer.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "sim/sim_rig.h"
#include "tests/pipeline/network/damaged_model.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

using Images = std::array<RgbImage, kCameraCount>;

Images noise(const Rig& rig) {
  std::mt19937 random(1);
  Images images;
  for (size_t camera = 0; camera < images.size(); ++camera) {
    const Intrinsics& lens = rig.cameras[camera].intrinsics;
    images[camera] = RgbImage(lens.width_px, lens.height_px);
    std::ranges::generate(images[camera].pixels, [&] { return static_cast<uint8_t>(random()); });
  }
  return images;
}

/// A road along x with a bend and a line across it.
HdMap road() {
  HdMap map;
  for (const double y : {-3.0, 0.0, 4.0}) {
    map.elements.push_back(
        {ElementClass::kLaneDivider, Appearance::kSolid, {{-40.0, y}, {0.0, y}, {40.0, y + 5.0}}});
  }
  map.elements.push_back(
      {ElementClass::kRoadBoundary, Appearance::kKerb, {{6.0, -8.0}, {6.0, 8.0}}});
  return map;
}

struct Outcome {
  CameraMask used;
  std::vector<float> mask;
  SolverResult result;
};

Outcome localize(const Rig& rig, const HdMap& map, const CameraImages& images, int threads) {
  const MapIndex index(map);
  LocalizerOptions options;
  options.network.threads = threads;
  auto localizer =
      Localizer::create(rig, index, std::string(BEVLOC_SOURCE_DIR) + "/models/nano.onnx", options);
  if (!localizer) {
    ADD_FAILURE() << localizer.error().message;
    return {};
  }
  Outcome outcome;
  outcome.used = (*localizer)->localize(images, {}, SearchRange::kTracking, outcome.result);
  const std::span<const float> mask = (*localizer)->perceived_mask();
  outcome.mask.assign(mask.begin(), mask.end());
  return outcome;
}

/// One camera is missing, and the image of another has the wrong size.
TEST(Localizer, GivesTheSameResultOnAnyNumberOfThreads) {
  const Rig rig = sim::nominal_rig();
  const Images noise_images = noise(rig);
  const RgbImage small(64, 48);
  CameraImages images;
  for (size_t camera = 0; camera < noise_images.size(); ++camera) {
    images.images[camera] = noise_images[camera].view();
    images.present[camera] = camera != 4;
  }
  images.images[1] = small.view();

  const Outcome one = localize(rig, road(), images, 1);
  EXPECT_EQ(one.used, CameraMask(0b101101));
  EXPECT_GT(std::ranges::max(one.mask) - std::ranges::min(one.mask), 1.0F);
  EXPECT_EQ(one.result.evidence, Evidence::kGood);
  for (const int threads : {2, 3}) {
    const Outcome many = localize(rig, road(), images, threads);
    EXPECT_EQ(many.used, one.used) << threads;
    EXPECT_EQ(many.mask, one.mask) << threads;
    EXPECT_EQ(many.result.x_probability, one.result.x_probability) << threads;
    EXPECT_EQ(many.result.covariance, one.result.covariance) << threads;
  }
}

TEST(Localizer, WithoutMappedLinesThereIsNoEvidence) {
  const Rig rig = sim::nominal_rig();
  const Images noise_images = noise(rig);
  CameraImages images;
  for (size_t camera = 0; camera < noise_images.size(); ++camera) {
    images.images[camera] = noise_images[camera].view();
  }
  images.present.set();
  EXPECT_EQ(localize(rig, HdMap{}, images, 1).result.evidence, Evidence::kNone);
  HdMap far_away = road();
  for (MapElement& element : far_away.elements) {
    for (Eigen::Vector2d& point : element.points) point.x() += 500.0;
  }
  EXPECT_EQ(localize(rig, far_away, images, 1).result.evidence, Evidence::kNone);
}

const std::string kModel = std::string(BEVLOC_SOURCE_DIR) + "/models/nano.onnx";

TEST(Localizer, TheCheckPassesAndLeavesNoTrace) {
  const Rig rig = sim::nominal_rig();
  const Images noise_images = noise(rig);
  CameraImages images;
  for (size_t camera = 0; camera < noise_images.size(); ++camera) {
    images.images[camera] = noise_images[camera].view();
  }
  images.present.set();
  const HdMap map;
  const MapIndex index(map);
  auto localizer = Localizer::create(rig, index, kModel, {}).value();
  EXPECT_TRUE(localizer->model_has_answer());
  SolverResult result;
  localizer->localize(images, {}, SearchRange::kTracking, result);
  const auto mask = localizer->perceived_mask();
  const std::vector<float> before(mask.begin(), mask.end());
  const Status checked = localizer->check();
  EXPECT_TRUE(checked) << checked.error().message;
  localizer->localize(images, {}, SearchRange::kTracking, result);
  EXPECT_TRUE(std::ranges::equal(localizer->perceived_mask(), before));
}

TEST(Localizer, TheCheckNeedsNoWideRange) {
  const HdMap map;
  const MapIndex index(map);
  LocalizerOptions options;
  options.tracking = {{0.4, 0.2}, {0.4, 0.2}, {radians(1.0), radians(0.2)}};
  auto localizer = Localizer::create(sim::nominal_rig(), index, kModel, options).value();
  const Status checked = localizer->check();
  EXPECT_TRUE(checked) << checked.error().message;
}

/// Checks a localizer that tracks and acquires with these steps along x and y.
void expect_check_passes(SolverKind kind, double tracking_step_m, double acquiring_step_m) {
  const auto with_step = [](double step_m) {
    const HypothesisAxis axis{4.0 * step_m, step_m};
    return HypothesisGrid{axis, axis, {radians(4.0), radians(1.0)}};
  };
  LocalizerOptions options;
  options.solver = kind;
  options.tracking = with_step(tracking_step_m);
  options.acquiring = with_step(acquiring_step_m);
  const HdMap map;
  const MapIndex index(map);
  const auto localizer = Localizer::create(sim::nominal_rig(), index, kModel, options);
  ASSERT_TRUE(localizer) << localizer.error().message;
  const Status checked = (*localizer)->check();
  EXPECT_TRUE(checked) << name_of(kind) << ", steps of " << tracking_step_m << " m and "
                       << acquiring_step_m << " m: " << checked.error().message;
}

/// The configuration accepts steps up to a quarter of the range, which is at most max_shift_m().
TEST(Localizer, TheCheckPassesWithTheCoarsestStepsForEverySolver) {
  constexpr double kCoarsestStep_m = max_shift_m(kFeatureGrid) / 4.0;
  for (const SolverKind kind : all_solver_kinds()) expect_check_passes(kind, 1.0, kCoarsestStep_m);
}

/// The nearest hypotheses are a third of a cell and half a cell from a whole number of cells.
TEST(Localizer, TheCheckPassesWithHypothesesBetweenTheCells) {
  expect_check_passes(LocalizerOptions().solver, 0.4, 0.9);
}

TEST(Localizer, TheCheckFindsDamagedWeights) {
  const test::TemporaryFolder folder;
  const auto path = test::damaged_model(folder);
  const HdMap map;
  const MapIndex index(map);
  auto localizer = Localizer::create(sim::nominal_rig(), index, path.string(), {});
  ASSERT_TRUE(localizer) << localizer.error().message;
  EXPECT_FALSE((*localizer)->check());
}

}  // namespace
}  // namespace bevloc
