#include "evaluation/drive/judge.h"

#include <algorithm>
#include <iterator>

#include "firmware/devices/can_bus.h"

namespace bevloc::evaluation {
namespace {

constexpr Duration kComparisonPeriod = std::chrono::milliseconds(100);
constexpr double kCycle_s = 1e-3 * can::kSolutionCycleMs;

}  // namespace

Result<std::unique_ptr<Judge>> Judge::create(std::unique_ptr<can::Bus> bus,
                                             const firmware::CanConfig& can,
                                             const GeoOrigin& origin, TruthAt truth,
                                             JudgeTimes times, const std::string& log_path) {
  auto log = BusLog::create(log_path);
  if (!log) return tl::unexpected(log.error());
  return std::unique_ptr<Judge>(
      new Judge(std::move(bus), can, origin, std::move(truth), times, std::move(*log)));
}

Judge::Judge(std::unique_ptr<can::Bus> bus, const firmware::CanConfig& can, const GeoOrigin& origin,
             TruthAt truth, JudgeTimes times, BusLog log)
    : bus_(std::move(bus)),
      can_(can),
      map_origin_{origin.latitude_deg, origin.longitude_deg},
      truth_(std::move(truth)),
      times_(times),
      log_(std::move(log)),
      reader_(can_.base_ids, map_origin_),
      prior_(new_prior()),
      next_comparison_(times.drive_start) {}

Judge::Prior Judge::new_prior() const {
  return Prior(firmware::make_vehicle_decoder(can_, map_origin_));
}

void Judge::step(Duration timeout) {
  if (!bus_->wait(timeout)) return;
  while (const auto received = bus_->receive()) take(*received);
}

void Judge::take(const can::ReceivedFrame& received) {
  log_.add(received.received - times_.log_start, received.frame);
  latest_s_ = to_seconds(received.received - times_.drive_start);
  Time gap_end = gap_end_;
  if (received.received >= gap_end && gap_end_.compare_exchange_strong(gap_end, kNoGap)) {
    prior_ = new_prior();
  }
  if (const auto samples = prior_.input->accept(received)) {
    if (samples.odometry) prior_.tracker.add_odometry(*samples.odometry);
    if (samples.gnss) prior_.tracker.add_gnss(*samples.gnss);
    return;
  }
  const auto pose = reader_.accept(received);
  note_solution(received, pose.has_value());
  if (pose && pose->received >= next_comparison_) {
    next_comparison_ = pose->received + kComparisonPeriod;
    compare(*pose);
  }
  const std::lock_guard lock(view_mutex_);
  view_.state = reader_.state();
  if (pose) ++view_.valid_poses;
}

void Judge::note_solution(const can::ReceivedFrame& received, bool valid) {
  const auto sent_by_localizer = [&](const can::Message* message) {
    return message->sender == can::Sender::kLocalizer &&
           message->id(can_.base_ids) == received.frame.id;
  };
  if (std::none_of(std::begin(can::kMessages), std::end(can::kMessages), sent_by_localizer)) return;
  ++localizer_frames_;
  if (valid && first_fix_s_ < 0.0)
    first_fix_s_ = to_seconds(received.received - times_.drive_start);
  const bool completes_solution =
      received.frame.id == can::loc_integrity::kMessage.id(can_.base_ids) ||
      received.frame.id == can::loc_solution::kMessage.id(can_.base_ids);
  if (first_fix_s_ >= 0.0 && completes_solution) ++solutions_since_fix_;
}

double Judge::valid_share() const {
  if (first_fix_s_ < 0.0) return 0.0;
  // The time counts the cycles of a silent bus too. Its last cycle may not be complete.
  const auto cycles = static_cast<uint64_t>((latest_s_ - first_fix_s_) / kCycle_s);
  return static_cast<double>(view().valid_poses) /
         static_cast<double>(std::max({solutions_since_fix_, cycles, uint64_t{1}}));
}

void Judge::compare(const BusPose& pose) {
  const auto prior = prior_.tracker.pose_at(pose.received);
  if (!prior) return;
  JudgedPose judged;
  judged.time_s = to_seconds(pose.received - times_.drive_start);
  judged.state = reader_.state();
  judged.truth = truth_(judged.time_s);
  judged.prior = prior->map_from_vehicle;
  judged.estimate = pose.map_from_vehicle;
  prior_error_.add(pose_error(judged.truth, judged.prior));
  estimate_error_.add(pose_error(judged.truth, judged.estimate));
  poses_.push_back(judged);
  const std::lock_guard lock(view_mutex_);
  view_.latest = judged;
}

JudgeView Judge::view() const {
  const std::lock_guard lock(view_mutex_);
  return view_;
}

}  // namespace bevloc::evaluation
