// The daemon's HTTP server: live page, /metrics, /healthz and /status.json.
#pragma once

#include <memory>

#include "firmware/config/live_config.h"
#include "firmware/runtime/appliance.h"
#include "firmware/status/telemetry.h"

namespace bevloc::firmware {

/// Lives as long as the daemon, also in standby. Draws the live page in a thread of its own with
/// the lowest priority, and only while somebody looks. There may be kViewers viewers. The vision
/// thread gives it copies (live_feed.h) and never waits for it.
///
/// Thread-bound: called from the supervising thread.
class LiveServer {
 public:
  static constexpr int kViewers = 4;

  /// Starts to listen and to answer. Fails if the port is taken.
  static Result<std::unique_ptr<LiveServer>> start(const LiveConfig& config);
  ~LiveServer();

  /// Shows this appliance until detach(). Call it before the appliance's threads start.
  void attach(Appliance& appliance, const Rig& rig);
  /// Call it after the appliance's threads have ended and before it is destroyed. Waits until
  /// nothing is drawn any more.
  void detach();

  /// Sets what all answers show from now on. Call it about ten times per second.
  void publish(const Telemetry& telemetry);

  int port() const;

 private:
  class Impl;
  explicit LiveServer(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace bevloc::firmware
