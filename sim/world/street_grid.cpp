#include "sim/world/street_grid.h"

#include <algorithm>
#include <numeric>

namespace bevloc::sim {
namespace {

/// A graph of straight streets.
struct Plan {
  std::vector<Eigen::Vector2d> nodes;
  std::vector<std::pair<size_t, size_t>> edges;

  std::vector<int> degrees() const {
    std::vector<int> degree(nodes.size(), 0);
    for (const auto& [a, b] : edges) {
      ++degree[a];
      ++degree[b];
    }
    return degree;
  }

  bool connected() const {
    std::vector<size_t> root(nodes.size());
    std::iota(root.begin(), root.end(), 0U);
    const auto find = [&](size_t i) {
      while (root[i] != i) i = root[i];
      return i;
    };
    size_t parts = nodes.size();
    for (const auto& [a, b] : edges) {
      const size_t ra = find(a);
      const size_t rb = find(b);
      if (ra == rb) continue;
      root[ra] = rb;
      --parts;
    }
    return parts == 1;
  }
};

/// A rotated, sheared grid with jittered nodes.
Plan jittered_grid(Random& random) {
  const int columns = random.integer(3, 5);
  const int rows = columns == 5 ? 3 : random.integer(3, 4);
  const double spacing_x = random.uniform(85.0, 150.0);
  const double spacing_y = random.uniform(85.0, 150.0);
  const double turn = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double shear = random.uniform(-0.2, 0.2);
  const double jitter = random.uniform(0.02, 0.12) * std::min(spacing_x, spacing_y);
  const Eigen::Vector2d along = unit_vector(turn);
  const Eigen::Vector2d across = unit_vector(turn + std::numbers::pi / 2.0) + shear * along;

  Plan plan;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = (column - 0.5 * (columns - 1)) * spacing_x + random.normal(0.0, jitter);
      const double y = (row - 0.5 * (rows - 1)) * spacing_y + random.normal(0.0, jitter);
      plan.nodes.emplace_back(x * along + y * across);
      const auto node = plan.nodes.size() - 1;
      if (column > 0) plan.edges.emplace_back(node - 1, node);
      if (row > 0) plan.edges.emplace_back(node - static_cast<size_t>(columns), node);
    }
  }
  return plan;
}

/// Removes random streets, but creates no dead end and keeps the plan connected.
void thin_out(Plan& plan, Random& random) {
  const auto wanted =
      static_cast<int>(random.uniform(0.0, 0.25) * static_cast<double>(plan.edges.size()));
  for (int i = 0; i < wanted && plan.edges.size() > plan.nodes.size() + 3; ++i) {
    const int last = static_cast<int>(plan.edges.size()) - 1;
    const auto victim = plan.edges.begin() + random.integer(0, last);
    const std::vector<int> degree = plan.degrees();
    if (degree[victim->first] < 3 || degree[victim->second] < 3) continue;
    Plan rest = plan;
    rest.edges.erase(rest.edges.begin() + (victim - plan.edges.begin()));
    if (rest.connected()) plan = std::move(rest);
  }
}

/// Bends some straight streets by waypoints beside them. A street next to a corner of the grid is
/// bent only if it is long, because the arc of the corner needs its length.
Polyline bent(const Polyline& corners, Random& random) {
  Polyline waypoints{corners.front()};
  for (size_t i = 1; i < corners.size(); ++i) {
    const Eigen::Vector2d chord = corners[i] - corners[i - 1];
    const Eigen::Vector2d side = left_of(chord.normalized());
    const double draw = random.uniform();
    const double swing = random.uniform(4.0, 14.0) * (random.chance(0.5) ? 1.0 : -1.0);
    const bool between_junctions = corners.size() == 2;
    if (draw < 0.35 && (between_junctions || chord.norm() > 125.0)) {
      waypoints.emplace_back(corners[i - 1] + 0.5 * chord + swing * side);
    } else if (draw < 0.5 && between_junctions) {
      waypoints.emplace_back(corners[i - 1] + 0.35 * chord + 0.5 * swing * side);
      waypoints.emplace_back(corners[i - 1] + 0.65 * chord - 0.5 * swing * side);
    }
    waypoints.push_back(corners[i]);
  }
  return waypoints;
}

/// Rounds the waypoints with arcs of random radius, limited by the available length.
Polyline street_line(const Polyline& corners, Random& random) {
  const Polyline waypoints = bent(corners, random);
  std::vector<double> tangent_m(waypoints.size(), 0.0);
  for (size_t i = 1; i + 1 < waypoints.size(); ++i) {
    const Eigen::Vector2d before = waypoints[i] - waypoints[i - 1];
    const Eigen::Vector2d after = waypoints[i + 1] - waypoints[i];
    const double turn = std::abs(std::atan2(cross(before, after), before.dot(after)));
    const double radius = random.uniform(30.0, 60.0) / std::max(0.4, turn);
    const double room = 0.46 * std::min(before.norm(), after.norm());
    tangent_m[i] = std::min(room, radius * std::tan(0.5 * turn));
  }
  return rounded(waypoints, tangent_m);
}

/// Follows a street from a junction to the next one. Nodes where only two streets meet are bends.
std::vector<size_t> chain_from(const Plan& plan, const std::vector<int>& degree, size_t edge,
                               size_t start, std::vector<bool>& used) {
  std::vector<size_t> chain{start};
  while (true) {
    used[edge] = true;
    const auto& [a, b] = plan.edges[edge];
    const size_t node = chain.back() == a ? b : a;
    chain.push_back(node);
    if (degree[node] > 2) return chain;
    for (size_t i = 0; i < plan.edges.size(); ++i) {
      const bool touches = plan.edges[i].first == node || plan.edges[i].second == node;
      if (touches && !used[i]) edge = i;
    }
  }
}

}  // namespace

StreetGrid make_street_grid(Random& random) {
  Plan plan = jittered_grid(random);
  thin_out(plan, random);
  const std::vector<int> degree = plan.degrees();

  StreetGrid grid;
  std::vector<size_t> junction_of(plan.nodes.size(), 0);
  for (size_t node = 0; node < plan.nodes.size(); ++node) {
    if (degree[node] < 3) continue;
    junction_of[node] = grid.junctions.size();
    grid.junctions.push_back(plan.nodes[node]);
  }
  std::vector<bool> used(plan.edges.size(), false);
  for (size_t edge = 0; edge < plan.edges.size(); ++edge) {
    for (const size_t start : {plan.edges[edge].first, plan.edges[edge].second}) {
      if (used[edge] || degree[start] < 3) continue;
      const std::vector<size_t> chain = chain_from(plan, degree, edge, start, used);
      Polyline corners;
      for (const size_t node : chain) corners.push_back(plan.nodes[node]);
      grid.streets.push_back(
          {junction_of[chain.front()], junction_of[chain.back()], street_line(corners, random)});
    }
  }
  return grid;
}

}  // namespace bevloc::sim
