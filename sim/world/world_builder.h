// Collects the parts of a world and decides which of them the map contains.
#pragma once

#include <array>
#include <vector>

#include "sim/random.h"
#include "sim/world/path.h"
#include "sim/world/town_style.h"

namespace bevloc::sim {

/// Drawing order of surfaces: a later layer covers an earlier one.
enum class Layer : uint8_t { kVerge, kSidewalk, kDriveway, kCarriageway, kPatch, kIsland };
inline constexpr size_t kLayers = 6;

inline constexpr Rgb kWhitePaint{0.78F, 0.78F, 0.76F};
inline constexpr Rgb kHedgeGreen{0.12F, 0.25F, 0.08F};

/// Builds a World. With the chances and errors of the TownStyle, a map element may be missing, lie
/// beside its paint, or have no paint at all. One thread.
class WorldBuilder {
 public:
  /// `town` and `random` must outlive the builder.
  WorldBuilder(const TownStyle& town, Random& random) : town_(town), random_(random) {}

  const TownStyle& town() const { return town_; }
  Random& random() { return random_; }
  World& world() { return world_; }

  void add_surface(Layer layer, Ring ring, GroundMaterial material, float brightness = 1.0F);

  /// Adds a lane divider: paint and map element.
  void add_divider(const Polyline& line, const DividerPaint& paint, float wear);
  /// Adds the outer line of a carriageway: paint, and in a few towns also a map element.
  void add_edge_line(const Polyline& line, double width_m, const Rgb& albedo, float wear);
  void add_paint_area(Ring ring, const Rgb& albedo, float wear);
  /// Adds a pedestrian crossing with four or more corners: paint and map element.
  void add_crossing(const Ring& ring, Appearance appearance, float wear);
  /// Adds a road boundary: the wall that stands there and the map element.
  void add_boundary(const Polyline& line, const EdgeStyle& edge);
  /// Adds a road boundary to the map alone, without a wall.
  void add_map_boundary(const Polyline& line, Appearance appearance);

  // These add the visible parts alone, without map elements. They serve to dress an imported map.
  void paint_divider(const Polyline& line, const DividerPaint& paint, float wear);
  void paint_crossing(const Ring& ring, Appearance appearance, float wear);
  void build_boundary(const Polyline& line, const EdgeStyle& edge);

  /// Adds a wall that the map does not contain.
  void add_wall(const Polyline& base, WallTexture texture, double bottom_m, double top_m,
                const Rgb& albedo);

  /// The roads, sidewalks and driveways, where no scenery may stand. The pointers are valid until
  /// the next surface is added.
  std::vector<const Ring*> paved_rings() const;

  /// Returns the world with its surfaces in drawing order. The builder is empty afterwards.
  World finish();

 private:
  void add_element(ElementClass element_class, Appearance appearance, const Polyline& points);
  /// Adds a wall of random height and shade, both between the two values given.
  void add_grey_wall(const Polyline& base, WallTexture texture, std::array<double, 2> top_m,
                     std::array<double, 2> shade);
  /// The wear with a random variation.
  float varied(float wear);

  const TownStyle& town_;
  Random& random_;
  World world_;
  std::array<std::vector<Surface>, kLayers> layers_;
};

}  // namespace bevloc::sim
