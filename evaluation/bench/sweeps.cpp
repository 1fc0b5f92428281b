#include "evaluation/bench/sweeps.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <random>

#include <opencv2/imgproc.hpp>

#include "drivers/clock/clock.h"
#include "evaluation/bench/camera_formats.h"
#include "evaluation/bench/cost_model.h"
#include "evaluation/bench/repeated_town.h"
#include "evaluation/bench/resident_memory.h"
#include "evaluation/bench/scene.h"
#include "evaluation/bench/stage_work.h"
#include "evaluation/bench/timing.h"
#include "firmware/config/localizer_options.h"
#include "firmware/runtime/appliance.h"
#include "pipeline/map/rasterizer.h"

namespace bevloc::bench {
namespace {

const std::string kFixedSize =
    "The network's sizes are fixed at compile time; for other\nnetworks see "
    "docs/network-variants.md.";

Result<SweepResult> sweep_cameras(const evaluation::DriveConfig& config,
                                  const SweepOptions& options) {
  const auto scene = make_scene(config);
  if (!scene) return tl::unexpected(scene.error());
  const MapIndex index(scene->map);
  LocalizerOptions localizer_options = firmware::localizer_options_of(config);
  localizer_options.network.threads = options.threads;
  const auto localizer =
      Localizer::create(scene->rig, index, config.model_file.string(), localizer_options);
  if (!localizer) return tl::unexpected(localizer.error());
  CameraImages seen;
  for (size_t camera = 0; camera < kCameraCount; ++camera) {
    seen.images[camera] = scene->places[0].framesets[0][camera].view();
  }
  SweepResult sweep{"cameras",
                    "One localization with missing cameras. The network computes black images too.",
                    {"cameras", "p50_ms", "p99_ms"},
                    {}};
  for (int cameras = 1; cameras <= kCameraCount; ++cameras) {
    seen.present = CameraMask((1U << static_cast<unsigned>(cameras)) - 1U);
    SolverResult result;
    const TimeSummary time = time_of(
        [&] {
          // This cannot fail, because the images have the rig's size.
          (void)(*localizer)
              ->localize(seen, scene->places[0].map_from_vehicle, SearchRange::kTracking, result);
        },
        options.frames);
    sweep.rows.push_back({static_cast<double>(cameras), time.p50_ms, time.p99_ms});
  }
  return sweep;
}

RgbImage resized(const RgbImage& image, int width_px, int height_px) {
  RgbImage larger(width_px, height_px);
  // OpenCV's constructor needs mutable pixels; those of `image` are only read.
  const cv::Mat from(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.row(0)));
  cv::Mat to(height_px, width_px, CV_8UC3, larger.row(0));
  cv::resize(from, to, to.size(), 0.0, 0.0, cv::INTER_LINEAR);
  return larger;
}

Result<SweepResult> sweep_image(const evaluation::DriveConfig& config,
                                const SweepOptions& options) {
  const auto scene = make_scene(config);
  if (!scene) return tl::unexpected(scene.error());
  SweepResult sweep{
      "image",
      "From six images of this size to network input, from RGB and from MJPEG. " + kFixedSize,
      {"width_px", "height_px", "p50_ms", "p99_ms", "mjpeg_p50_ms", "mjpeg_p99_ms"},
      {}};
  for (const double scale : {0.5, 1.0, 2.0, 3.0, 4.0, 6.0}) {
    std::vector<ImagePreprocessor> preprocessors;
    FramesetImages images;
    for (size_t camera = 0; camera < kCameraCount; ++camera) {
      CameraModel model = scene->rig.cameras[camera];
      const auto length = [scale](int px) { return static_cast<int>(std::lround(scale * px)); };
      model = resized(model, length(model.intrinsics.width_px), length(model.intrinsics.height_px));
      preprocessors.emplace_back(model);
      images[camera] = resized(scene->places[0].framesets[0][camera], model.intrinsics.width_px,
                               model.intrinsics.height_px);
    }
    const auto files = convert(images, PixelFormat::kMjpeg);
    if (!files) return tl::unexpected(files.error());
    std::vector<int8_t> planes(kNetworkImageSize);
    const auto time_all = [&](const auto& view_of) {
      return time_of(
          [&] {
            for (size_t camera = 0; camera < kCameraCount; ++camera) {
              (void)preprocessors[camera].run(view_of(camera), planes);
            }
          },
          options.frames);
    };
    const TimeSummary rgb = time_all([&](size_t i) { return ImageView(images[i].view()); });
    const TimeSummary mjpeg = time_all([&](size_t i) { return (*files)[i].view; });
    sweep.rows.push_back({static_cast<double>(images[0].width),
                          static_cast<double>(images[0].height), rgb.p50_ms, rgb.p99_ms,
                          mjpeg.p50_ms, mjpeg.p99_ms});
  }
  return sweep;
}

std::vector<float> noise(size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> values(count);
  std::ranges::generate(values, [&] { return normal(random); });
  return values;
}

Result<TimeSummary> time_solver(const evaluation::DriveConfig& config, const BevGrid& grid,
                                const HypothesisGrid& hypotheses, int repeats) {
  auto solver = make_solver(config.solver.kind, grid, kFeatureChannels, hypotheses, {});
  if (!solver) return tl::unexpected(solver.error());
  const size_t count = static_cast<size_t>(kFeatureChannels) * grid.cells();
  const std::vector<float> bev = noise(count, 1);
  const std::vector<float> map = noise(count, 2);
  SolverResult result;
  return time_of(
      [&] {
        (*solver)->solve({bev, kFeatureChannels, grid}, {map, kFeatureChannels, grid}, result);
      },
      repeats);
}

Result<SweepResult> sweep_bev(const evaluation::DriveConfig& config, const SweepOptions& options) {
  SweepResult sweep{"bev",
                    "The solver on the same area with other cell sizes. " + kFixedSize,
                    {"rows", "cols", "p50_ms", "p99_ms"},
                    {}};
  for (const int factor : {1, 2, 4}) {
    const BevGrid grid{factor * kFeatureGrid.rows, factor * kFeatureGrid.cols,
                       kFeatureGrid.cell_m / factor};
    const auto time = time_solver(config, grid, config.solver.tracking, options.frames);
    if (!time) return tl::unexpected(time.error());
    sweep.rows.push_back({static_cast<double>(grid.rows), static_cast<double>(grid.cols),
                          time->p50_ms, time->p99_ms});
  }
  return sweep;
}

HypothesisAxis wider(HypothesisAxis axis, double factor) {
  axis.range *= factor;
  return axis;
}

Result<SweepResult> sweep_hypotheses(const evaluation::DriveConfig& config,
                                     const SweepOptions& options) {
  const HypothesisGrid& usual = config.solver.tracking;
  SweepResult sweep{"hypotheses",
                    "The solver with other search ranges and the same steps.",
                    {"hypotheses", "x_range_m", "y_range_m", "yaw_range_deg", "p50_ms", "p99_ms"},
                    {}};
  for (const double factor : {0.5, 1.0, 2.0, 3.0}) {
    const HypothesisGrid grid{wider(usual.x_m, factor), wider(usual.y_m, factor),
                              wider(usual.yaw_rad, factor)};
    const auto time = time_solver(config, kFeatureGrid, grid, options.frames);
    if (!time && factor > 1.0) break;  // beyond the largest range that the grid allows
    if (!time) return tl::unexpected(time.error());
    sweep.rows.push_back({static_cast<double>(grid.count()), grid.x_m.range, grid.y_m.range,
                          grid.yaw_rad.range / radians(1.0), time->p50_ms, time->p99_ms});
  }
  return sweep;
}

std::vector<double> map_row(const HdMap& town, const Se2& place, double wanted_km, int repeats) {
  const drivers::MonotonicClock clock;
  const double before_mib = resident_memory().now_mib;
  const HdMap map = repeated_town(town, place.translation(), wanted_km);
  const Time start = clock.now();
  const MapIndex index(map);
  const double index_s = to_seconds(clock.now() - start);
  const double memory_mib = resident_memory().now_mib - before_mib;
  std::vector<MapIndex::Segment> found;
  const Surroundings around = surroundings_of(place);
  const TimeSummary crop =
      time_of([&] { index.query(around.min_corner, around.max_corner, found); }, repeats);
  MapRasterizer rasterizer(index);
  std::vector<uint8_t> raster(kRasterSize);
  const TimeSummary draw = time_of([&] { rasterizer.draw(place, raster); }, repeats);
  return {road_km(map), static_cast<double>(map.elements.size()),
          crop.p50_ms,  draw.p50_ms,
          draw.p99_ms,  index_s,
          memory_mib};
}

Result<SweepResult> sweep_map(const evaluation::DriveConfig& config, const SweepOptions& options) {
  constexpr double kLongestMap_km = 10'000.0;
  const auto scene = make_scene(config);
  if (!scene) return tl::unexpected(scene.error());
  SweepResult sweep{
      "map",
      "The crop, and the crop with the raster, around one place. The maps have other lengths; they "
      "are made from\nparts and copies of the configuration's map. road_km is the length of road; "
      "map_mib includes the index.",
      {"road_km", "elements", "crop_ms", "raster_ms", "raster_p99_ms", "index_s", "map_mib"},
      {}};
  for (double km = 1.0; km <= kLongestMap_km; km *= 10.0) {
    sweep.rows.push_back(
        map_row(scene->map, scene->places[0].map_from_vehicle, km, options.frames));
  }
  return sweep;
}

}  // namespace

Result<SweepResult> run_sweep(std::string_view name, const evaluation::DriveConfig& config,
                              const SweepOptions& options) {
  using Sweep = Result<SweepResult> (*)(const evaluation::DriveConfig&, const SweepOptions&);
  constexpr std::array<Sweep, kSweepNames.size()> kSweeps{sweep_cameras, sweep_image, sweep_bev,
                                                          sweep_hypotheses, sweep_map};
  const auto* const found = std::ranges::find(kSweepNames, name);
  assert(found != kSweepNames.end());
  return kSweeps[static_cast<size_t>(found - kSweepNames.begin())](config, options);
}

}  // namespace bevloc::bench
