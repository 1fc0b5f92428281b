#include "evaluation/baselines/distance_transform.h"

#include <vector>

#include "evaluation/baselines/field_alignment.h"

namespace bevloc::evaluation {

Se2 DistanceTransformAlignment::correct(const BaselineInput& input) {
  const ClassLines perceived = lines_of_mask(input.perceived);
  const ClassLines map = lines_of_raster(input.raster);
  std::vector<PointsOnField> pairs;
  for (size_t k = 0; k < map.size(); ++k) {
    pairs.push_back({inside_for_all(perceived[k], ranges_), DistanceField(map[k])});
  }
  return align(pairs, ranges_);
}

}  // namespace bevloc::evaluation
