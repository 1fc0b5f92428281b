// bevloc_render_world: renders the images of the six cameras at a pose in a world, as one PNG.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <opencv2/imgproc.hpp>

#include "common/files.h"
#include "common/image_file.h"
#include "common/option_checks.h"
#include "common/picture_file.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_binary.h"
#include "pipeline/preprocessing/network_camera.h"
#include "sim/random.h"
#include "sim/render/photo_library.h"
#include "sim/render/renderer.h"
#include "sim/sim_rig.h"
#include "sim/vehicle/placement.h"
#include "sim/world/world_generator.h"

namespace {

using bevloc::sim::Conditions;

struct Options {
  uint64_t seed = 1;
  std::string out = "world.png";
  std::vector<double> pose;  ///< x, y (metres), yaw (degrees); empty for a random pose on a road
  uint64_t pose_seed = 1;
  std::vector<double> ground{0.0, 0.0, 0.0};  ///< curvature along, across and twist, per metre
  std::string photos;
  std::string pictures;
  double time_s = 0.0;
  bool network_size = false;
  bool random_conditions = false;
  bool night = false;
  double sun_elevation_deg = 40.0;
  Conditions conditions;
};

void add_conditions(CLI::App& app, Options& options) {
  using bevloc::number_between;
  auto* sun = app.add_option("--sun-elevation", options.sun_elevation_deg,
                             "Elevation of the sun in degrees");
  sun->check(number_between(-90.0, 90.0));
  auto* overcast = app.add_option("--overcast", options.conditions.overcast, "Cloud cover, 0 to 1");
  overcast->check(number_between(0.0, 1.0));
  auto* rain = app.add_option("--rain", options.conditions.rain, "Strength of the rain, 0 to 1");
  rain->check(number_between(0.0, 1.0));
  auto* night = app.add_flag("--night", options.night, "Set the sun 30 degrees below the horizon");
  night->excludes(sun);
  app.add_flag("--random-conditions", options.random_conditions,
               "Draw light and weather from the pose seed")
      ->excludes(sun)
      ->excludes(overcast)
      ->excludes(rain)
      ->excludes(night);
}

void add_options(CLI::App& app, Options& options) {
  using bevloc::is_name_of;
  using bevloc::number_between;
  using bevloc::whole_number;
  app.add_option("--seed", options.seed, "Seed of the town")->check(whole_number());
  app.add_option("--out", options.out, "PNG to write")->check(bevloc::output_name());
  app.add_option(
         "--pose", options.pose,
         "Pose of the vehicle as x y yaw, in metres and degrees (default: a random pose on a road)")
      ->check(number_between(-1e6, 1e6))
      ->expected(3);
  app.add_option("--pose-seed", options.pose_seed, "Seed of the random pose")
      ->check(whole_number());
  app.add_option("--ground", options.ground,
                 "Curvature of the ground along the vehicle, across it, and its twist, per metre")
      ->check(number_between(-0.1, 0.1))
      ->expected(3);
  app.add_option("--pictures", options.pictures,
                 "Folder to which the six pictures, rig.yaml and map.bvm are written, too")
      ->check(is_name_of("a folder"));
  app.add_option("--photos", options.photos, "Folder of script/photos, to cover surfaces with")
      ->check(is_name_of("a folder"));
  app.add_option("--time", options.time_s, "Time of the simulated traffic in seconds")
      ->check(number_between(0.0, 1e6));
  app.add_flag("--network-size", options.network_size,
               "Render the network's input images instead of the camera images");
  add_conditions(app, options);
}

Conditions conditions_of(const Options& options) {
  if (options.random_conditions) return bevloc::sim::random_conditions(options.pose_seed);
  Conditions conditions = options.conditions;
  conditions.sun_elevation_rad = bevloc::radians(options.night ? -30.0 : options.sun_elevation_deg);
  return conditions;
}

/// Arranges the images in two rows of three, in the order of kCameraNames.
cv::Mat image_grid(const std::vector<bevloc::RgbImage>& images) {
  constexpr int kGapPx = 4;
  const cv::Size cell(images[0].width + kGapPx, images[0].height + kGapPx);
  cv::Mat grid(2 * cell.height - kGapPx, 3 * cell.width - kGapPx, CV_8UC3, cv::Scalar::all(255));
  for (int i = 0; i < bevloc::kCameraCount; ++i) {
    const bevloc::RgbImage& image = images[static_cast<size_t>(i)];
    const cv::Rect place((i % 3) * cell.width, (i / 3) * cell.height, image.width, image.height);
    // OpenCV's constructor takes a mutable pointer, but the pixels are only read.
    const cv::Mat rgb(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.row(0)));
    cv::cvtColor(rgb, grid(place), cv::COLOR_RGB2BGR);
  }
  return grid;
}

/// Writes what `bevloc localize` reads.
bevloc::Status write_pictures(const std::filesystem::path& folder, const bevloc::Rig& rig,
                              const bevloc::HdMap& map,
                              const std::vector<bevloc::RgbImage>& images) {
  if (auto made = bevloc::create_folder(folder); !made) return made;
  for (size_t i = 0; i < images.size(); ++i) {
    const std::filesystem::path file = folder / (std::string(bevloc::kCameraNames[i]) + ".png");
    if (auto status = bevloc::write_png(images[i].view(), file.string()); !status) return status;
  }
  if (auto status = bevloc::write_file(folder / "rig.yaml", bevloc::format_rig(rig)); !status) {
    return status;
  }
  return bevloc::write_file(folder / "map.bvm", bevloc::encode_map(map));
}

bevloc::Status render(const Options& options) {
  bevloc::sim::World world = bevloc::sim::generate_world(options.seed);
  std::optional<bevloc::sim::PhotoLibrary> photos;
  if (!options.photos.empty()) {
    auto loaded = bevloc::sim::PhotoLibrary::load(options.photos);
    if (!loaded) return tl::unexpected(loaded.error());
    photos = std::move(*loaded);
    world.photos = &*photos;
  }
  bevloc::sim::Random random(options.pose_seed);
  bevloc::Se2 pose = bevloc::sim::random_pose_on_road(world, random);
  if (!options.pose.empty()) {
    pose = {options.pose[0], options.pose[1], bevloc::radians(options.pose[2])};
  }
  bevloc::Rig rig = bevloc::sim::nominal_rig();
  if (options.network_size) rig = bevloc::network_rig(rig);

  bevloc::sim::Renderer renderer(world);
  std::vector<bevloc::RgbImage> images(bevloc::kCameraCount);
  const bevloc::sim::Stance stance{
      .ground = {options.ground[0], options.ground[1], options.ground[2]}};
  const Conditions conditions = conditions_of(options);
  for (size_t i = 0; i < images.size(); ++i) {
    renderer.render(rig.cameras[i], pose, stance, options.time_s, conditions, i, images[i]);
  }
  if (!options.pictures.empty()) {
    if (auto status = write_pictures(options.pictures, rig, world.map, images); !status) {
      return status;
    }
  }
  if (auto status = bevloc::write_picture(image_grid(images), options.out); !status) return status;
  fmt::print("{}: world {}, pose x {:.2f} m, y {:.2f} m, yaw {:.1f} deg\n", options.out,
             options.seed, pose.x_m, pose.y_m, bevloc::degrees(pose.yaw_rad));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Renders the six cameras of the simulated rig into one image");
  Options options;
  add_options(app, options);
  if (const auto ended = bevloc::parse_options(app, argc, argv)) return *ended;
  if (const auto rendered = render(options); !rendered) {
    fmt::print(stderr, "{}\n", rendered.error().message);
    return bevloc::kBadInput;
  }
  return 0;
}
