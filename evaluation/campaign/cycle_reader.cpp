#include "evaluation/campaign/cycle_reader.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "can/messages/message_table.h"
#include "can/publisher/solution_fd.h"
#include "common/alert_limits.h"
#include "evaluation/drive/error_statistics.h"

namespace bevloc::evaluation {
namespace {

constexpr double kNotSent = std::numeric_limits<double>::quiet_NaN();

/// The error as a part of the alert limit of its axis, on the worst axis.
double part_of_limit(const JudgedError& pose) {
  return pose.error.cwiseAbs().cwiseQuotient(kFreewayAlertLimits).maxCoeff();
}

/// The place of LOC_StdDev in LOC_Solution.
constexpr size_t kDeviationPart = [] {
  const auto& parts = can::loc_solution::kParts;
  return static_cast<size_t>(std::ranges::find(parts, &can::loc_std_dev::kMessage) - parts.begin());
}();

/// Rounded to whole nanoseconds.
Duration rounded_time(double time_s) {
  return std::chrono::round<Duration>(std::chrono::duration<double>(time_s));
}

}  // namespace

std::vector<double> missing_cycles_s(double before_s, double now_s) {
  std::vector<double> times_s;
  const Duration now = rounded_time(now_s);
  for (Duration next = rounded_time(before_s) + kSolutionCycle; next + kSolutionCycle / 2 < now;
       next += kSolutionCycle) {
    times_s.push_back(to_seconds(next));
  }
  return times_s;
}

CycleReader::CycleReader(std::unique_ptr<can::Bus> bus, const can::BaseIds& base,
                         const GeoOrigin& origin, TruthAt truth, Time drive_start)
    : bus_(std::move(bus)),
      base_(base),
      truth_(std::move(truth)),
      drive_start_(drive_start),
      reader_(base, {origin.latitude_deg, origin.longitude_deg}),
      sigma_(Eigen::Vector3d::Constant(kNotSent)) {}

JudgedCycle CycleReader::step(Time now) {
  JudgedCycle cycle;
  while (const auto received = bus_->receive()) {
    const can::Frame& frame = received->frame;
    if (frame.id == can::loc_std_dev::kMessage.id(base_)) take_deviation(frame);
    if (frame.id == can::loc_solution::kMessage.id(base_)) {
      take_deviation(can::part_of_solution(frame, kDeviationPart, base_));
    }
    const auto pose = reader_.accept(*received);
    if (!pose) continue;
    const JudgedError judged = judge(*pose);
    const bool is_worst = !cycle.pose || part_of_limit(judged) > part_of_limit(*cycle.pose);
    if (is_worst) cycle.pose = judged;
  }
  cycle.time_s = to_seconds(now - drive_start_);
  cycle.state = reader_.state();
  cycle.why = reader_.why();
  return cycle;
}

void CycleReader::take_deviation(const can::Frame& frame) {
  const auto value_of = [&frame](const can::Signal& signal) {
    return can::decode(frame, signal).value_or(kNotSent);
  };
  sigma_ = {value_of(can::loc_std_dev::kLongitudinal), value_of(can::loc_std_dev::kLateral),
            radians(value_of(can::loc_std_dev::kHeading))};
}

JudgedError CycleReader::judge(const BusPose& pose) const {
  const Se2 truth = truth_(to_seconds(pose.received - drive_start_));
  const Se2 error = pose_error(truth, pose.map_from_vehicle);
  const can::ProtectionLevel& level = pose.protection_level;
  return {.error = {error.x_m, error.y_m, error.yaw_rad},
          .sigma = sigma_,
          .protection = {level.longitudinal_m, level.lateral_m, level.yaw_rad}};
}

}  // namespace bevloc::evaluation
