// Feeds random and damaged CAN frames and log lines to the CAN code.
// Usage: can_fuzz --cases N --seed S.
#include <array>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "can/bus/candump.h"
#include "can/bus/controller_monitor.h"
#include "can/bus/socketcan_codec.h"
#include "can/e2e/e2e.h"
#include "can/messages/message_table.h"
#include "can/messages/vehicle_input.h"
#include "can/publisher/solution_fd.h"
#include "common/result.h"
#include "tests/fuzz/finite_samples.h"

namespace bevloc::fuzz {
namespace {

class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {}
  size_t below(size_t end) { return std::uniform_int_distribution<size_t>(0, end - 1)(engine_); }
  uint8_t byte() { return static_cast<uint8_t>(below(256)); }
  bool one_in(size_t n) { return below(n) == 0; }

 private:
  std::mt19937_64 engine_;
};

/// Draws frames of the project's messages, most of them with valid protection.
class FrameSource {
 public:
  FrameSource() {
    for (const can::Message* message : can::kMessages) senders_.emplace_back(message->protection());
  }

  can::Frame draw(Random& random) {
    const size_t index = random.below(senders_.size());
    const can::Message& message = *can::kMessages[index];
    can::Frame frame = can::blank_frame(message, {});
    for (size_t i = can::header_length(message.format); i < frame.length; ++i) {
      if (!random.one_in(4)) frame.data[i] = random.byte();
    }
    if (random.one_in(8)) frame.data[1] = random.byte();
    if (!random.one_in(8)) senders_[index].protect(frame);
    return frame;
  }

 private:
  std::vector<can::E2eSender> senders_;
};

/// A raw frame that sometimes has a length or an identifier that no kernel delivers.
canfd_frame draw_raw(Random& random, const can::Frame& frame) {
  canfd_frame raw = can::raw_from(frame).content;
  if (random.one_in(16)) raw.len = random.byte();
  if (random.one_in(16)) raw.can_id ^= 1u << random.below(32);
  return raw;
}

Status check_read(Random& random, FrameSource& source, can::VehicleInput& input,
                  can::ControllerMonitor& monitor, Time now) {
  constexpr std::array<size_t, 4> kWrongSizes = {CAN_MTU, CANFD_MTU, 3, 0};
  const can::Frame drawn = source.draw(random);
  const size_t size =
      random.one_in(16) ? kWrongSizes[random.below(kWrongSizes.size())] : can::raw_from(drawn).size;
  const can::ReadFrame read = can::frame_from(draw_raw(random, drawn), size);
  if (const auto* error = std::get_if<can::ErrorFrame>(&read)) monitor.take(*error);
  const auto* frame = std::get_if<can::Frame>(&read);
  if (frame == nullptr) return {};
  if (!can::is_valid_length(frame->format, frame->length))
    return fail("found a frame of invalid length");
  if (!is_finite(input.accept({*frame, now}))) return fail("found a sample that is not finite");
  if (frame->length == can::loc_solution::kMessage.length) {
    for (size_t part = 0; part < can::loc_solution::kParts.size(); ++part) {
      can::part_of_solution(*frame, part, {});
    }
  }
  const std::string line = can::candump_line(now.time_since_epoch(), "can0", *frame);
  const auto entry = can::parse_candump_line(line, "written");
  if (!entry || entry->frame != *frame)
    return fail("log line '{}': found another frame after reading it back", line);
  return {};
}

/// A damaged log line is refused, or it is read as a frame that survives a round trip.
Status check_damaged_line(Random& random, FrameSource& source) {
  std::string line = can::candump_line(std::chrono::seconds(1), "can0", source.draw(random));
  for (size_t damage = 1 + random.below(3); damage > 0; --damage) {
    const size_t place = random.below(line.size());
    if (random.one_in(3)) {
      line.erase(place, 1 + random.below(4));
    } else {
      line[place] = "0123456789ABCDEFabcdef#R_() .\xFF"[random.below(30)];
    }
    if (line.empty()) return {};
  }
  const auto entry = can::parse_candump_line(line, "damaged");
  if (!entry || entry->kind != can::CandumpKind::kData) return {};
  const auto again =
      can::parse_candump_line(can::candump_line(entry->time, entry->interface, entry->frame), "");
  if (!again || again->frame != entry->frame)
    return fail("damaged log line '{}': found another frame after a round trip", line);
  return {};
}

Status run(uint64_t seed, int64_t cases) {
  Random random(seed);
  FrameSource source;
  can::VehicleInput input({}, {49.0, 8.4}, 1.6);
  can::ControllerMonitor monitor;
  for (int64_t i = 0; i < cases; ++i) {
    const Time now{std::chrono::milliseconds(i)};
    Status status = check_read(random, source, input, monitor, now);
    if (status) status = check_damaged_line(random, source);
    if (!status) return fail("seed {}, case {}: {}", seed, i, status.error().message);
  }
  const can::VehicleInputCounters counters = input.counters();
  fmt::print("{} cases: {} samples, {} wrong CRCs, {} wrong lengths\n", cases,
             counters.odometry_samples + counters.gnss_samples, counters.wrong_crc,
             counters.wrong_length);
  return {};
}

}  // namespace
}  // namespace bevloc::fuzz

int main(int argc, char** argv) {
  CLI::App app("Feeds random and damaged frames and log lines to the CAN code.");
  int64_t cases = 100'000;
  uint64_t seed = 1;
  app.add_option("--cases", cases)->capture_default_str();
  app.add_option("--seed", seed)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const bevloc::Status status = bevloc::fuzz::run(seed, cases);
  if (!status) fmt::print(stderr, "{}\n", status.error().message);
  return status ? 0 : 1;
}
