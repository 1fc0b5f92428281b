// Collects a world's parts, and decides what of them the map knows.
#pragma once

#include <array>
#include <vector>

#include "sim/random.h"
#include "sim/world/path.h"
#include "sim/world/town_style.h"

namespace bevloc::sim {

/// Surfaces of a later layer cover those of an earlier one.
enum class Layer : uint8_t { kVerge, kSidewalk, kDriveway, kCarriageway, kPatch, kIsland };
inline constexpr size_t kLayers = 6;

class WorldBuilder {
 public:
  /// Keeps references to both.
  WorldBuilder(const TownStyle& town, Random& random) : town_(town), random_(random) {}

  const TownStyle& town() const { return town_; }
  Random& random() { return random_; }
  World& world() { return world_; }

  void add_surface(Layer layer, Ring ring, GroundMaterial material, float brightness = 1.0F);

  /// A lane divider: paint and map element.
  void add_divider(const Polyline& line, const DividerPaint& paint, float wear);
  /// The outer line of a carriageway: paint, and in few towns a map element.
  void add_edge_line(const Polyline& line, double width_m, const Rgb& albedo, float wear);
  void add_paint_area(Ring ring, const Rgb& albedo, float wear);
  /// A crossing over a ring of four or more corners: paint and map element.
  void add_crossing(const Ring& ring, Appearance appearance, float wear);
  /// A road boundary: what stands there and the map element.
  void add_boundary(const Polyline& line, const EdgeStyle& edge);
  /// A boundary of the map with nothing to be seen but a change of the ground.
  void add_map_boundary(const Polyline& line, Appearance appearance);
  // The visible halves of the above: for a map that is given.
  void paint_divider(const Polyline& line, const DividerPaint& paint, float wear);
  void paint_crossing(const Ring& ring, Appearance appearance, float wear);
  void build_boundary(const Polyline& line, const EdgeStyle& edge);

  /// A wall of any kind that the map does not know.
  void add_wall(const Polyline& base, WallTexture texture, double bottom_m, double top_m,
                const Rgb& albedo);

  /// What the scenery must keep off: roads, sidewalks, driveways. The pointers hold until a surface
  /// is added.
  std::vector<const Ring*> paved_rings() const;

  /// The world with its surfaces in painter's order. The builder is empty afterwards.
  World finish();

 private:
  void add_element(ElementClass element_class, Appearance appearance, const Polyline& points);
  float varied(float wear);

  const TownStyle& town_;
  Random& random_;
  World world_;
  std::array<std::vector<Surface>, kLayers> layers_;
};

}  // namespace bevloc::sim
