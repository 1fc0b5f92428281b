#include "can/publisher/pose_publisher.h"

#include <span>
#include <utility>

#include "can/messages/message_table.h"
#include "can/publisher/solution_fd.h"

namespace bevloc::can {
namespace {

template <size_t... I>
std::array<E2eSender, sizeof...(I)> solution_senders(std::index_sequence<I...>) {
  return {E2eSender(kSolutionMessages[I]->protection())...};
}

/// Whether a message is due. Calls come a little early or late. The slack selects the call that is
/// nearest to the end of the cycle.
bool is_due(Time sent, int cycle_ms, Time now) {
  constexpr Duration kSlack = std::chrono::milliseconds(kSolutionCycleMs) / 2;
  return now - sent >= std::chrono::milliseconds(cycle_ms) - kSlack;
}

}  // namespace

PosePublisher::PosePublisher(Bus& bus, const PosePublisherConfig& config)
    : bus_(bus),
      config_(config),
      geo_(config.map_origin),
      status_sender_(loc_status::kMessage.protection()),
      senders_(solution_senders(std::make_index_sequence<kSolutionMessages.size()>())),
      fd_sender_(loc_solution::kMessage.protection()),
      identity_sender_(loc_identity::kMessage.protection()),
      clock_sender_(loc_clock::kMessage.protection()),
      authentication_sender_(loc_authentication::kMessage.protection()),
      freshness_sender_(loc_freshness::kMessage.protection()) {}

LocalizerStatus PosePublisher::publish(const PoseReport& report, Time now) {
  const LocalizerStatus status = status_to_send(report, now);
  const SolutionFrames frames = solution_frames(report, status, geo_, config_.base_ids, now);
  if (config_.format == FrameFormat::kFd) {
    publish_fd(frames, status, now);
  } else {
    publish_classic(frames, status, now);
  }
  if (config_.sends_clock) send_clock_if_due(report.clock, now);
  if (secoc_) send_authentication(now);
  epoch_ = (epoch_ + 1) & 0x0F;
  return status;
}

void PosePublisher::publish_classic(const SolutionFrames& frames, const LocalizerStatus& status,
                                    Time now) {
  send_status_if_due(status, now);
  for (size_t i = 0; i < frames.size(); ++i) send(frames[i], senders_[i], now);
  send_identity_if_due(now);
}

void PosePublisher::publish_fd(const SolutionFrames& frames, const LocalizerStatus& status,
                               Time now) {
  advance_identity(now);
  Frame solution = joined_solution(
      status_frame(status, config_.base_ids), frames,
      identity_frame(config_.identity, identity_item_, config_.base_ids), config_.base_ids);
  fd_sender_.protect(solution);
  if (secoc_) epoch_frames_[epoch_frame_count_++] = solution;
  bus_.send(solution, now);
}

std::vector<uint32_t> PosePublisher::sent_ids(const BaseIds& base, FrameFormat format, bool secoc,
                                              bool clock) {
  std::vector<uint32_t> ids;
  for (const Message* message : kMessages) {
    const bool is_clock = message == &loc_clock::kMessage;
    const bool is_always_sent = !is_clock && message->format == format;
    const bool is_sent = is_secoc_message(*message) ? secoc : is_always_sent || (is_clock && clock);
    if (is_sent && message->sender == Sender::kLocalizer) ids.push_back(message->id(base));
  }
  return ids;
}

SendResult PosePublisher::send(Frame frame, E2eSender& sender, Time now) {
  insert_raw(frame, kEpoch, epoch_);
  sender.protect(frame);
  if (secoc_) epoch_frames_[epoch_frame_count_++] = frame;
  return bus_.send(frame, now);
}

void PosePublisher::send_status_if_due(const LocalizerStatus& status, Time now) {
  if (sent_status_ == status && !is_due(status_sent_at_, kStatusCycleMs, now)) return;
  const bool sent =
      send(status_frame(status, config_.base_ids), status_sender_, now) == SendResult::kSent;
  sent_status_ = sent ? std::optional(status) : std::nullopt;
  status_sent_at_ = now;
}

void PosePublisher::send_identity_if_due(Time now) {
  if (!advance_identity(now)) return;
  send(identity_frame(config_.identity, identity_item_, config_.base_ids), identity_sender_, now);
}

void PosePublisher::send_authentication(Time now) {
  const std::span<const Frame> frames(epoch_frames_.data(), epoch_frame_count_);
  const Frame authentication =
      secoc_->authenticate(loc_authentication::kMessage, frames, config_.base_ids);
  if (!freshness_sent_at_ || is_due(*freshness_sent_at_, kFreshnessCycleMs, now)) {
    freshness_sent_at_ = now;
    send(secoc_->freshness(loc_freshness::kMessage, config_.base_ids), freshness_sender_, now);
  }
  send(authentication, authentication_sender_, now);
  epoch_frame_count_ = 0;
}

/// LOC_Authentication does not cover LOC_Clock, so that a receiver need not know LOC_Clock.
void PosePublisher::send_clock_if_due(const ClockReport& clock, Time now) {
  if (clock_sent_at_ && !is_due(*clock_sent_at_, loc_clock::kCycleMs, now)) return;
  clock_sent_at_ = now;
  Frame frame = clock_frame(clock, config_.base_ids);
  insert_raw(frame, kEpoch, epoch_);
  clock_sender_.protect(frame);
  bus_.send(frame, now);
}

bool PosePublisher::advance_identity(Time now) {
  if (identity_changed_at_ && !is_due(*identity_changed_at_, loc_identity::kItemCycleMs, now)) {
    return false;
  }
  if (identity_changed_at_) identity_item_ = (identity_item_ + 1) % loc_identity::kItems;
  identity_changed_at_ = now;
  return true;
}

}  // namespace bevloc::can
