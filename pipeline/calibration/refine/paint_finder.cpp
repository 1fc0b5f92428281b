#include "pipeline/calibration/refine/paint_finder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/median.h"

namespace bevloc {
namespace {

constexpr double kStep_px = 0.5;  // between two samples of a profile
constexpr double kThinnest_px = 1.0;
constexpr double kSightingSpacing_px = 6.0;  // least distance of two sightings of one element
constexpr size_t kMostSightings = 120;       // per image; more are thinned out evenly
constexpr double kPaint_m = 0.12;
constexpr double kNarrowest_m = 0.06;
constexpr double kWidest_m = 0.30;
constexpr double kBlur_px = 1.5;  // blur of the edges of a stripe
/// The two sides of a stripe differ at most by this share of its contrast. The road is equally dark
/// on both sides of a line. A bright kerb has the road on one side only.
constexpr double kSidesDiffer = 0.4;
constexpr float kLeastSlope = 2.5F;  // grey levels per pixel
constexpr float kOverNoise = 4.0F;
constexpr float kWeakest = 0.5F;  // share of the strongest candidate

struct Edge {
  double offset_px;
  float slope;  ///< grey levels per pixel, positive: brighter along the normal
};

/// A camera at one moment.
class GroundView {
 public:
  GroundView(const CameraModel& camera, const Se2& vehicle_from_map)
      : camera_(camera),
        camera_from_vehicle_(camera.vehicle_from_camera.inverse()),
        vehicle_from_map_(vehicle_from_map) {}

  std::optional<Eigen::Vector2d> project(const Eigen::Vector2d& point_m) const {
    const Eigen::Vector2d at = vehicle_from_map_ * point_m;
    return camera_.intrinsics.project(camera_from_vehicle_ * Eigen::Vector3d(at.x(), at.y(), 0.0));
  }

  /// Returns nothing if the camera does not see the line wide enough.
  std::optional<PaintSighting> look_at(const PaintPoint& point) const {
    constexpr double kApart_m = 0.05;
    const auto here = project(point.point_m);
    const auto ahead = project(point.point_m + kApart_m * point.along);
    const auto beside = project(point.point_m + kApart_m * point.across);
    if (!here || !ahead || !beside || camera_.shows_own_body(*here)) return std::nullopt;
    PaintSighting sighting;
    sighting.point_m = point.point_m;
    sighting.element = point.element;
    sighting.predicted_px = *here;
    const Eigen::Vector2d tangent = (*ahead - *here).normalized();
    sighting.normal_px = {-tangent.y(), tangent.x()};
    sighting.pixels_per_m = sighting.normal_px.dot(*beside - *here) / kApart_m;
    if (sighting.pixels_per_m < 0.0) {
      sighting.pixels_per_m = -sighting.pixels_per_m;
      sighting.normal_px = -sighting.normal_px;
    }
    if (!(sighting.pixels_per_m * kPaint_m >= kThinnest_px)) return std::nullopt;
    return sighting;
  }

 private:
  const CameraModel& camera_;
  Se3 camera_from_vehicle_;
  Se2 vehicle_from_map_;
};

/// Looks for edges across a line.
class ProfileReader {
 public:
  ProfileReader(const GreyImage& image, double reach_px) : image_(image), reach_px_(reach_px) {}

  /// Returns false if the profile leaves the image.
  bool read(const PaintSighting& sighting) {
    constexpr int kAlong = 2;           // neighbours to either side, 1 px apart
    constexpr double kAround_px = 6.0;  // asphalt beyond the paint, to tell paint from noise
    half_ = static_cast<int>(
        std::ceil((reach_px_ + kAround_px + 0.5 * kWidest_m * sighting.pixels_per_m) / kStep_px));
    const Eigen::Vector2d tangent(sighting.normal_px.y(), -sighting.normal_px.x());
    profile_.clear();
    for (int i = -half_ - kMargin; i <= half_ + kMargin; ++i) {
      const Eigen::Vector2d at = sighting.predicted_px + i * kStep_px * sighting.normal_px;
      float sum = 0.0F;
      for (int k = -kAlong; k <= kAlong; ++k) {
        const Eigen::Vector2d p = at + k * tangent;
        if (!image_.contains(p.x(), p.y())) return false;
        sum += image_.at(p.x(), p.y());
      }
      profile_.push_back(sum / (2 * kAlong + 1));
    }
    find_edges();
    return true;
  }

  const std::vector<Edge>& edges() const { return edges_; }

  /// The mean grey level between two offsets.
  float level(double from_px, double to_px) const {
    const size_t first = index_of(from_px);
    const size_t last = std::max(first, index_of(to_px));
    float sum = 0.0F;
    for (size_t i = first; i <= last; ++i) sum += profile_[i];
    return sum / static_cast<float>(last - first + 1);
  }

 private:
  size_t index_of(double offset_px) const {
    const auto index = std::lround(offset_px / kStep_px) + half_ + kMargin;
    return static_cast<size_t>(std::clamp(index, 0L, static_cast<long>(profile_.size()) - 1));
  }

  /// The slope over two steps of the smoothed profile, and its local extrema.
  void find_edges() {
    slopes_.clear();
    for (size_t i = kMargin; i + kMargin < profile_.size(); ++i) {
      const auto smooth = [&](size_t k) {
        return 0.25F * profile_[k - 1] + 0.5F * profile_[k] + 0.25F * profile_[k + 1];
      };
      slopes_.push_back((smooth(i + 1) - smooth(i - 1)) / static_cast<float>(2 * kStep_px));
    }
    magnitudes_.assign(slopes_.begin(), slopes_.end());
    for (float& value : magnitudes_) value = std::abs(value);
    const float least = std::max(kLeastSlope, kOverNoise * median(magnitudes_));
    edges_.clear();
    for (size_t i = 1; i + 1 < slopes_.size(); ++i) {
      const float sign = slopes_[i] > 0.0F ? 1.0F : -1.0F;
      const float a = sign * slopes_[i - 1];
      const float b = sign * slopes_[i];
      const float c = sign * slopes_[i + 1];
      if (b < least || b < a || b <= c) continue;
      const double peak = 0.5 * (a - c) / (a - 2.0F * b + c);
      edges_.push_back({(static_cast<double>(i) + peak - half_) * kStep_px, sign * b});
    }
  }

  static constexpr int kMargin = 3;  // samples at each end, which only smoothing uses

  const GreyImage& image_;
  const double reach_px_;
  int half_ = 0;
  std::vector<float> profile_;
  std::vector<float> slopes_;
  std::vector<float> magnitudes_;
  std::vector<Edge> edges_;
};

void keep_strongest(std::vector<Edge>& found, double reach_px, PaintSighting& sighting) {
  std::erase_if(found, [=](const Edge& edge) { return std::abs(edge.offset_px) > reach_px; });
  std::ranges::sort(found, std::greater<>(), &Edge::slope);
  for (const Edge& edge : found) {
    if (sighting.candidates == PaintSighting::kMostCandidates) break;
    if (edge.slope < kWeakest * found.front().slope) break;
    sighting.offset_px[static_cast<size_t>(sighting.candidates++)] = edge.offset_px;
  }
}

bool sides_are_alike(const ProfileReader& profile, double rise_px, double fall_px,
                     double pixels_per_m) {
  constexpr double kSide_m = 0.08;
  constexpr double kLeastSide_px = 2.5;
  const double side_px = std::max(kLeastSide_px, kSide_m * pixels_per_m);
  const double inset_px = 0.3 * (fall_px - rise_px);
  const float left = profile.level(rise_px - kBlur_px - side_px, rise_px - kBlur_px);
  const float right = profile.level(fall_px + kBlur_px, fall_px + kBlur_px + side_px);
  const float contrast =
      profile.level(rise_px + inset_px, fall_px - inset_px) - 0.5F * (left + right);
  return std::abs(left - right) <= kSidesDiffer * contrast;
}

/// Finds the middles between a rising edge and the next falling edge.
void find_stripes(const ProfileReader& profile, double reach_px, PaintSighting& sighting) {
  std::vector<Edge> found;
  const std::vector<Edge>& edges = profile.edges();
  const double widest_px = std::hypot(kWidest_m * sighting.pixels_per_m, kBlur_px);
  for (size_t i = 0; i + 1 < edges.size(); ++i) {
    const Edge& rise = edges[i];
    const Edge& fall = edges[i + 1];
    if (rise.slope < 0.0F || fall.slope > 0.0F) continue;
    const double width_px = fall.offset_px - rise.offset_px;
    if (width_px < kNarrowest_m * sighting.pixels_per_m || width_px > widest_px) continue;
    if (!sides_are_alike(profile, rise.offset_px, fall.offset_px, sighting.pixels_per_m)) continue;
    found.push_back({0.5 * (rise.offset_px + fall.offset_px), std::min(rise.slope, -fall.slope)});
  }
  keep_strongest(found, reach_px, sighting);
}

void find_steps(const std::vector<Edge>& edges, double reach_px, PaintSighting& sighting) {
  std::vector<Edge> found;
  std::ranges::copy_if(edges, std::back_inserter(found),
                       [](const Edge& edge) { return edge.slope > 0.0F; });
  keep_strongest(found, reach_px, sighting);
}

}  // namespace

std::vector<PaintSighting> find_paint(const GreyImage& image, const CameraModel& camera,
                                      const Se2& vehicle_from_map,
                                      std::span<const PaintPoint> points, double reach_px) {
  const GroundView view(camera, vehicle_from_map);
  ProfileReader reader(image, reach_px);
  std::vector<PaintSighting> sightings;
  std::vector<PaintKind> kinds;
  uint32_t last_element = std::numeric_limits<uint32_t>::max();
  for (const PaintPoint& point : points) {
    const auto sighting = view.look_at(point);
    if (!sighting || !image.contains(sighting->predicted_px.x(), sighting->predicted_px.y())) {
      continue;
    }
    const bool near_last =
        last_element == point.element && !sightings.empty() &&
        (sighting->predicted_px - sightings.back().predicted_px).norm() < kSightingSpacing_px;
    if (near_last) continue;
    last_element = point.element;
    sightings.push_back(*sighting);
    kinds.push_back(point.kind);
  }
  const size_t every = 1 + sightings.size() / kMostSightings;
  std::vector<PaintSighting> result;
  for (size_t i = 0; i < sightings.size(); i += every) {
    if (!reader.read(sightings[i])) continue;
    if (kinds[i] == PaintKind::kStripe) {
      find_stripes(reader, reach_px, sightings[i]);
    } else {
      find_steps(reader.edges(), reach_px, sightings[i]);
    }
    result.push_back(sightings[i]);
  }
  return result;
}

}  // namespace bevloc
