// bevloc_draw_world: draws a simulated world and its map from above, as a PNG.
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <opencv2/imgproc.hpp>

#include "common/option_checks.h"
#include "common/picture_file.h"
#include "pipeline/map/map_loader.h"
#include "pipeline/map/map_points.h"
#include "sim/world/path.h"
#include "sim/world/world_generator.h"

namespace {

using namespace bevloc;
using namespace bevloc::sim;

constexpr int kSubpixelBits = 4;

cv::Scalar bgr(const Rgb& colour) {
  return {255.0 * colour.b, 255.0 * colour.g, 255.0 * colour.r};
}

cv::Scalar ground_colour(GroundMaterial material, double brightness) {
  const auto shade = [brightness](double r, double g, double b) {
    return brightness * cv::Scalar(b, g, r);
  };
  switch (material) {
    case GroundMaterial::kAsphalt:
      return shade(85, 85, 88);
    case GroundMaterial::kConcrete:
      return shade(140, 138, 132);
    case GroundMaterial::kPaving:
      return shade(150, 140, 130);
    case GroundMaterial::kGrass:
      return shade(95, 125, 70);
    case GroundMaterial::kDirt:
      return shade(125, 105, 80);
    case GroundMaterial::kGravel:
      return shade(135, 130, 120);
  }
  return {};
}

class Drawing {
 public:
  Drawing(const Eigen::Vector2d& centre, double size_m, int pixels)
      : scale_(pixels / size_m),
        min_corner_(centre - Eigen::Vector2d::Constant(0.5 * size_m)),
        image_(pixels, pixels, CV_8UC3) {}

  void draw(const World& world, double seconds, bool with_map) {
    image_.setTo(ground_colour(world.background, 0.9));
    for (const Surface& surface : world.surfaces) {
      fill(surface.ring, ground_colour(surface.material, surface.brightness));
    }
    for (const PaintLine& line : world.paint_lines) draw_paint(line);
    for (const PaintArea& area : world.paint_areas) fill(area.ring, faded(area.albedo, area.wear));
    for (const Wall& wall : world.walls) {
      const bool kerb = wall.top_m < 0.3;
      stroke(wall.base, kerb ? 0.15 : 0.4, kerb ? cv::Scalar(60, 60, 60) : bgr(wall.albedo));
    }
    for (const VehicleBody& body : world.parked) draw_vehicle(body);
    for (const VehicleBody& body : traffic_at(world.traffic, seconds)) draw_vehicle(body);
    for (const Post& post : world.posts) draw_post(post);
    if (with_map) draw_map(world.map);
  }

  Status save(const std::string& path) const {
    cv::Mat upright;
    cv::flip(image_, upright, 0);
    return write_picture(upright, path);
  }

 private:
  std::vector<cv::Point> pixels(const Polyline& line) const {
    std::vector<cv::Point> points;
    for (const Eigen::Vector2d& p : line) {
      const Eigen::Vector2d q = (p - min_corner_) * scale_ * (1 << kSubpixelBits);
      points.emplace_back(static_cast<int>(std::lround(q.x())),
                          static_cast<int>(std::lround(q.y())));
    }
    return points;
  }

  void fill(const Ring& ring, const cv::Scalar& colour) {
    const std::vector<std::vector<cv::Point>> rings{pixels(ring)};
    cv::fillPoly(image_, rings, colour, cv::LINE_AA, kSubpixelBits);
  }

  void stroke(const Polyline& line, double width_m, const cv::Scalar& colour, bool closed = false) {
    const int width = std::max(1, static_cast<int>(std::lround(width_m * scale_)));
    const std::vector<std::vector<cv::Point>> lines{pixels(line)};
    cv::polylines(image_, lines, closed, colour, width, cv::LINE_AA, kSubpixelBits);
  }

  static cv::Scalar faded(const Rgb& albedo, float wear) {
    return (1.0 - wear) * bgr(albedo) + wear * cv::Scalar(90, 88, 88);
  }

  void draw_paint(const PaintLine& line) {
    const cv::Scalar colour = faded(line.albedo, line.wear);
    if (line.dash_m <= 0.0) {
      stroke(line.points, line.width_m, colour);
      return;
    }
    const Path path(line.points);
    const double period_m = line.dash_m + line.gap_m;
    for (double s = -std::fmod(line.phase_m, period_m); s < path.length_m(); s += period_m) {
      const double from_m = std::max(0.0, s);
      const double to_m = std::min(path.length_m(), s + line.dash_m);
      if (to_m > from_m) stroke(path.parallel(from_m, to_m, 0.0), line.width_m, colour);
    }
  }

  void draw_vehicle(const VehicleBody& body) {
    const Eigen::Vector2d forward = 0.5 * body.length_m * unit_vector(body.yaw_rad);
    const Eigen::Vector2d left = 0.5 * body.width_m * left_of(unit_vector(body.yaw_rad));
    fill({body.centre + forward + left, body.centre + forward - left, body.centre - forward - left,
          body.centre - forward + left},
         bgr(body.albedo));
    fill({body.centre + 0.5 * forward + 0.8 * left, body.centre + 0.5 * forward - 0.8 * left,
          body.centre + 0.25 * forward - 0.8 * left, body.centre + 0.25 * forward + 0.8 * left},
         cv::Scalar(50, 40, 30));
  }

  void draw_post(const Post& post) {
    const std::vector<cv::Point> centre = pixels({post.position});
    const int radius = static_cast<int>(post.radius_m * scale_ * (1 << kSubpixelBits));
    const bool outline = post.kind == PostKind::kTreeCrown;
    cv::circle(image_, centre[0], radius, bgr(post.albedo), outline ? 1 : cv::FILLED, cv::LINE_AA,
               kSubpixelBits);
  }

  void draw_map(const HdMap& map) {
    for (const Lane& lane : map.lanes) stroke(lane.centerline, 0.1, {160, 160, 0});
    for (const MapElement& element : map.elements) {
      switch (element.element_class) {
        case ElementClass::kLaneDivider:
          stroke(element.points, 0.2, {0, 160, 255});
          break;
        case ElementClass::kPedestrianCrossing:
          stroke(element.points, 0.2, {255, 80, 60}, true);
          break;
        case ElementClass::kRoadBoundary:
          stroke(element.points, 0.2, {40, 40, 230});
          break;
      }
    }
  }

  double scale_;
  Eigen::Vector2d min_corner_;
  cv::Mat image_;
};

struct Square {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double size_m = 100.0;
};

/// The square that contains the whole map.
Square square_around(const HdMap& map) {
  constexpr double kMargin_m = 25.0;
  const Eigen::AlignedBox2d bounds = bounds_of(map);
  if (bounds.isEmpty()) return {};
  return {bounds.center(), bounds.sizes().maxCoeff() + 2.0 * kMargin_m};
}

struct Options {
  uint64_t seed = 1;
  std::string map_file;
  std::string output = "world.png";
  std::optional<double> east_m;
  std::optional<double> north_m;
  std::optional<double> size_m;
  double seconds = 0.0;
  int image_size = 1600;
  bool without_map = false;
};

void add_options(CLI::App& app, Options& options) {
  constexpr double kFarthest_m = 1e6;
  app.add_option("seed", options.seed, "Seed of the town")
      ->check(whole_number())
      ->capture_default_str();
  app.add_option("output", options.output, "PNG to write")
      ->check(output_file())
      ->capture_default_str();
  app.add_option("--map", options.map_file,
                 "Draw a world dressed on this map instead of a generated town")
      ->check(bevloc::is_name_of("a map"));
  app.add_option("--east", options.east_m, "Centre of the image, metres east of the map's origin")
      ->check(number_between(-kFarthest_m, kFarthest_m));
  app.add_option("--north", options.north_m,
                 "Centre of the image, metres north of the map's origin")
      ->check(number_between(-kFarthest_m, kFarthest_m));
  app.add_option("--size", options.size_m, "Width of the image in metres (default: the whole map)")
      ->check(number_between(1.0, kFarthest_m));
  app.add_option("--pixels", options.image_size, "Width of the image in pixels")
      ->check(CLI::Range(16, 16'384))
      ->capture_default_str();
  app.add_option("--time", options.seconds, "Time of the simulated traffic in seconds")
      ->check(number_between(0.0, 1e6));
  app.add_flag("--no-map", options.without_map, "Do not draw the map");
}

Status draw(const Options& options) {
  World world;
  if (options.map_file.empty()) {
    world = generate_world(options.seed);
  } else {
    const Result<HdMap> map = load_map(options.map_file);
    if (!map) return tl::unexpected(map.error());
    world = world_from_map(*map, options.seed);
  }
  const Square whole = square_around(world.map);
  const Eigen::Vector2d centre(options.east_m.value_or(whole.centre.x()),
                               options.north_m.value_or(whole.centre.y()));
  Drawing drawing(centre, options.size_m.value_or(whole.size_m), options.image_size);
  drawing.draw(world, options.seconds, !options.without_map);
  return drawing.save(options.output);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Draws a simulated world from above (roads, paint, walls, vehicles) with its HD map on top: "
      "dividers orange, crossings blue, boundaries red, lanes teal.");
  Options options;
  add_options(app, options);
  if (const auto ended = parse_options(app, argc, argv)) return *ended;
  if (const Status drawn = draw(options); !drawn) {
    std::fprintf(stderr, "%s\n", drawn.error().message.c_str());
    return kBadInput;
  }
  return 0;
}
