// Writes the log to stdout in a thread of its own, so that nobody waits for the reader of the log.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string_view>
#include <thread>

#include <unistd.h>

#include "common/bounded_queue.h"
#include "firmware/threads/heartbeat.h"

namespace spdlog {
class logger;
}

namespace bevloc::firmware {

/// Replaces spdlog's default logger until it is destroyed. A line is formatted in the thread that
/// logs and copied into a bounded queue. A full queue drops its oldest line and counts it. Only the
/// writer's thread waits until the file accepts a line, so a pipe that nobody reads costs lines,
/// but no other thread waits. When lines can be written again, one line says how many were dropped.
/// Lines for a closed file are dropped. Logging allocates nothing for messages of less than 250
/// characters.
class LogWriter {
 public:
  static constexpr size_t kQueuedLines = 256;
  /// A longer line is cut off.
  static constexpr size_t kMaxLineLength = 1000;
  /// The destructor waits at most this long for the reader.
  static constexpr Duration kFarewell = std::chrono::milliseconds(50);

  /// Writes to the descriptor `file`. It may be closed, but must stay as it is, open or closed, for
  /// the life of this object.
  explicit LogWriter(int file = STDOUT_FILENO);
  /// Writes the queued lines.
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// Number of lines that were not written, readable from any thread.
  uint64_t dropped() const { return lines_.dropped() + unwritable_; }
  const Heartbeat& heartbeat() const { return heartbeat_; }

 private:
  class Sink;
  struct Line {
    uint16_t size = 0;
    std::array<char, kMaxLineLength> text;
    std::string_view view() const { return {text.data(), size}; }
  };

  void run();
  void write(const Line& line);
  void report_drops();

  const int file_;
  BoundedQueue<Line> lines_{kQueuedLines};
  std::atomic<uint64_t> unwritable_{0};  ///< lines that the file refused
  uint64_t reported_drops_ = 0;
  std::atomic<bool> closing_{false};
  Heartbeat heartbeat_;
  std::shared_ptr<spdlog::logger> before_;
  std::jthread thread_;
};

/// Writes as much of `text` as the file accepts within `patience`. Returns false if a part was not
/// written. Does not block for longer, not even on a full pipe.
bool write_with_patience(int file, std::string_view text, Duration patience);

}  // namespace bevloc::firmware
