#include "pipeline/calibration/reference_trajectory.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "common/files.h"

namespace bevloc {
namespace {

constexpr std::string_view kHeader = "time_ns,x_m,y_m,yaw_deg";

/// Takes a number and, unless it is the last, the comma after it from the text.
template <typename T>
bool take(std::string_view& text, T& value, bool last = false) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc()) return false;
  text.remove_prefix(static_cast<size_t>(result.ptr - text.data()));
  if (last) return text.empty() || text == "\r";
  if (!text.starts_with(',')) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

Result<ReferenceTrajectory> ReferenceTrajectory::parse(const std::string& text,
                                                       const std::string& name) {
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  if (!line.starts_with(kHeader)) {
    return fail("{}:1: found \"{}\", wanted the header {}", name, line.substr(0, 80), kHeader);
  }
  std::vector<Pose> poses;
  for (int number = 2; std::getline(lines, line); ++number) {
    if (line.empty() || line == "\r") continue;
    std::string_view rest = line;
    int64_t time_ns = 0;
    double yaw_deg = 0.0;
    Se2 pose;
    if (!take(rest, time_ns) || !take(rest, pose.x_m) || !take(rest, pose.y_m) ||
        !take(rest, yaw_deg, true) || time_ns < 0 ||
        !Se2{pose.x_m, pose.y_m, yaw_deg}.is_finite()) {
      return fail("{}:{}: found \"{}\", wanted {}", name, number, line.substr(0, 80), kHeader);
    }
    pose.yaw_rad = wrap_angle(radians(yaw_deg));
    const Time time{Duration(time_ns)};
    if (!poses.empty() && time <= poses.back().time) {
      return fail("{}:{}: found a time that does not increase, wanted later times in later lines",
                  name, number);
    }
    poses.push_back({time, pose});
  }
  if (poses.size() < 2) return fail("{}: found {} poses, wanted two or more", name, poses.size());
  return ReferenceTrajectory(std::move(poses));
}

Result<ReferenceTrajectory> ReferenceTrajectory::read(const std::filesystem::path& file) {
  return parse_file(file, parse);
}

std::optional<Se2> ReferenceTrajectory::at(Time time) const {
  constexpr Duration kLongestGap = std::chrono::milliseconds(500);
  const auto after = std::ranges::upper_bound(poses_, time, {}, &Pose::time);
  if (after == poses_.begin() || after == poses_.end()) return std::nullopt;
  const Pose& a = *(after - 1);
  const Duration gap = after->time - a.time;
  if (gap > kLongestGap) return std::nullopt;
  const double share = to_seconds(time - a.time) / to_seconds(gap);
  const Se2& from = a.map_from_vehicle;
  const Se2& to = after->map_from_vehicle;
  return Se2{std::lerp(from.x_m, to.x_m, share), std::lerp(from.y_m, to.y_m, share),
             wrap_angle(from.yaw_rad + share * wrap_angle(to.yaw_rad - from.yaw_rad))};
}

std::string ReferenceTrajectory::to_csv() const {
  std::string text = fmt::format("{}\n", kHeader);
  for (const auto& [time, pose] : poses_) {
    text += fmt::format("{},{:.4f},{:.4f},{:.5f}\n", time.time_since_epoch().count(), pose.x_m,
                        pose.y_m, degrees(pose.yaw_rad));
  }
  return text;
}

}  // namespace bevloc
