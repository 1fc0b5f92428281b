// bevloc_render_world: draws what the six cameras see somewhere in a world, as one picture.
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pipeline/preprocessing/network_camera.h"
#include "sim/random.h"
#include "sim/render/renderer.h"
#include "sim/sim_rig.h"
#include "sim/vehicle/placement.h"
#include "sim/world/world_generator.h"

namespace {

using bevloc::sim::Conditions;

struct Options {
  uint64_t seed = 1;
  std::string out = "world.png";
  std::vector<double> pose;  ///< x, y (metres), yaw (degrees)
  uint64_t pose_seed = 1;
  double time_s = 0.0;
  bool network_size = false;
  bool random_conditions = false;
  bool night = false;
  Conditions conditions;
};

Options read_options(int argc, char** argv) {
  Options options;
  double sun_elevation_deg = 40.0;
  CLI::App app("Draws the six cameras of the simulated rig as one picture");
  app.add_option("--seed", options.seed, "Which world");
  app.add_option("--out", options.out, "PNG file to write");
  app.add_option("--pose", options.pose, "x y yaw: metres, degrees; else a place on a road")
      ->expected(3);
  app.add_option("--pose-seed", options.pose_seed, "Which place on a road");
  app.add_option("--time", options.time_s, "Seconds of simulated traffic");
  app.add_option("--sun-elevation", sun_elevation_deg, "Degrees");
  app.add_option("--overcast", options.conditions.overcast, "0 to 1");
  app.add_option("--rain", options.conditions.rain, "0 to 1");
  app.add_flag("--night", options.night, "The sun is down");
  app.add_flag("--random-conditions", options.random_conditions,
               "Light and weather from the pose seed");
  app.add_flag("--network-size", options.network_size, "Look through the network's cameras");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error));
  }
  options.conditions.sun_elevation_rad = bevloc::radians(options.night ? -30.0 : sun_elevation_deg);
  if (options.random_conditions) {
    options.conditions = bevloc::sim::random_conditions(options.pose_seed);
  }
  return options;
}

/// Two rows of three, in the order of kCameraNames.
cv::Mat contact_sheet(const std::vector<bevloc::RgbImage>& images) {
  constexpr int kGapPx = 4;
  const cv::Size cell(images[0].width + kGapPx, images[0].height + kGapPx);
  cv::Mat sheet(2 * cell.height - kGapPx, 3 * cell.width - kGapPx, CV_8UC3, cv::Scalar::all(255));
  for (int i = 0; i < bevloc::kCameraCount; ++i) {
    const bevloc::RgbImage& image = images[static_cast<size_t>(i)];
    const cv::Rect place((i % 3) * cell.width, (i / 3) * cell.height, image.width, image.height);
    // OpenCV's constructor wants a mutable pointer; the pixels are only read.
    const cv::Mat rgb(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.row(0)));
    cv::cvtColor(rgb, sheet(place), cv::COLOR_RGB2BGR);
  }
  return sheet;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = read_options(argc, argv);
  const bevloc::sim::World world = bevloc::sim::generate_world(options.seed);
  bevloc::sim::Random random(options.pose_seed);
  bevloc::Se2 pose = bevloc::sim::random_pose_on_road(world, random);
  if (!options.pose.empty()) {
    pose = {options.pose[0], options.pose[1], bevloc::radians(options.pose[2])};
  }
  bevloc::Rig rig = bevloc::sim::nominal_rig();
  if (options.network_size) rig = bevloc::network_rig(rig);

  bevloc::sim::Renderer renderer(world);
  std::vector<bevloc::RgbImage> images(bevloc::kCameraCount);
  for (size_t i = 0; i < images.size(); ++i) {
    renderer.render(rig.cameras[i], pose, {}, options.time_s, options.conditions, i, images[i]);
  }
  if (!cv::imwrite(options.out, contact_sheet(images))) {
    fmt::print(stderr, "{}: could not be written\n", options.out);
    return 1;
  }
  fmt::print("{}: world {}, pose x {:.2f} m, y {:.2f} m, yaw {:.1f} deg\n", options.out,
             options.seed, pose.x_m, pose.y_m, bevloc::degrees(pose.yaw_rad));
  return 0;
}
