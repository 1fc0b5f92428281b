#include "can/pose_publisher.h"

#include <utility>

#include "can/message_table.h"

namespace bevloc::can {
namespace {

template <size_t... I>
std::array<E2eSender, sizeof...(I)> solution_senders(std::index_sequence<I...>) {
  return {E2eSender(kSolutionMessages[I]->data_id)...};
}

}  // namespace

PosePublisher::PosePublisher(Bus& bus, const PosePublisherConfig& config)
    : bus_(bus),
      config_(config),
      geo_(config.map_origin),
      status_sender_(loc_status::kMessage.data_id),
      senders_(solution_senders(std::make_index_sequence<kSolutionMessages.size()>())) {}

void PosePublisher::publish(const PoseReport& report, Time now) {
  const LocalizerStatus told = told_status(report, config_.limits, now);
  send_status_if_due(told, now);
  const SolutionFrames frames =
      solution_frames(report, told, config_.limits, geo_, config_.base_ids, now);
  for (size_t i = 0; i < frames.size(); ++i) send(frames[i], senders_[i], now);
  epoch_ = (epoch_ + 1) & 0x0F;
}

SendResult PosePublisher::send(Frame frame, E2eSender& sender, Time now) {
  insert_raw(frame, kEpoch, epoch_);
  sender.protect(frame);
  return bus_.send(frame, now);
}

void PosePublisher::send_status_if_due(const LocalizerStatus& status, Time now) {
  constexpr std::chrono::milliseconds kCycle(kStatusCycleMs);
  if (sent_status_ == status && now - status_sent_at_ < kCycle) return;
  const bool sent =
      send(status_frame(status, config_.base_ids), status_sender_, now) == SendResult::kSent;
  sent_status_ = sent ? std::optional(status) : std::nullopt;
  status_sent_at_ = now;
}

}  // namespace bevloc::can
