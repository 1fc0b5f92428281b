#include "pipeline/map/formats/opendrive/road.h"

#include <algorithm>
#include <cmath>

namespace bevloc::opendrive {
namespace {

/// Integrates along a spiral and along the length of a cubic in pieces this long.
constexpr double kStep_m = 2.0;
constexpr double kMostSteps = 10'000.0;

/// Gauss-Legendre quadrature with three points of f from 0 to `end`.
template <typename Value, typename Function>
Value integral(double end, Value sum, Function f) {
  const double steps = std::clamp(std::ceil(std::abs(end) / kStep_m), 1.0, kMostSteps);
  const double half = 0.5 * end / steps;
  const double reach = half * std::sqrt(0.6);
  for (double i = 0.0; i < steps; i += 1.0) {
    const double middle = (2.0 * i + 1.0) * half;
    sum += half / 9.0 * (5.0 * f(middle - reach) + 8.0 * f(middle) + 5.0 * f(middle + reach));
  }
  return sum;
}

/// The pose in the frame of the start of the piece.
LinePose local_pose(const Geometry& geometry, double along_m) {
  const double c0 = geometry.start_curvature;
  switch (geometry.kind) {
    case Geometry::Kind::kLine:
      return {{along_m, 0.0}, 0.0};
    case Geometry::Kind::kArc: {
      const double angle = c0 * along_m;
      if (std::abs(c0) < 1e-12) return {{along_m, 0.0}, 0.0};
      return {{std::sin(angle) / c0, (1.0 - std::cos(angle)) / c0}, angle};
    }
    case Geometry::Kind::kSpiral: {
      const double rate =
          geometry.length_m > 0.0 ? (geometry.end_curvature - c0) / geometry.length_m : 0.0;
      const auto heading = [&](double at) { return at * (c0 + 0.5 * rate * at); };
      const Eigen::Vector2d position = integral(along_m, Eigen::Vector2d(0.0, 0.0), [&](double at) {
        return Eigen::Vector2d(std::cos(heading(at)), std::sin(heading(at)));
      });
      return {position, heading(along_m)};
    }
    case Geometry::Kind::kPoly3: {
      const auto slope = [&](double u) {
        return geometry.v.b + u * (2.0 * geometry.v.c + u * 3.0 * geometry.v.d);
      };
      // Newton's method: the length of the curve up to u is along_m.
      double u = along_m;
      for (int i = 0; i < 8; ++i) {
        const double length =
            integral(u, 0.0, [&](double at) { return std::hypot(1.0, slope(at)); });
        u -= (length - along_m) / std::hypot(1.0, slope(u));
      }
      return {{u, geometry.v.at(u)}, std::atan(slope(u))};
    }
    case Geometry::Kind::kParamPoly3: {
      const double scale =
          geometry.is_normalized && geometry.length_m > 0.0 ? 1.0 / geometry.length_m : 1.0;
      const double p = along_m * scale;
      const auto slope = [p](const Cubic& cubic) {
        return cubic.b + p * (2.0 * cubic.c + p * 3.0 * cubic.d);
      };
      return {{geometry.u.at(p), geometry.v.at(p)},
              std::atan2(slope(geometry.v), slope(geometry.u))};
    }
  }
  return {};
}

}  // namespace

double value_at(const Cubics& cubics, double s_m, double fallback) {
  const auto next = std::ranges::upper_bound(cubics, s_m, {}, &Cubic::start_m);
  return next == cubics.begin() ? fallback : std::prev(next)->at(s_m);
}

LinePose pose_along(const Geometry& geometry, double along_m) {
  LinePose local = local_pose(geometry, along_m);
  // Cubics that no road has may diverge.
  if (!local.position.allFinite() || !std::isfinite(local.heading_rad)) local = {};
  const double c = std::cos(geometry.heading_rad);
  const double s = std::sin(geometry.heading_rad);
  return {geometry.origin + Eigen::Vector2d(c * local.position.x() - s * local.position.y(),
                                            s * local.position.x() + c * local.position.y()),
          geometry.heading_rad + local.heading_rad};
}

LinePose Road::pose_at(double s_m) const {
  const auto next = std::ranges::upper_bound(geometries, s_m, {}, &Geometry::start_m);
  const Geometry& geometry = next == geometries.begin() ? *next : *std::prev(next);
  return pose_along(geometry, std::clamp(s_m - geometry.start_m, 0.0, geometry.length_m));
}

}  // namespace bevloc::opendrive
