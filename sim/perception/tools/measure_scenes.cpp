// bevloc_measure_scenes: measures the matching scenes. Prints the IoU of the perceived masks at
// each corruption level and the time per scene; writes images of the first scenes on request.
#include <array>
#include <chrono>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <opencv2/core.hpp>

#include "common/files.h"
#include "common/option_checks.h"
#include "common/picture_file.h"
#include "pipeline/map/rasterizer.h"
#include "sim/perception/mask_features.h"
#include "sim/perception/matching_scene.h"

namespace bevloc::sim {
namespace {

struct Options {
  bool tuning = false;
  int scenes = 200;
  int images = 0;
  std::string out = "scenes";
};

/// Intersection and union of perceived and true cells, summed over scenes.
struct Overlap {
  std::array<double, kRasterChannels> intersection{};
  std::array<double, kRasterChannels> joined{};

  void add(const MatchingScene& scene) {
    const auto plane = static_cast<size_t>(kRasterGrid.cells());
    for (size_t i = 0; i < kRasterSize; ++i) {
      const bool seen = scene.perceived[i] > 0.5F;
      const bool there = scene.raster_truth[i] > 127;
      intersection[i / plane] += seen && there ? 1.0 : 0.0;
      joined[i / plane] += seen || there ? 1.0 : 0.0;
    }
  }

  double iou(size_t channel) const { return intersection[channel] / joined[channel]; }
};

void measure_overlap(const Options& options, uint64_t seed_base) {
  SceneSampler sampler(seed_base);
  std::array<Overlap, kCorruptionLevels> overlaps;
  MatchingScene scene;
  for (int i = 0; i < options.scenes; ++i) {
    for (size_t level = 0; level < overlaps.size(); ++level) {
      sampler.make(static_cast<uint64_t>(i), static_cast<CorruptionLevel>(level), scene);
      overlaps[level].add(scene);
    }
  }
  std::printf("IoU over %d scenes: divider, crossing, boundary\n", options.scenes);
  for (size_t level = 0; level < overlaps.size(); ++level) {
    const Overlap& overlap = overlaps[level];
    std::printf("%-6s %.3f %.3f %.3f\n", name(static_cast<CorruptionLevel>(level)), overlap.iou(0),
                overlap.iou(1), overlap.iou(2));
  }
}

void measure_time(const Options& options, uint64_t seed_base) {
  SceneSampler sampler(seed_base);
  MaskFeatures features(16, kFeatureGrid);
  std::vector<float> values(static_cast<size_t>(16) * kFeatureGrid.cells());
  MatchingScene scene;
  const auto seconds = [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  };
  double making = 0.0;
  double computing = 0.0;
  for (int i = 0; i < options.scenes; ++i) {
    const double start = seconds();
    sampler.make(static_cast<uint64_t>(i), CorruptionLevel::kPaper, scene);
    const double made = seconds();
    features.compute(std::span<const float>(scene.perceived), values);
    features.compute(std::span<const uint8_t>(scene.raster_prior), values);
    making += made - start;
    computing += seconds() - made;
  }
  std::printf("per scene: %.1f ms to make, %.1f ms for 16 channels of both sides\n",
              1e3 * making / options.scenes, 1e3 * computing / options.scenes);
}

/// Shows the three channels as blue, green and red on black.
template <typename Value>
cv::Mat3b image_of(const std::vector<Value>& planes, double scale) {
  std::array<cv::Mat1b, kRasterChannels> channels;
  for (size_t k = 0; k < channels.size(); ++k) {
    const cv::Mat_<Value> plane(kRasterGrid.rows, kRasterGrid.cols,
                                const_cast<Value*>(planes.data()) + k * kRasterGrid.cells());
    plane.convertTo(channels[k], CV_8U, scale);
  }
  cv::Mat3b image;
  cv::merge(channels.data(), channels.size(), image);
  return image;
}

/// Writes one image per scene: the map at the true pose, the perceived masks from mild to hard, and
/// the map at the prior.
Status write_images(const Options& options, uint64_t seed_base) {
  if (options.images == 0) return {};
  if (Status made = create_folder(options.out); !made) return made;
  SceneSampler sampler(seed_base);
  MatchingScene scene;
  for (int i = 0; i < options.images; ++i) {
    std::vector<cv::Mat> parts;
    for (const auto level :
         {CorruptionLevel::kMild, CorruptionLevel::kPaper, CorruptionLevel::kHard}) {
      sampler.make(static_cast<uint64_t>(i), level, scene);
      if (parts.empty()) parts.push_back(image_of(scene.raster_truth, 1.0));
      parts.push_back(image_of(scene.perceived, 255.0));
    }
    parts.push_back(image_of(scene.raster_prior, 1.0));
    for (cv::Mat& part : parts) {
      cv::copyMakeBorder(part, part, 2, 2, 2, 2, cv::BORDER_CONSTANT, cv::Scalar::all(128));
    }
    cv::Mat row;
    cv::hconcat(parts, row);
    const std::string file =
        options.out + "/" + std::to_string(i) + "_" + name(scene.kind) + ".png";
    if (Status written = write_picture(row, file); !written) return written;
  }
  return {};
}

}  // namespace
}  // namespace bevloc::sim

int main(int argc, char** argv) {
  constexpr int kMostScenes = 100'000;
  static_assert(kMostScenes <= bevloc::sim::scenes_of(bevloc::sim::kSceneSeedCount));
  bevloc::sim::Options options;
  CLI::App app("Measures the scenes on which pose solvers are evaluated");
  app.add_flag("--tuning", options.tuning, "Use the tuning seeds instead of the evaluation seeds");
  app.add_option("--scenes", options.scenes, "Number of scenes to measure")
      ->check(CLI::Range(0, kMostScenes));
  app.add_option("--pictures", options.images, "Number of scenes to draw as images")
      ->check(CLI::Range(0, kMostScenes));
  app.add_option("--out", options.out, "Folder for the images")
      ->check(bevloc::is_name_of("a folder"));
  if (const auto ended = bevloc::parse_options(app, argc, argv)) return *ended;
  const uint64_t seed_base =
      options.tuning ? bevloc::sim::kTuningSeedBase : bevloc::sim::kEvaluationSeedBase;
  if (options.scenes > 0) {
    bevloc::sim::measure_overlap(options, seed_base);
    bevloc::sim::measure_time(options, seed_base);
  }
  const bevloc::Status written = bevloc::sim::write_images(options, seed_base);
  if (!written) fmt::print(stderr, "{}\n", written.error().message);
  return written ? 0 : bevloc::kBadInput;
}
