// How fast the simulator draws.
#include <vector>

#include <benchmark/benchmark.h>

#include "pipeline/preprocessing/network_camera.h"
#include "sim/random.h"
#include "sim/render/ground_painter.h"
#include "sim/render/renderer.h"
#include "sim/sim_rig.h"
#include "sim/vehicle/placement.h"
#include "sim/world/world_generator.h"

namespace bevloc::sim {
namespace {

constexpr int kPosesPerWorld = 16;

int64_t pixels_of_rig(const Rig& rig) {
  int64_t pixels = 0;
  for (const CameraModel& camera : rig.cameras) {
    pixels += int64_t{camera.intrinsics.width_px} * camera.intrinsics.height_px;
  }
  return pixels;
}

void report_pixels(benchmark::State& state, const Rig& rig) {
  state.counters["s/px"] = benchmark::Counter(
      static_cast<double>(pixels_of_rig(rig)),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void render_rig(Renderer& renderer, const Rig& rig, const Se2& pose, double time_s,
                const Conditions& conditions, RgbImage& image) {
  for (size_t i = 0; i < rig.cameras.size(); ++i) {
    renderer.render(rig.cameras[i], pose, {}, time_s, conditions, i, image);
    benchmark::DoNotOptimize(image.pixels.data());
  }
}

/// Training: six network-size images of a random place; a new renderer, with no ground painted yet,
/// every 16 places. The argument is the hour: 0 day, 1 night.
void BM_TrainingFrameset(benchmark::State& state) {
  const World world = generate_world(kFirstTrainingSeed + 1);
  const Rig rig = network_rig(nominal_rig());
  Random random(1);
  Conditions conditions;
  if (state.range(0) == 1) conditions.sun_elevation_rad = -0.4;
  std::unique_ptr<Renderer> renderer;
  RgbImage image;
  int drawn = 0;
  for (auto _ : state) {
    if (drawn++ % kPosesPerWorld == 0) renderer = std::make_unique<Renderer>(world);
    render_rig(*renderer, rig, random_pose_on_road(world, random), 0.0, conditions, image);
  }
  report_pixels(state, rig);
}
BENCHMARK(BM_TrainingFrameset)->Arg(0)->Arg(1)->Iterations(96)->Unit(benchmark::kMillisecond);

/// The same places with all the ground painted already.
void BM_TrainingFramesetWarm(benchmark::State& state) {
  const World world = generate_world(kFirstTrainingSeed + 1);
  const Rig rig = network_rig(nominal_rig());
  Random random(1);
  Renderer renderer(world);
  const Se2 pose = random_pose_on_road(world, random);
  RgbImage image;
  double time_s = 0.0;
  for (auto _ : state) render_rig(renderer, rig, pose, time_s += 0.1, {}, image);
  report_pixels(state, rig);
}
BENCHMARK(BM_TrainingFramesetWarm)->Unit(benchmark::kMillisecond);

/// The demo: six full-size distorted frames, ten times a second, driving at 10 m/s.
void BM_FullSizeFrameset(benchmark::State& state) {
  const World world = generate_world(1);
  const Rig rig = nominal_rig();
  Random random(1);
  Renderer renderer(world);
  const Se2 start = random_pose_on_road(world, random);
  RgbImage image;
  double time_s = 0.0;
  for (auto _ : state) {
    time_s += 0.1;
    render_rig(renderer, rig, start * Se2{10.0 * time_s, 0.0, 0.0}, time_s, {}, image);
  }
  report_pixels(state, rig);
}
BENCHMARK(BM_FullSizeFrameset)->Iterations(40)->Unit(benchmark::kMillisecond);

/// One ground tile; the argument is its level.
void BM_GroundTile(benchmark::State& state) {
  const World world = generate_world(1);
  GroundPainter painter(world);
  Random random(1);
  std::vector<GroundTexel> texels(kTileArea);
  const int level = static_cast<int>(state.range(0));
  for (auto _ : state) {
    const Se2 pose = random_pose_on_road(world, random);
    painter.paint({level, static_cast<int64_t>(std::floor(pose.x_m / tile_size_m(level))),
                   static_cast<int64_t>(std::floor(pose.y_m / tile_size_m(level)))},
                  texels.data());
  }
}
BENCHMARK(BM_GroundTile)
    ->DenseRange(0, kGroundLevels - 1)
    ->Iterations(50)
    ->Unit(benchmark::kMicrosecond);

/// A renderer's own start: indexing the world.
void BM_MakeRenderer(benchmark::State& state) {
  const World world = generate_world(1);
  for (auto _ : state) benchmark::DoNotOptimize(Renderer(world));
}
BENCHMARK(BM_MakeRenderer)->Iterations(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace bevloc::sim

BENCHMARK_MAIN();
