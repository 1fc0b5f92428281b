// Sends the localizer's solutions to the bus.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "can/bus.h"
#include "can/e2e.h"
#include "can/geo_reference.h"
#include "can/message.h"
#include "can/pose_report.h"
#include "can/solution_frames.h"

namespace bevloc::can {

struct PosePublisherConfig {
  BaseIds base_ids{};
  GeodeticPosition map_origin{};
  ReportLimits limits{};
  FrameFormat format = FrameFormat::kClassic;
};

/// Makes one epoch of protected frames of each report and sends them, or on CAN FD one frame with
/// all of it. The caller keeps the cycle (kSolutionCycleMs). LOC_Status goes out on every change
/// and every kStatusCycleMs; one that found no room on the bus is tried again in the next cycle. A
/// pose that cannot be vouched for is sent as SNA, with a status that says why (told_status).
///
/// Does not allocate. One thread at a time.
class PosePublisher {
 public:
  /// `bus` must outlive the publisher.
  PosePublisher(Bus& bus, const PosePublisherConfig& config);

  void publish(const PoseReport& report, Time now);

  /// The identifiers that a publisher of this format sends.
  static std::vector<uint32_t> sent_ids(const BaseIds& base, FrameFormat format);

 private:
  void publish_classic(const SolutionFrames& frames, const LocalizerStatus& told, Time now);
  void publish_fd(const SolutionFrames& frames, const LocalizerStatus& told, Time now);
  SendResult send(Frame frame, E2eSender& sender, Time now);
  void send_status_if_due(const LocalizerStatus& status, Time now);

  Bus& bus_;
  PosePublisherConfig config_;
  GeoReference geo_;
  uint8_t epoch_ = 0;
  E2eSender status_sender_;
  std::array<E2eSender, kSolutionMessages.size()> senders_;
  E2eSender fd_sender_;
  std::optional<LocalizerStatus> sent_status_;
  Time status_sent_at_{};
};

}  // namespace bevloc::can
