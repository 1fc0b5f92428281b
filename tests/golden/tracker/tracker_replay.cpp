// Feeds recorded measurements to the tracker and prints what it answers: tracker_replay FILE.
// script/golden compares the output with tests/golden/tracker/reference.csv.
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pipeline/tracker/tracker.h"

namespace {

using namespace bevloc;

/// One line of measurements.csv; its columns are named in make_measurements.py.
struct Measurement {
  std::string kind;
  Time time;
  OdometrySample odometry;
  Se2 pose;
  double sigma_m = 0.0;
  double yaw_sigma_rad = 0.0;
};

Measurement parse(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> cells;
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  cells.resize(9);
  const auto number = [&cells](size_t column) {
    return cells[column].empty() ? 0.0 : std::stod(cells[column]);
  };
  Measurement measurement;
  measurement.kind = cells[0];
  measurement.time = Time{} + from_seconds(number(1));
  measurement.odometry = {measurement.time, number(2), number(3)};
  measurement.pose = {number(4), number(5), number(6)};
  measurement.sigma_m = number(7);
  measurement.yaw_sigma_rad = number(8);
  return measurement;
}

TrackerUpdate add_gnss(Tracker& tracker, const Measurement& measurement) {
  GnssSample sample;
  sample.time = measurement.time;
  sample.east_m = measurement.pose.x_m;
  sample.north_m = measurement.pose.y_m;
  sample.sigma_east_m = sample.sigma_north_m = measurement.sigma_m;
  sample.yaw = {measurement.pose.yaw_rad, measurement.yaw_sigma_rad};
  return tracker.add_gnss(sample);
}

TrackerUpdate add_correction(Tracker& tracker, const Measurement& measurement) {
  const auto tracked = tracker.pose_at(measurement.time);
  const Se2 prior = tracked ? tracked->map_from_vehicle : measurement.pose;
  const Eigen::Vector3d sigma(measurement.sigma_m, measurement.sigma_m, measurement.yaw_sigma_rad);
  MatchResult result;
  result.evidence = Evidence::kGood;
  result.correction = correction_between(prior, measurement.pose);
  result.covariance = sigma.cwiseAbs2().asDiagonal();
  return tracker.add_correction(measurement.time, prior, result);
}

TrackerUpdate feed(Tracker& tracker, const Measurement& measurement) {
  if (measurement.kind == "gnss") return add_gnss(tracker, measurement);
  if (measurement.kind == "correction") return add_correction(tracker, measurement);
  return tracker.add_odometry(measurement.odometry);
}

/// The pose at the time of the measurement, if the tracker knows it.
std::string pose_cells(const Tracker& tracker, Time time) {
  const auto tracked = tracker.pose_at(time);
  if (!tracked) return ",,,,";
  const Se2& pose = tracked->map_from_vehicle;
  return fmt::format("{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}", pose.x_m, pose.y_m,
                     degrees(pose.yaw_rad), tracked->speed_mps,
                     std::sqrt(tracked->covariance(0, 0)));
}

}  // namespace

int main(int argc, char** argv) {
  std::ifstream file(argc > 1 ? argv[1] : "");
  std::string line;
  if (!std::getline(file, line)) {
    fmt::print(stderr, "tracker_replay: found no readable file, wanted measurements.csv\n");
    return 2;
  }
  Tracker tracker;
  fmt::print("time_s,kind,update,x_m,y_m,yaw_deg,speed_mps,sigma_m\n");
  while (std::getline(file, line)) {
    const Measurement measurement = parse(line);
    const TrackerUpdate update = feed(tracker, measurement);
    fmt::print("{:.3f},{},{},{}\n", to_seconds(measurement.time.time_since_epoch()),
               measurement.kind, name_of(update), pose_cells(tracker, measurement.time));
  }
  return 0;
}
