// The CAN bus: frames as a socket delivers them, and logs of frames.
#include <array>
#include <cstring>
#include <sstream>
#include <vector>

#include "can/bus/candump.h"
#include "can/bus/socketcan_codec.h"
#include "can/dbc/dbc.h"
#include "can/e2e/e2e.h"
#include "can/messages/message_table.h"
#include "tests/fuzz/can_checks.h"
#include "tests/fuzz/targets.h"

namespace bevloc::fuzz {
namespace {

/// Takes the input apart from its front. Reads as zero beyond its end.
class Source {
 public:
  explicit Source(Bytes bytes) : bytes_(bytes) {}
  bool is_empty() const { return bytes_.empty(); }
  uint8_t byte() {
    if (bytes_.empty()) return 0;
    const uint8_t value = bytes_[0];
    bytes_ = bytes_.subspan(1);
    return value;
  }
  void fill(uint8_t* target, size_t count) {
    for (size_t i = 0; i < count; ++i) target[i] = byte();
  }

 private:
  Bytes bytes_;
};

/// Draws frames: raw ones, and ones of the project's messages with valid protection.
class FrameReader {
 public:
  FrameReader() {
    for (const can::Message* message : can::kMessages) senders_.emplace_back(message->protection());
  }

  can::ReadFrame next(Source& source) {
    constexpr std::array<size_t, 4> kSizes = {CAN_MTU, CANFD_MTU, 3, 0};
    const uint8_t choice = source.byte();
    if (choice < 64) {
      canfd_frame raw{};
      source.fill(reinterpret_cast<uint8_t*>(&raw), sizeof(raw));
      return can::frame_from(raw, kSizes[choice % kSizes.size()]);
    }
    const size_t index = choice % senders_.size();
    const can::Message& message = *can::kMessages[index];
    can::Frame frame = can::blank_frame(message, {});
    const size_t header = can::header_length(message.format);
    source.fill(frame.data.data() + header, frame.length - header);
    frame.data[1] = choice & 0xF0U;  // the epoch; protect() writes the lower half
    senders_[index].protect(frame);
    return frame;
  }

 private:
  std::vector<can::E2eSender> senders_;
};

void check_round_trip(const can::CandumpEntry& entry) {
  if (entry.kind != can::CandumpKind::kData || entry.time.count() < 0) return;
  const std::string line = can::candump_line(entry.time, entry.interface, entry.frame);
  const auto again = can::parse_candump_line(line, "again");
  expect(again && again->frame == entry.frame, "another frame after writing a line");
}

}  // namespace

void run_can_frames(Bytes bytes) {
  can::VehicleInput input({}, {49.0, 8.4}, 1.6);
  can::ControllerMonitor monitor;
  FrameReader reader;
  Source source(bytes);
  Time now{};
  while (!source.is_empty()) {
    now += std::chrono::milliseconds(1);
    const can::ReadFrame read = reader.next(source);
    const char* const mistake = mistake_in(read, input, monitor, now);
    expect(mistake == nullptr, mistake);
  }
}

void run_candump(Bytes bytes) {
  std::istringstream log{std::string(text_of(bytes))};
  const auto entries = can::read_candump(log, "fuzz.log");
  if (!entries) return;
  for (const can::CandumpEntry& entry : *entries) check_round_trip(entry);
}

/// Every signal of an accepted file can be read from a frame of its message.
void run_dbc(Bytes bytes) {
  const auto dbc = can::parse_dbc(text_of(bytes), "fuzz.dbc");
  if (!dbc) return;
  const std::array<uint8_t, can::kMaxFdLength> zeros{};
  for (const can::DbcMessage& message : dbc->messages) {
    expect(message.length <= can::kMaxFdLength, "a message that is too long");
    const std::span<const uint8_t> frame(zeros.data(), message.length);
    for (const can::DbcSignal& signal : message.signals) {
      expect(can::bytes_needed(signal.layout) <= message.length, "a signal beyond its message");
      const double value = can::physical_from(signal.layout, frame);
      expect(value == signal.layout.offset, "a signal of zeros that is not its offset");
      const bool has_multiplexor = message.nested_multiplexing || message.multiplexor() != nullptr;
      expect(signal.multiplexed_at.empty() || has_multiplexor, "a signal without its multiplexor");
    }
  }
}

}  // namespace bevloc::fuzz
