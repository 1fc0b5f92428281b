#include "evaluation/maps/map_diff.h"

#include <algorithm>
#include <cmath>

#include <GeographicLib/LocalCartesian.hpp>
#include <fmt/format.h>

#include "pipeline/map/class_names.h"
#include "pipeline/map/line_neighbours.h"
#include "pipeline/map/map_check.h"
#include "pipeline/map/tangent_plane.h"

namespace bevloc::evaluation {
namespace {

constexpr double kPiece_m = 1.0;

/// The elements of `map` in the frame of `other`.
std::vector<MapElement> moved_elements(const HdMap& map, const HdMap& other) {
  std::vector<MapElement> elements = map.elements;
  if (!is_known(map.origin) || !is_known(other.origin)) return elements;
  const GeographicLib::LocalCartesian from(map.origin.latitude_deg, map.origin.longitude_deg);
  const GeographicLib::LocalCartesian to(other.origin.latitude_deg, other.origin.longitude_deg);
  for (MapElement& element : elements) {
    for (Eigen::Vector2d& point : element.points) {
      point = point_of(to, place_of(from, point));
    }
  }
  return elements;
}

/// Calls visit(from, to) for all pieces of an element.
template <typename Visit>
void for_each_piece(const MapElement& element, Visit visit) {
  for (size_t i = 0; i < segment_count(element); ++i) {
    const Eigen::Vector2d& from = element.points[i];
    const Eigen::Vector2d along = segment_end(element, i) - from;
    const int pieces = std::max(1, static_cast<int>(std::ceil(along.norm() / kPiece_m)));
    for (int piece = 0; piece < pieces; ++piece) {
      visit(Eigen::Vector2d(from + along * piece / pieces),
            Eigen::Vector2d(from + along * (piece + 1) / pieces));
    }
  }
}

using OfClasses = std::array<LineNeighbours, kElementClasses>;

void add_lines(const std::vector<MapElement>& elements, OfClasses& lines) {
  for (const MapElement& element : elements) {
    for_each_piece(element, [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
      lines[static_cast<size_t>(element.element_class)].add(0, {from, to});
    });
  }
}

}  // namespace

Status check_near(const HdMap& first, const HdMap& second) {
  if (!is_known(first.origin) || !is_known(second.origin)) return {};
  const GeographicLib::LocalCartesian plane(first.origin.latitude_deg, first.origin.longitude_deg);
  Eigen::Vector3d other;
  plane.Forward(second.origin.latitude_deg, second.origin.longitude_deg, 0.0, other.x(), other.y(),
                other.z());
  const double apart_m = other.norm();
  if (apart_m <= kFarthestFromOriginM) return {};
  return fail(
      "found maps whose origins are {:.0f} km apart, wanted at most {:.0f} km; look for a wrong "
      "origin with `bevloc map info`",
      apart_m / 1000.0, kFarthestFromOriginM / 1000.0);
}

MapDiff compare(const HdMap& first, const HdMap& second) {
  const std::vector<MapElement> moved = moved_elements(second, first);
  OfClasses of_first, of_second;
  add_lines(first.elements, of_first);
  add_lines(moved, of_second);
  MapDiff diff;
  const auto look = [&diff](const std::vector<MapElement>& elements, const OfClasses& other,
                            double MapDiff::OfClass::*all, double MapDiff::OfClass::*only,
                            MapDiff::Piece::In in) {
    for (const MapElement& element : elements) {
      const auto index = static_cast<size_t>(element.element_class);
      MapDiff::OfClass& of_class = diff.classes[index];
      for_each_piece(element, [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
        const double length_m = (to - from).norm();
        const auto any = [](int64_t) { return true; };
        const bool is_in_both = other[index].share_beside({from, to}, kSamePlace_m, any) >= 0.5;
        of_class.*all += length_m;
        if (!is_in_both) of_class.*only += length_m;
        if (is_in_both && in == MapDiff::Piece::In::kOnlySecond) return;
        diff.pieces.push_back({from, to, is_in_both ? MapDiff::Piece::In::kBoth : in});
      });
    }
  };
  look(first.elements, of_second, &MapDiff::OfClass::first_m, &MapDiff::OfClass::only_first_m,
       MapDiff::Piece::In::kOnlyFirst);
  look(moved, of_first, &MapDiff::OfClass::second_m, &MapDiff::OfClass::only_second_m,
       MapDiff::Piece::In::kOnlySecond);
  return diff;
}

std::string text_of(const MapDiff& diff) {
  std::string text = fmt::format("{:<22} {:>11} {:>11} {:>13} {:>13}\n", "", "first", "second",
                                 "only in first", "only in second");
  for (size_t c = 0; c < kElementClasses; ++c) {
    const MapDiff::OfClass& of_class = diff.classes[c];
    text += fmt::format("{:<22} {:9.1f} m {:9.1f} m {:11.1f} m {:11.1f} m\n",
                        name_of(static_cast<ElementClass>(c)), of_class.first_m, of_class.second_m,
                        of_class.only_first_m, of_class.only_second_m);
  }
  return text;
}

nlohmann::json json_of(const MapDiff& diff) {
  nlohmann::json json;
  for (size_t c = 0; c < kElementClasses; ++c) {
    const MapDiff::OfClass& of_class = diff.classes[c];
    json[std::string(name_of(static_cast<ElementClass>(c)))] = {
        {"first_m", of_class.first_m},
        {"second_m", of_class.second_m},
        {"only_first_m", of_class.only_first_m},
        {"only_second_m", of_class.only_second_m}};
  }
  return json;
}

}  // namespace bevloc::evaluation
