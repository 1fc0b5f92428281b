// Encodes the localizer's reports as protected CAN frames and sends them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "can/bus/bus.h"
#include "can/e2e/e2e.h"
#include "can/messages/geo_reference.h"
#include "can/messages/message.h"
#include "can/messages/pose_report.h"
#include "can/publisher/solution_frames.h"
#include "can/secoc/secoc_sender.h"

namespace bevloc::can {

struct PosePublisherConfig {
  BaseIds base_ids{};
  GeodeticPosition map_origin{};
  FrameFormat format = FrameFormat::kClassic;
  Identity identity{};
  bool sends_clock = false;  ///< whether to send LOC_Clock
};

/// Sends each report as one epoch of protected frames, or on CAN FD as one frame. The caller calls
/// publish() once per cycle (kSolutionCycleMs). LOC_Status is sent on every change and every
/// kStatusCycleMs, LOC_Identity every loc_identity::kItemCycleMs, and LOC_Clock every
/// loc_clock::kCycleMs. A status frame that found no room on the bus is sent again in the next
/// cycle. A pose that must not be used is sent as SNA, with the reason in the status
/// (status_to_send()).
///
/// Does not allocate. One thread.
class PosePublisher {
 public:
  /// `bus` must outlive the publisher.
  PosePublisher(Bus& bus, const PosePublisherConfig& config);

  /// From now on, authenticates each epoch with LOC_Authentication, and sends LOC_Freshness.
  void authenticate(SecocSender sender) { secoc_ = std::move(sender); }

  /// `now` is the time of this call, which may be later than PoseReport::pose_time. Returns the
  /// status that was sent (status_to_send()).
  LocalizerStatus publish(const PoseReport& report, Time now);

  /// Returns the identifiers that a publisher of this format sends, with or without authentication
  /// and LOC_Clock.
  static std::vector<uint32_t> sent_ids(const BaseIds& base, FrameFormat format, bool secoc,
                                        bool clock);

 private:
  void publish_classic(const SolutionFrames& frames, const LocalizerStatus& status, Time now);
  void publish_fd(const SolutionFrames& frames, const LocalizerStatus& status, Time now);
  SendResult send(Frame frame, E2eSender& sender, Time now);
  void send_status_if_due(const LocalizerStatus& status, Time now);
  void send_identity_if_due(Time now);
  void send_authentication(Time now);
  void send_clock_if_due(const ClockReport& clock, Time now);
  /// Goes on to the next item of the identity if it is due. Returns whether it was due.
  bool advance_identity(Time now);

  Bus& bus_;
  PosePublisherConfig config_;
  GeoReference geo_;
  uint8_t epoch_ = 0;
  E2eSender status_sender_;
  std::array<E2eSender, kSolutionMessages.size()> senders_;
  E2eSender fd_sender_;
  std::optional<LocalizerStatus> sent_status_;
  Time status_sent_at_{};
  E2eSender identity_sender_;
  int identity_item_ = 0;
  std::optional<Time> identity_changed_at_;
  E2eSender clock_sender_;
  std::optional<Time> clock_sent_at_;

  std::optional<SecocSender> secoc_;
  E2eSender authentication_sender_;
  E2eSender freshness_sender_;
  std::optional<Time> freshness_sent_at_;
  std::array<Frame, Authenticator::kMaxFrames> epoch_frames_{};  ///< sent in this epoch
  size_t epoch_frame_count_ = 0;
};

}  // namespace bevloc::can
