// Receives positions from gpsd, which reads NMEA and UBX receivers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/file_descriptor.h"
#include "common/time.h"
#include "drivers/gnss/gpsd_report.h"

namespace bevloc::drivers {

struct GpsdAddress {
  std::string address = "127.0.0.1";  ///< an IPv4 or IPv6 address in numbers
  uint16_t port = 2947;
  std::string device;  ///< gpsd's name of the receiver; empty for all receivers of this gpsd
};

/// Totals since start.
struct GpsdCounters {
  std::array<uint64_t, kGpsdLines> lines{};  ///< number of lines for each GpsdLine
  uint64_t too_long = 0;                     ///< lines that are longer than any report
  uint64_t connected = 0;                    ///< number of connections that were made
  uint64_t failed = 0;                       ///< attempts without a connection
  int failure = 0;                           ///< errno of the latest of them
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

  /// Waits for bytes, at most `timeout` of real time, and takes those that are there. Connects if
  /// there is no connection and the next attempt is due at `now`.
  void wait(Time now, Duration timeout);

  /// Returns the next fix from the bytes that wait() took, or nothing if there is no further one.
  std::optional<GnssFix> take_fix();

  bool is_connected() const { return state_ == State::kConnected; }
  const GpsdCounters& counters() const { return counters_; }

 private:
  enum class State : uint8_t { kClosed, kConnecting, kConnected };

  void begin_connecting(Time now);
  void note_failure(Time now, int error);
  void finish_connecting(Time now, Duration timeout);
  void receive(Time now, Duration timeout);
  void close_socket(Time now);

  const GpsdAddress address_;
  State state_ = State::kClosed;
  FileDescriptor socket_;
  Time next_try_ = Time::min();
  Time since_{};  ///< when the attempt began, or the latest bytes came
  Duration pause_;
  std::string received_;
  bool skips_line_ = false;  ///< whether the rest of a line that is too long is skipped
  GpsdReader reader_;
  GpsdCounters counters_;
};

/// Returns what the client sends to gpsd first.
std::string watch_command(const GpsdAddress& address);

}  // namespace bevloc::drivers
