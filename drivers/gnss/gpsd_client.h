// Receives positions from gpsd, which reads NMEA and UBX receivers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/time.h"
#include "drivers/gnss/gpsd_report.h"

namespace bevloc::drivers {

struct GpsdAddress {
  std::string address = "127.0.0.1";  ///< in numbers, IPv4 or IPv6
  uint16_t port = 2947;
  std::string device;  ///< as gpsd calls it; empty: all receivers of this gpsd
};

/// Totals since start.
struct GpsdCounters {
  std::array<uint64_t, kGpsdLines> lines{};  ///< by GpsdLine
  uint64_t too_long = 0;                     ///< lines that are longer than any report
  uint64_t connected = 0;                    ///< how often a connection was made
  uint64_t failed = 0;                       ///< attempts without a connection
  uint64_t silent = 0;                       ///< connections that were closed after a silence

  uint64_t of(GpsdLine line) const { return lines[static_cast<size_t>(line)]; }
};

/// A TCP connection to gpsd. After a loss it connects again, at growing intervals of up to 5 s.
/// Only wait() blocks, and at most for its timeout. One thread.
class GpsdClient {
 public:
  /// The client closes a connection that was silent for this long: the other end may be gone.
  static constexpr Duration kSilence = std::chrono::seconds(10);
  static constexpr Duration kConnectPatience = std::chrono::seconds(2);
  static constexpr size_t kLongestLine = 16'384;

  explicit GpsdClient(const GpsdAddress& address);
  ~GpsdClient();
  GpsdClient(const GpsdClient&) = delete;
  GpsdClient& operator=(const GpsdClient&) = delete;

  /// Waits for bytes, at most `timeout` of real time, and takes what is there. Connects where need
  /// be; `now` decides when.
  void wait(Time now, Duration timeout);

  /// The next fix of what wait() took; nothing if there is none any more.
  std::optional<GnssFix> take_fix();

  bool is_connected() const { return state_ == State::kConnected; }
  const GpsdCounters& counters() const { return counters_; }

 private:
  enum class State : uint8_t { kClosed, kConnecting, kConnected };

  void begin_connecting(Time now);
  void finish_connecting(Time now, Duration timeout);
  void receive(Time now, Duration timeout);
  void close_socket(Time now);

  const GpsdAddress address_;
  State state_ = State::kClosed;
  int socket_ = -1;
  Time next_try_ = Time::min();
  Time since_{};  ///< when the attempt began, or the latest bytes came
  Duration pause_;
  std::string received_;
  bool skips_line_ = false;  ///< the rest of a line that is too long
  GpsdReader reader_;
  GpsdCounters counters_;
};

/// What the client sends to gpsd first.
std::string watch_command(const GpsdAddress& address);

}  // namespace bevloc::drivers
