// Feeds random and damaged CAN frames and log lines to the CAN code.
// Usage: can_fuzz --cases N --seed S.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <map>
#include <optional>
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
#include "can/messages/vehicle_encoder.h"
#include "can/messages/vehicle_input.h"
#include "common/result.h"
#include "tests/fuzz/can_checks.h"

namespace bevloc::fuzz {
namespace {

constexpr can::GeodeticPosition kOrigin{49.0, 8.4};
constexpr double kTrack_m = 1.6;

class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {}
  size_t below(size_t end) { return std::uniform_int_distribution<size_t>(0, end - 1)(engine_); }
  uint8_t byte() { return static_cast<uint8_t>(below(256)); }
  bool one_in(size_t n) { return below(n) == 0; }

 private:
  std::mt19937_64 engine_;
};

/// A vehicle that drives in bends. It sends odometry every 20 ms and GNSS every 100 ms.
class Vehicle {
 public:
  /// The frame that it sends in this millisecond, which is at most one.
  std::optional<can::Frame> frame_at(int64_t ms) {
    const double time_s = 1e-3 * static_cast<double>(ms);
    const auto in_odometry = static_cast<size_t>(ms % can::kOdometryCycleMs);
    if (in_odometry == 0) {
      odometry_ = encoder_.odometry({.speed_mps = 8.0 + 2.0 * std::sin(0.5 * time_s),
                                     .yaw_rate_radps = 0.6 * std::cos(time_s)});
    }
    if (in_odometry < odometry_.size()) return odometry_[in_odometry];
    const auto in_gnss = static_cast<size_t>(ms % can::kGnssCycleMs) - odometry_.size();
    if (in_gnss == 0) {
      gnss_ = encoder_.gnss({.east_m = 8.0 * time_s, .sigma_east_m = 1.0, .sigma_north_m = 1.0});
    }
    if (in_gnss < gnss_.size()) return gnss_[in_gnss];
    return std::nullopt;
  }

 private:
  can::VehicleEncoder encoder_{{}, kOrigin, kTrack_m};
  std::array<can::Frame, 2> odometry_{};
  std::array<can::Frame, 3> gnss_{};
};

/// Draws frames of the project's messages, most of them with valid protection.
class FrameSource {
 public:
  FrameSource() {
    for (const can::Message* message : can::kMessages) {
      senders_.emplace(message->id({}), message->protection());
    }
  }

  /// The frame of this millisecond: the vehicle's, or any one.
  can::Frame draw(Random& random, int64_t ms) {
    std::optional<can::Frame> sent = vehicle_.frame_at(ms);
    if (!sent) return draw_any(random);
    const bool intact = ms < kIntact_ms;
    if (!intact && random.one_in(16)) fill(random, *sent);
    senders_.at(sent->id).protect(*sent);
    if (!intact) damage(random, *sent);
    return *sent;
  }

  /// A frame of any message with random content. It rarely has a message that VehicleInput reads,
  /// because many of them would be a second sender, and then no frame of the message is used.
  can::Frame draw_any(Random& random) {
    can::Frame frame;
    do {
      frame = can::blank_frame(*can::kMessages[random.below(std::size(can::kMessages))], {});
    } while (is_input(frame) && !random.one_in(64));
    fill(random, frame);
    senders_.at(frame.id).protect(frame);
    damage(random, frame);
    return frame;
  }

 private:
  /// The vehicle's frames are intact for this long. If the receiver first saw random wheels, it
  /// would learn that the wheels differ so, and refuse all odometry for a minute.
  static constexpr int64_t kIntact_ms = 5'000;

  bool is_input(const can::Frame& frame) const {
    return std::ranges::find(inputs_, frame.id) != inputs_.end();
  }

  static void fill(Random& random, can::Frame& frame) {
    for (size_t i = can::header_length(frame.format); i < frame.length; ++i) {
      if (!random.one_in(4)) frame.data[i] = random.byte();
    }
    if (random.one_in(8)) frame.data[1] = random.byte();  // the epoch
  }

  static void damage(Random& random, can::Frame& frame) {
    if (random.one_in(32)) frame.data[random.below(frame.length)] = random.byte();
  }

  std::map<uint32_t, can::E2eSender> senders_;
  const std::vector<uint32_t> inputs_ = can::VehicleInput::accepted_ids({}, false);
  Vehicle vehicle_;
};

/// A raw frame that sometimes has a length or an identifier that no kernel delivers.
canfd_frame draw_raw(Random& random, const can::Frame& frame) {
  canfd_frame raw = can::raw_from(frame).content;
  if (random.one_in(16)) raw.len = random.byte();
  if (random.one_in(16)) raw.can_id ^= 1u << random.below(32);
  return raw;
}

Status check_read(Random& random, FrameSource& source, can::VehicleInput& input,
                  can::ControllerMonitor& monitor, int64_t ms) {
  constexpr std::array<size_t, 4> kWrongSizes = {CAN_MTU, CANFD_MTU, 3, 0};
  const Time now{std::chrono::milliseconds(ms)};
  const can::Frame drawn = source.draw(random, ms);
  const size_t size =
      random.one_in(16) ? kWrongSizes[random.below(kWrongSizes.size())] : can::raw_from(drawn).size;
  const can::ReadFrame read = can::frame_from(draw_raw(random, drawn), size);
  const char* const mistake = mistake_in(read, input, monitor, now);
  if (mistake != nullptr) return fail("found {}", mistake);
  const auto* frame = std::get_if<can::Frame>(&read);
  if (frame == nullptr) return {};
  const std::string line = can::candump_line(now.time_since_epoch(), "can0", *frame);
  const auto entry = can::parse_candump_line(line, "written");
  if (!entry || entry->frame != *frame)
    return fail("log line '{}': found another frame after reading it back", line);
  return {};
}

/// A damaged log line is refused, or it is read as a frame that survives a round trip.
Status check_damaged_line(Random& random, FrameSource& source) {
  std::string line = can::candump_line(std::chrono::seconds(1), "can0", source.draw_any(random));
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

/// Fails if few frames reach the code behind the checks of protection, epochs and wheels. In 100
/// cases there are about 3 samples of odometry and 0.4 of GNSS.
Status check_samples(const can::VehicleInputCounters& counters, int64_t cases) {
  constexpr int64_t kTelling = 10'000;  // with fewer cases, chance decides
  if (cases < kTelling) return {};
  const auto least_odometry = static_cast<uint64_t>(cases / 100);
  const auto least_gnss = static_cast<uint64_t>(cases / 1000);
  if (counters.odometry_samples >= least_odometry && counters.gnss_samples >= least_gnss) return {};
  return fail("{} cases: found {} samples of odometry and {} of GNSS, wanted at least {} and {}",
              cases, counters.odometry_samples, counters.gnss_samples, least_odometry, least_gnss);
}

Status run(uint64_t seed, int64_t cases) {
  Random random(seed);
  FrameSource bus;
  FrameSource lines;
  can::VehicleInput input({}, kOrigin, kTrack_m);
  can::ControllerMonitor monitor;
  for (int64_t i = 0; i < cases; ++i) {
    Status status = check_read(random, bus, input, monitor, i);
    if (status) status = check_damaged_line(random, lines);
    if (!status) return fail("seed {}, case {}: {}", seed, i, status.error().message);
  }
  const can::VehicleInputCounters counters = input.counters();
  fmt::print("{} cases: {} samples of odometry, {} of GNSS, {} wrong CRCs, {} wrong lengths\n",
             cases, counters.odometry_samples, counters.gnss_samples, counters.wrong_crc,
             counters.wrong_length);
  if (Status status = check_samples(counters, cases); !status) {
    return fail("seed {}, {}", seed, status.error().message);
  }
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
