#include "firmware/telemetry/log_writer.h"

#include <csignal>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

namespace bevloc::firmware {
namespace {

using testing::HasSubstr;

/// A pipe or a socket pair whose far end the test reads or does not read.
class Channel {
 public:
  static Channel pipe() {
    return Channel([](int* ends) { return ::pipe(ends); });
  }
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;
  /// A channel of the kind by which journald is connected.
  static Channel socket() {
    return Channel([](int* ends) { return socketpair(AF_UNIX, SOCK_STREAM, 0, ends); });
  }
  ~Channel() {
    close_reader();
    close(ends_[1]);
  }
  int writer() const { return ends_[1]; }
  void close_reader() {
    if (ends_[0] >= 0) close(ends_[0]);
    ends_[0] = -1;
  }
  /// Everything that arrives until the text contains `last`.
  std::string read_until(const std::string& last) {
    std::string text;
    char part[4096];
    while (text.find(last) == std::string::npos) {
      const ssize_t size = read(ends_[0], part, sizeof part);
      if (size <= 0) break;
      text.append(part, static_cast<size_t>(size));
    }
    return text;
  }

 private:
  explicit Channel(int (*open)(int*)) { EXPECT_EQ(open(ends_), 0); }

  int ends_[2] = {-1, -1};
};

/// Logs more than pipe, socket and queue can hold.
void log_much() {
  for (int line = 0; line < 20'000; ++line) spdlog::warn("line {} of many", line);
}

TEST(LogWriterTest, WritesEveryLineInOrder) {
  Channel channel = Channel::pipe();
  LogWriter log(channel.writer());
  spdlog::warn("first");
  spdlog::warn("second");
  const std::string text = channel.read_until("second\n");
  EXPECT_THAT(text, testing::ContainsRegex("\\[warning\\] first\n.*\\[warning\\] second\n"));
  EXPECT_EQ(log.dropped(), 0U);
}

TEST(LogWriterTest, WritesTheQueuedLinesAtItsEnd) {
  Channel channel = Channel::pipe();
  {
    LogWriter log(channel.writer());
    spdlog::warn("the last line");
  }
  EXPECT_THAT(channel.read_until("line\n"), HasSubstr("the last line\n"));
}

void expect_nobody_waits_for(const Channel& channel) {
  LogWriter log(channel.writer());
  log_much();
  EXPECT_GT(log.dropped(), 0U);
  // The writer's thread beats although it cannot write.
  const uint64_t beats = log.heartbeat().count();
  while (log.heartbeat().count() < beats + 3) std::this_thread::yield();
  EXPECT_FALSE(log.heartbeat().ended());
}

TEST(LogWriterTest, NobodyWaitsForAFullPipe) {
  expect_nobody_waits_for(Channel::pipe());
}

TEST(LogWriterTest, NobodyWaitsForAFullSocket) {
  expect_nobody_waits_for(Channel::socket());
}

TEST(LogWriterTest, SaysHowManyLinesWereDropped) {
  Channel channel = Channel::pipe();
  LogWriter log(channel.writer());
  log_much();
  const std::string text = channel.read_until("lines dropped");
  EXPECT_THAT(text, HasSubstr("lines dropped"));
}

TEST(LogWriterTest, AClosedPipeAndAClosedFileDropLines) {
  Channel channel = Channel::pipe();
  channel.close_reader();
  for (const int file : {channel.writer(), 1'000'000}) {
    LogWriter log(file);
    spdlog::warn("to nobody");
    while (log.dropped() == 0) std::this_thread::yield();
    EXPECT_EQ(log.dropped(), 1U);
  }
}

TEST(LogWriterTest, WithoutAFileDropsWhatTheQueueCannotHold) {
  LogWriter log(-1);
  log_much();
  EXPECT_GT(log.dropped(), 0U);
}

TEST(LogWriterTest, CutsALongLine) {
  Channel channel = Channel::pipe();
  LogWriter log(channel.writer());
  spdlog::warn("{}", std::string(5000, 'x'));
  const std::string text = channel.read_until("x\n");
  EXPECT_EQ(text.size(), LogWriter::kMaxLineLength);
}

TEST(LogWriterTest, RestoresTheLoggerBeforeIt) {
  const auto before = spdlog::default_logger();
  {
    Channel channel = Channel::pipe();
    LogWriter log(channel.writer());
    EXPECT_NE(spdlog::default_logger(), before);
  }
  EXPECT_EQ(spdlog::default_logger(), before);
}

}  // namespace
}  // namespace bevloc::firmware
