#include "evaluation/campaign/match_table.h"

#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/files.h"

namespace bevloc::evaluation {
namespace {

constexpr const char* kHead =
    "drive,frame,station_mm,curvature_1e5,range,truth_x,truth_y,truth_yaw,found_x,found_y,found_"
    "yaw,"
    "sigma_x,sigma_y,sigma_yaw,rho_xy,rho_xyaw,rho_yyaw,rival_x,rival_y,rival_yaw,edge_x,edge_y,"
    "edge_yaw,score,score_x,score_y,score_yaw\n";
constexpr size_t kColumns = 27;
constexpr double kPercent = 100.0;
constexpr double kMilli = 1e3;
constexpr double kCurvatureSteps = 1e5;

using Numbers = std::array<int64_t, kColumns>;

int64_t mdeg(double radians_value) {
  return std::lround(kMilli * degrees(radians_value));
}

int64_t mm(double metres) {
  return std::lround(kMilli * metres);
}

Numbers numbers_of(const MeasuredPlace& place, const MeasuredMatch& match) {
  const auto percent = [](double share) { return std::lround(kPercent * share); };
  return {place.drive,
          place.frame,
          mm(place.station_m),
          std::lround(kCurvatureSteps * place.curvature_radpm),
          static_cast<int64_t>(match.range),
          mm(match.truth.x_m),
          mm(match.truth.y_m),
          mdeg(match.truth.yaw_rad),
          mm(match.found.x_m),
          mm(match.found.y_m),
          mdeg(match.found.yaw_rad),
          mm(match.sigma(0)),
          mm(match.sigma(1)),
          mdeg(match.sigma(2)),
          percent(match.correlation(0)),
          percent(match.correlation(1)),
          percent(match.correlation(2)),
          percent(match.rival_peak(0)),
          percent(match.rival_peak(1)),
          percent(match.rival_peak(2)),
          percent(match.edge_mass(0)),
          percent(match.edge_mass(1)),
          percent(match.edge_mass(2)),
          percent(match.score),
          percent(match.axis_score(0)),
          percent(match.axis_score(1)),
          percent(match.axis_score(2))};
}

bool parse(const std::string& line, Numbers& numbers) {
  const char* next = line.data();
  const char* const end = line.data() + line.size();
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0 && (next == end || *next++ != ',')) return false;
    const auto [rest, error] = std::from_chars(next, end, numbers[i]);
    if (error != std::errc()) return false;
    next = rest;
  }
  return next == end;
}

Se2 pose_of(const Numbers& n, size_t first) {
  return {static_cast<double>(n[first]) / kMilli, static_cast<double>(n[first + 1]) / kMilli,
          radians(static_cast<double>(n[first + 2]) / kMilli)};
}

Eigen::Vector3d shares_of(const Numbers& n, size_t first) {
  return Eigen::Vector3d(static_cast<double>(n[first]), static_cast<double>(n[first + 1]),
                         static_cast<double>(n[first + 2])) /
         kPercent;
}

MeasuredMatch match_of(const Numbers& n) {
  MeasuredMatch match;
  match.range = n[4] == 0 ? SearchRange::kTracking : SearchRange::kAcquiring;
  match.truth = pose_of(n, 5);
  match.found = pose_of(n, 8);
  const Se2 sigma = pose_of(n, 11);
  match.sigma = {sigma.x_m, sigma.y_m, sigma.yaw_rad};
  match.correlation = shares_of(n, 14);
  match.rival_peak = shares_of(n, 17);
  match.edge_mass = shares_of(n, 20);
  match.score = static_cast<double>(n[23]) / kPercent;
  match.axis_score = shares_of(n, 24);
  return match;
}

/// The line of a match, as in the file.
struct TableLine {
  std::string place;  ///< FILE:LINE
  std::string text;
};

Result<Numbers> numbers_of_line(const TableLine& line) {
  Numbers n{};
  if (!parse(line.text, n) || n[11] <= 0 || n[12] <= 0 || n[13] <= 0) {
    return fail("{}: found '{}', wanted {} whole numbers with sigmas above 0", line.place,
                line.text, kColumns);
  }
  if (n[4] != static_cast<int64_t>(SearchRange::kTracking) &&
      n[4] != static_cast<int64_t>(SearchRange::kAcquiring)) {
    return fail("{}: found the range {}, wanted 0 (tracking) or 1 (acquiring)", line.place, n[4]);
  }
  return n;
}

/// The modelled matcher replays one drive at a time, and needs matches of both ranges in it.
Status check_ranges(const MatchTable& table, const std::string& file) {
  std::map<int, std::set<SearchRange>> ranges;
  for (const MeasuredPlace& place : table.places) {
    for (const MeasuredMatch& match : place.matches) ranges[place.drive].insert(match.range);
  }
  for (const auto& [drive, found] : ranges) {
    if (found.size() == 2) continue;
    const bool tracking = found.contains(SearchRange::kTracking);
    return fail(
        "{}: found no match of range {} in drive {}, wanted both ranges in each drive; measure "
        "longer drives with `bevloc tune matches`",
        file, tracking ? "1 (acquiring)" : "0 (tracking)", drive);
  }
  return {};
}

}  // namespace

Eigen::Matrix3d MeasuredMatch::covariance() const {
  // Rounding of the file could make nearly dependent axes indefinite.
  const Eigen::Vector3d rho = correlation.cwiseMax(-0.97).cwiseMin(0.97);
  Eigen::Matrix3d shape = Eigen::Matrix3d::Identity();
  shape(0, 1) = shape(1, 0) = rho(0);
  shape(0, 2) = shape(2, 0) = rho(1);
  shape(1, 2) = shape(2, 1) = rho(2);
  if (shape.determinant() < 1e-3) shape = Eigen::Matrix3d::Identity();
  return sigma.asDiagonal() * shape * sigma.asDiagonal();
}

Result<MatchTable> read_match_table(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  std::istringstream lines(*text);
  std::string line;
  std::getline(lines, line);
  if (line + "\n" != kHead) {
    return fail("{}:1: found other columns, wanted those of `bevloc tune matches`", file.string());
  }
  MatchTable table;
  for (int number = 2; std::getline(lines, line); ++number) {
    const auto read = numbers_of_line({fmt::format("{}:{}", file.string(), number), line});
    if (!read) return tl::unexpected(read.error());
    const Numbers& n = *read;
    const auto drive = static_cast<int>(n[0]);
    const auto frame = static_cast<int>(n[1]);
    const bool is_new = table.places.empty() || table.places.back().drive != drive ||
                        table.places.back().frame != frame;
    if (is_new) {
      table.places.push_back({drive,
                              frame,
                              static_cast<double>(n[2]) / kMilli,
                              static_cast<double>(n[3]) / kCurvatureSteps,
                              {}});
    }
    table.places.back().matches.push_back(match_of(n));
  }
  if (table.places.empty()) return fail("{}: found no match, wanted some", file.string());
  if (Status both = check_ranges(table, file.string()); !both) return tl::unexpected(both.error());
  return table;
}

std::string to_csv(const MatchTable& table) {
  std::string text = kHead;
  for (const MeasuredPlace& place : table.places) {
    for (const MeasuredMatch& match : place.matches) {
      text += fmt::format("{}\n", fmt::join(numbers_of(place, match), ","));
    }
  }
  return text;
}

}  // namespace bevloc::evaluation
