// A street and a mask without errors, for tests of the baselines.
#pragma once

#include <cstdint>
#include <vector>

#include "common/se2.h"
#include "evaluation/baselines/baseline.h"
#include "pipeline/map/hd_map.h"
#include "pipeline/map/map_index.h"
#include "pipeline/map/rasterizer.h"
#include "sim/samples/sample_maker.h"

namespace bevloc::evaluation {

/// Two lane dividers and two kerbs with a slight bend, and a crossing.
inline HdMap street() {
  HdMap map;
  for (const double y_m : {-7.0, -2.0, 1.5, 6.5}) {
    const bool kerb = y_m < -5.0 || y_m > 5.0;
    MapElement line{
        .element_class = kerb ? ElementClass::kRoadBoundary : ElementClass::kLaneDivider,
        .appearance = Appearance::kUnknown,
        .points = {}};
    for (double x_m = -60.0; x_m <= 60.0; x_m += 1.0) {
      line.points.emplace_back(x_m, y_m + 0.002 * x_m * x_m);
    }
    map.elements.push_back(line);
  }
  map.elements.push_back({.element_class = ElementClass::kPedestrianCrossing,
                          .appearance = Appearance::kZebra,
                          .points = {{6.0, -6.5}, {9.0, -6.5}, {9.0, 6.0}, {6.0, 6.0}}});
  return map;
}

/// The mask of a network without errors, and the map at a prior pose.
struct StreetScene {
  explicit StreetScene(const Se2& correction)
      : perceived(kRasterSize), raster(kRasterSize), truth(kRasterSize) {
    const HdMap map = street();
    const MapIndex index(map);
    MapRasterizer rasterizer(index);
    rasterizer.draw(map_from_vehicle, truth);
    rasterizer.draw(map_from_vehicle * correction.inverse(), raster);
    for (size_t i = 0; i < truth.size(); ++i) {
      perceived[i] = static_cast<float>(truth[i]) / 255.0F;
    }
  }

  BaselineInput input() const {
    return {.images = {}, .cameras = {}, .rig = rig, .perceived = perceived, .raster = raster};
  }

  Rig rig = sim::nominal_network_rig();
  Se2 map_from_vehicle{0.4, -0.3, radians(3.0)};
  std::vector<float> perceived;
  std::vector<uint8_t> raster;
  std::vector<uint8_t> truth;
};

}  // namespace bevloc::evaluation
