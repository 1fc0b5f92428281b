#include "can/messages/pose_publisher.h"

#include <utility>

#include "can/messages/message_table.h"
#include "can/messages/solution_fd.h"

namespace bevloc::can {
namespace {

template <size_t... I>
std::array<E2eSender, sizeof...(I)> solution_senders(std::index_sequence<I...>) {
  return {E2eSender(kSolutionMessages[I]->protection())...};
}

}  // namespace

PosePublisher::PosePublisher(Bus& bus, const PosePublisherConfig& config)
    : bus_(bus),
      config_(config),
      geo_(config.map_origin),
      status_sender_(loc_status::kMessage.protection()),
      senders_(solution_senders(std::make_index_sequence<kSolutionMessages.size()>())),
      fd_sender_(loc_solution::kMessage.protection()) {}

void PosePublisher::publish(const PoseReport& report, Time now) {
  const LocalizerStatus status = status_to_send(report, config_.limits, now);
  const SolutionFrames frames =
      solution_frames(report, status, config_.limits, geo_, config_.base_ids, now);
  if (config_.format == FrameFormat::kFd) {
    publish_fd(frames, status, now);
  } else {
    publish_classic(frames, status, now);
  }
}

void PosePublisher::publish_classic(const SolutionFrames& frames, const LocalizerStatus& status,
                                    Time now) {
  send_status_if_due(status, now);
  for (size_t i = 0; i < frames.size(); ++i) send(frames[i], senders_[i], now);
  epoch_ = (epoch_ + 1) & 0x0F;
}

void PosePublisher::publish_fd(const SolutionFrames& frames, const LocalizerStatus& status,
                               Time now) {
  Frame solution =
      joined_solution(status_frame(status, config_.base_ids), frames, config_.base_ids);
  fd_sender_.protect(solution);
  bus_.send(solution, now);
}

std::vector<uint32_t> PosePublisher::sent_ids(const BaseIds& base, FrameFormat format) {
  std::vector<uint32_t> ids;
  for (const Message* message : kMessages) {
    const bool is_sent = message->sender == Sender::kLocalizer && message->format == format;
    if (is_sent) ids.push_back(message->id(base));
  }
  return ids;
}

SendResult PosePublisher::send(Frame frame, E2eSender& sender, Time now) {
  insert_raw(frame, kEpoch, epoch_);
  sender.protect(frame);
  return bus_.send(frame, now);
}

void PosePublisher::send_status_if_due(const LocalizerStatus& status, Time now) {
  // Calls are a little early or late. The slack selects the call that is nearest to the cycle's
  // end.
  constexpr Duration kCycle = std::chrono::milliseconds(kStatusCycleMs);
  constexpr Duration kSlack = std::chrono::milliseconds(kSolutionCycleMs) / 2;
  if (sent_status_ == status && now - status_sent_at_ < kCycle - kSlack) return;
  const bool sent =
      send(status_frame(status, config_.base_ids), status_sender_, now) == SendResult::kSent;
  sent_status_ = sent ? std::optional(status) : std::nullopt;
  status_sent_at_ = now;
}

}  // namespace bevloc::can
