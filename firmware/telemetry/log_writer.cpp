#include "firmware/telemetry/log_writer.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <mutex>

#include <fmt/format.h>
#include <poll.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include "firmware/threads/realtime.h"

namespace bevloc::firmware {
namespace {

/// Longest wait of the writer's thread before it beats.
constexpr Duration kWriterPatience = std::chrono::milliseconds(50);

enum class Written : uint8_t { kAll, kLater, kRefused };

/// Waits up to `patience` until the file accepts a part of `text`, writes that part and removes it
/// from `text`. poll(2) reports a pipe or socket as writable only if a line fits, so write(2) does
/// not block.
Written write_part(int file, std::string_view& text, Duration patience) {
  pollfd ready{file, POLLOUT, 0};
  const auto patience_ms = std::chrono::duration_cast<std::chrono::milliseconds>(patience).count();
  if (poll(&ready, 1, static_cast<int>(patience_ms)) <= 0) return Written::kLater;
  const ssize_t written = ::write(file, text.data(), text.size());
  if (written < 0) return errno == EAGAIN || errno == EINTR ? Written::kLater : Written::kRefused;
  text.remove_prefix(static_cast<size_t>(written));
  return text.empty() ? Written::kAll : Written::kLater;
}

/// Blocks SIGPIPE, so that a write into a closed pipe fails instead of ending the process.
void block_sigpipe() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

}  // namespace

/// Formats each message and queues it.
class LogWriter::Sink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit Sink(BoundedQueue<Line>& lines) : lines_(lines) {}

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t text;
    formatter_->format(message, text);
    Line line;
    line.size = static_cast<uint16_t>(std::min(text.size(), kMaxLineLength));
    std::copy_n(text.data(), line.size, line.text.data());
    line.text[line.size - 1] = '\n';
    lines_.push(line);
  }
  void flush_() override {}

  BoundedQueue<Line>& lines_;
};

LogWriter::LogWriter(int file)
    : file_(file), before_(spdlog::default_logger()), thread_([this] { run(); }) {
  auto logger = std::make_shared<spdlog::logger>("", std::make_shared<Sink>(lines_));
  logger->set_level(spdlog::get_level());
  spdlog::set_default_logger(std::move(logger));
}

LogWriter::~LogWriter() {
  spdlog::set_default_logger(before_);
  closing_ = true;
  lines_.close();
}

void LogWriter::run() {
  name_this_thread("log");
  block_sigpipe();
  while (!closing_) {
    heartbeat_.beat();
    if (const auto line = lines_.pop(kWriterPatience)) write(*line);
  }
  const auto end = std::chrono::steady_clock::now() + kFarewell;
  while (const auto line = lines_.pop(Duration::zero())) {
    const Duration left = end - std::chrono::steady_clock::now();
    if (!write_with_patience(file_, line->view(), std::max(left, Duration::zero()))) break;
  }
  heartbeat_.end();
}

/// Writes a line. Waits for the reader without limit, while the queue drops what exceeds its
/// capacity.
void LogWriter::write(const Line& line) {
  report_drops();
  std::string_view text = line.view();
  while (!closing_) {
    switch (write_part(file_, text, kWriterPatience)) {
      case Written::kAll:
        return;
      case Written::kRefused:
        ++unwritable_;
        return;
      case Written::kLater:
        heartbeat_.beat();
    }
  }
  write_with_patience(file_, text, kFarewell);
}

void LogWriter::report_drops() {
  const uint64_t drops = dropped();
  if (drops == reported_drops_) return;
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text),
                 "log: {} lines dropped because nobody read them in time; check journald\n",
                 drops - reported_drops_);
  if (write_with_patience(file_, {text.data(), text.size()}, Duration::zero())) {
    reported_drops_ = drops;
  }
}

bool write_with_patience(int file, std::string_view text, Duration patience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (true) {
    const Duration left = end - std::chrono::steady_clock::now();
    const Written written = write_part(file, text, std::max(left, Duration::zero()));
    if (written != Written::kLater) return written == Written::kAll;
    if (left <= Duration::zero()) return false;
  }
}

}  // namespace bevloc::firmware
