// Authentication of the vehicle's messages and of the localizer's.
#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "can/messages/vehicle_encoder.h"
#include "can/publisher/pose_publisher.h"
#include "can/secoc/secoc_receiver.h"
#include "can/secoc/secoc_sender.h"
#include "tests/can/e2e/test_frames.h"
#include "tests/can/messages/tracking_report.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;
using test::flip;
using test::kNow;
using test::kOrigin;
using test::tracking_report;

constexpr SecocKey kKey = {0x2b, 0x7e, 0x15, 0x16, 0x28, 0xae, 0xd2, 0xa6,
                           0xab, 0xf7, 0x15, 0x88, 0x09, 0xcf, 0x4f, 0x3c};
constexpr SecocKey kOtherKey = {1};

/// A vehicle that authenticates its messages.
class SecureVehicle {
 public:
  SecureVehicle(const SecocKey& key, uint32_t start) : secoc_(Cmac::create(key).value(), start) {}

  std::vector<Frame> odometry() {
    return with_authentication(encoder_.odometry({.speed_mps = 10.0, .yaw_rate_radps = 0.05}),
                               veh_odometry_authentication::kMessage, odometry_sender_);
  }
  std::vector<Frame> gnss() {
    return with_authentication(encoder_.gnss({.sigma_east_m = 1.0, .sigma_north_m = 1.0}),
                               veh_gnss_authentication::kMessage, gnss_sender_);
  }
  Frame freshness() {
    Frame frame = secoc_.freshness(veh_freshness::kMessage, BaseIds{});
    freshness_sender_.protect(frame);
    return frame;
  }

 private:
  template <size_t kCount>
  std::vector<Frame> with_authentication(const std::array<Frame, kCount>& frames,
                                         const Message& message, E2eSender& sender) {
    std::vector<Frame> all(frames.begin(), frames.end());
    Frame authentication = secoc_.authenticate(message, frames, BaseIds{});
    insert_raw(authentication, kEpoch, extract_raw(frames[0], kEpoch));
    sender.protect(authentication);
    all.push_back(authentication);
    return all;
  }

  VehicleEncoder encoder_{BaseIds{}, kOrigin, 1.6};
  SecocSender secoc_;
  E2eSender odometry_sender_{veh_odometry_authentication::kMessage.protection()};
  E2eSender gnss_sender_{veh_gnss_authentication::kMessage.protection()};
  E2eSender freshness_sender_{veh_freshness::kMessage.protection()};
};

class SecocTest : public testing::Test {
 protected:
  /// Returns the number of frames that were let through.
  size_t feed(const std::vector<Frame>& frames) { return feed(receiver_, frames, kNow); }
  static size_t feed(SecocReceiver& receiver, const std::vector<Frame>& frames, Time now) {
    size_t passed = 0;
    for (const Frame& frame : frames) passed += receiver.accept({frame, now}).size();
    return passed;
  }

  SecureVehicle vehicle_{kKey, 1};
  /// A receiver that does not listen before it accepts frames.
  SecocReceiver receiver_{Cmac::create(kKey).value(), BaseIds{}, Duration::zero()};
};

/// A receiver that has just started, on a bus with the vehicle, which started for the second time,
/// and somebody who replays its first start.
class SecocStartTest : public SecocTest {
 protected:
  SecocStartTest() {
    for (int i = 0; i < kCycles; ++i) recorded_.push_back(old_.odometry());
  }

  /// Runs for two seconds. `attack` may send frames after each announcement of the vehicle.
  /// Returns the number of frames that were let through: of the vehicle, and replayed ones.
  struct Passed {
    size_t genuine = 0;
    size_t replayed = 0;
  };
  template <typename Attack>
  Passed run(const Attack& attack) {
    Passed passed;
    for (int cycle = 0; cycle < kCycles; ++cycle) {
      const Time now = kNow + milliseconds(20 * cycle);
      if (cycle % 5 == 0) {
        feed(receiver_, {vehicle_.freshness()}, now);
        attack(now);
      }
      passed.genuine += feed(receiver_, vehicle_.odometry(), now);
      passed.replayed += feed(receiver_, recorded_[static_cast<size_t>(cycle)], now);
    }
    return passed;
  }

  static constexpr int kCycles = 100;
  SecureVehicle old_{kKey, 1};
  SecureVehicle vehicle_{kKey, 2};
  std::vector<std::vector<Frame>> recorded_;
  SecocReceiver receiver_{Cmac::create(kKey).value(), BaseIds{}};
};

TEST_F(SecocStartTest, ListensForHalfASecond) {
  const Passed passed = run([](Time) {});
  EXPECT_EQ(passed.genuine, 2U * (kCycles - 25));
  EXPECT_EQ(passed.replayed, 0U);
  EXPECT_EQ(receiver_.counters().no_freshness, 2U * 25);
}

TEST_F(SecocStartTest, AnOldAnnouncementAfterEachGenuineOneDoesNotLetAReplayPass) {
  const Frame old = old_.freshness();
  const Passed passed = run([&](Time now) { feed(receiver_, {old}, now); });
  EXPECT_EQ(passed.genuine, 2U * (kCycles - 25));
  EXPECT_EQ(passed.replayed, 0U);
}

TEST_F(SecocStartTest, AFloodOfAnnouncementsLetsNothingPass) {
  const Passed passed = run([&](Time now) {
    for (uint32_t start = 10; start < 20; ++start) {
      feed(receiver_, {SecureVehicle(kOtherKey, start).freshness()}, now);
    }
    feed(receiver_, {old_.freshness()}, now);
  });
  EXPECT_EQ(passed.replayed, 0U);
}

TEST_F(SecocTest, LetsAuthenticFramesThroughUnchanged) {
  feed({vehicle_.freshness()});
  for (int i = 0; i < 70000; ++i) {  // the lower bits of the freshness value overflow
    if (i % 5 == 0) feed({vehicle_.freshness()});
    const auto frames = vehicle_.odometry();
    ASSERT_EQ(receiver_.accept({frames[0], kNow}).size(), 0u);
    ASSERT_EQ(receiver_.accept({frames[1], kNow}).size(), 0u);
    const auto passed = receiver_.accept({frames[2], kNow});
    ASSERT_EQ(passed.size(), 2u) << i;
    ASSERT_EQ(passed[0].frame, frames[0]);
    ASSERT_EQ(passed[1].frame, frames[1]);
  }
  EXPECT_EQ(feed(vehicle_.gnss()), 3u);
  EXPECT_EQ(receiver_.counters().wrong_mac, 0u);
}

TEST_F(SecocTest, EveryChangedBitIsRefused) {
  feed({vehicle_.freshness()});
  const auto refuses_changes = [this](const auto& next_epoch) {
    const std::vector<Frame> unchanged = next_epoch();
    const size_t members = unchanged.size() - 1;
    for (size_t changed = 0; changed <= members; ++changed) {
      for (int bit = 0; bit < 8 * unchanged[changed].length; ++bit) {
        std::vector<Frame> frames = next_epoch();
        flip(frames[changed], bit);
        // The code does not cover CHECKSUM and COUNTER of the authentication itself.
        const bool covered = changed < members || bit >= kEpoch.start_bit;
        EXPECT_EQ(feed(frames), covered ? 0u : members) << "frame " << changed << ", bit " << bit;
      }
    }
  };
  refuses_changes([this] { return vehicle_.odometry(); });
  refuses_changes([this] { return vehicle_.gnss(); });
}

/// Only a code that was computed elsewhere shows which bytes it covers, and in which order. This
/// command gives 5CA3506A..., of which the first byte is the lowest of the signal:
///   printf 460123456789abcdef040006102132435465040104768798a9 | xxd -r -p |
///     openssl mac -cipher AES-128-CBC -macopt hexkey:2b7e151628aed2a6abf7158809cf4f3c CMAC
/// The input has E2EDataId 46, the freshness value, and the two frames.
TEST(Authenticator, GivesTheCodeThatOpensslGives) {
  const Frame frames[] = {
      {.id = 0x400, .length = 6, .data = {0x10, 0x21, 0x32, 0x43, 0x54, 0x65}},
      {.id = 0x401, .length = 4, .data = {0x76, 0x87, 0x98, 0xa9}},
  };
  EXPECT_EQ(Authenticator(Cmac::create(kKey).value())
                .mac(veh_odometry_authentication::kMessage, 0x0123456789abcdef, frames),
            0x6a50a35cu);
}

TEST_F(SecocTest, FramesOfAForgerWithoutTheKeyAreRefused) {
  feed({vehicle_.freshness()});
  SecureVehicle forger(kOtherKey, 1);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(feed(forger.odometry()), 0u);
  EXPECT_EQ(receiver_.counters().wrong_mac, 200u);
  EXPECT_EQ(feed(vehicle_.odometry()), 2u);
}

TEST_F(SecocTest, AForgedFreshnessDoesNotStopTheVehicle) {
  feed({vehicle_.freshness()});
  EXPECT_EQ(feed(vehicle_.odometry()), 2u);
  feed({SecureVehicle(kOtherKey, 4000000000u).freshness()});
  EXPECT_EQ(feed(vehicle_.odometry()), 2u);
}

TEST_F(SecocTest, AReplayIsRefused) {
  feed({vehicle_.freshness()});
  std::vector<std::vector<Frame>> recorded;
  for (int i = 0; i < 80; ++i) {
    recorded.push_back(vehicle_.odometry());
    EXPECT_EQ(feed(recorded.back()), 2u);
  }
  for (const auto& frames : recorded) EXPECT_EQ(feed(frames), 0u);
  EXPECT_EQ(receiver_.counters().wrong_mac, 80u);
  EXPECT_EQ(feed(vehicle_.odometry()), 2u);
}

TEST_F(SecocTest, ARestartedVehicleIsUsedAndItsOldFramesAreNot) {
  feed({vehicle_.freshness()});
  const auto old = vehicle_.odometry();
  EXPECT_EQ(feed(old), 2u);
  SecureVehicle restarted(kKey, 2);
  feed({restarted.freshness()});
  EXPECT_EQ(feed(restarted.odometry()), 2u);
  feed({vehicle_.freshness()});
  EXPECT_EQ(feed(old), 0u);
  EXPECT_EQ(feed(vehicle_.odometry()), 0u) << "the earlier start is over";
}

TEST_F(SecocTest, FramesWithoutAuthenticationAreHeldBack) {
  EXPECT_EQ(feed(vehicle_.odometry()), 0u) << "no freshness value yet";
  EXPECT_EQ(receiver_.counters().no_freshness, 1u);
  feed({vehicle_.freshness()});
  auto frames = vehicle_.odometry();
  frames.pop_back();
  EXPECT_EQ(feed(frames), 0u);
  frames = vehicle_.odometry();
  frames.erase(frames.begin());
  EXPECT_EQ(feed(frames), 0u);
  EXPECT_EQ(receiver_.counters().incomplete, 2u);
  const Frame other = blank_frame(loc_status::kMessage, BaseIds{});
  EXPECT_EQ(feed({other}), 1u) << "what needs no authentication passes";
}

TEST_F(SecocTest, CountsFramesOfWrongLengthAndBadAnnouncements) {
  for (std::vector<Frame> frames : {vehicle_.odometry(), vehicle_.gnss(), {vehicle_.freshness()}}) {
    for (Frame& frame : frames) --frame.length;
    EXPECT_EQ(feed(frames), 0u);
  }
  EXPECT_EQ(receiver_.counters().wrong_length, 3u + 4u + 1u);
  Frame damaged = vehicle_.freshness();
  damaged.data[4] ^= 1;
  feed({damaged});
  EXPECT_EQ(receiver_.counters().bad_announcements, 1u);
  EXPECT_EQ(receiver_.counters().incomplete, 0u);
}

TEST_F(SecocTest, OdometryMayOvertakeGnss) {
  feed({vehicle_.freshness()});
  for (int i = 0; i < 70000; ++i) {  // the lower bits of the freshness value overflow
    if (i % 50 == 0) feed({vehicle_.freshness()});
    const auto gnss = vehicle_.gnss();
    ASSERT_EQ(feed(vehicle_.odometry()), 2u) << i;
    ASSERT_EQ(feed(gnss), 3u) << i;
    ASSERT_EQ(feed(gnss), 0u) << "a replay, " << i;
  }
  EXPECT_EQ(receiver_.counters().wrong_mac, 70000u) << "the replays";
}

TEST_F(SecocTest, GnssThatWasHeldBackForLongIsRefused) {
  feed({vehicle_.freshness()});
  for (const int overtaking : {8, 9}) {
    const auto gnss = vehicle_.gnss();
    for (int i = 0; i < overtaking; ++i) EXPECT_EQ(feed(vehicle_.odometry()), 2u);
    EXPECT_EQ(feed(gnss), overtaking == 8 ? 3u : 0u) << overtaking;
  }
}

TEST_F(SecocTest, GnssOfAnEarlierStartIsRefusedThoughNoLaterOneCame) {
  feed({vehicle_.freshness()});
  const auto old = vehicle_.gnss();
  SecureVehicle restarted(kKey, 2);
  feed({restarted.freshness()});
  EXPECT_EQ(feed(restarted.odometry()), 2u);
  EXPECT_EQ(feed(old), 0u);
}

/// Checks an epoch of the localizer as a receiver that has seen LOC_Freshness does.
bool is_authentic(const std::map<uint32_t, Frame>& frames) {
  std::vector<Frame> members;
  std::optional<Frame> authentication;
  std::optional<Frame> freshness;
  for (const auto& [id, frame] : frames) {
    if (id == loc_authentication::kMessage.id(BaseIds{})) {
      authentication = frame;
    } else if (id == loc_freshness::kMessage.id(BaseIds{})) {
      freshness = frame;
    } else if (id != loc_clock::kMessage.id(BaseIds{})) {
      members.push_back(frame);
    }
  }
  if (!authentication || !freshness) return false;
  const auto value = static_cast<uint64_t>(extract_raw(*freshness, secoc::kFreshnessHigh)) << 16U |
                     static_cast<uint64_t>(extract_raw(*authentication, secoc::kFreshnessLow));
  return Authenticator(Cmac::create(kKey).value())
             .mac(loc_authentication::kMessage, value, members) ==
         static_cast<uint32_t>(extract_raw(*authentication, secoc::kMac));
}

/// Whether is_authentic() depends on this bit. It does not depend on LOC_Clock, and not on the E2E
/// header of the frames that authenticate the others.
bool is_covered(uint32_t id, int bit) {
  if (id == loc_clock::kMessage.id(BaseIds{})) return false;
  const bool authenticates = id == loc_authentication::kMessage.id(BaseIds{}) ||
                             id == loc_freshness::kMessage.id(BaseIds{});
  return !authenticates || bit >= secoc::kFreshnessLow.start_bit;
}

void expect_each_covered_bit_counts(std::map<uint32_t, Frame> frames) {
  for (auto& [id, frame] : frames) {
    for (int bit = 0; bit < 8 * frame.length; ++bit) {
      flip(frame, bit);
      EXPECT_NE(is_authentic(frames), is_covered(id, bit)) << "frame " << id << ", bit " << bit;
      flip(frame, bit);
    }
  }
}

TEST_F(SecocTest, TheLocalizerAuthenticatesEachEpochOfBothVariants) {
  for (const FrameFormat format : {FrameFormat::kClassic, FrameFormat::kFd}) {
    MockWire wire;
    const auto sender = wire.connect();
    const auto reader = wire.connect();
    PosePublisher publisher(*sender,
                            {.map_origin = kOrigin, .format = format, .sends_clock = true});
    publisher.authenticate(SecocSender(Cmac::create(kKey).value(), 7));
    std::map<uint32_t, Frame> frames;
    for (int cycle = 0; cycle < 30; ++cycle) {
      const Time now = kNow + milliseconds(10 * cycle);
      publisher.publish(tracking_report(now), now);
      std::optional<Frame> freshness;
      const auto found = frames.find(loc_freshness::kMessage.id(BaseIds{}));
      if (found != frames.end()) freshness = found->second;
      frames.clear();
      if (freshness) frames[freshness->id] = *freshness;
      while (const auto received = reader->receive()) frames[received->frame.id] = received->frame;
      EXPECT_TRUE(is_authentic(frames)) << cycle;
      if (cycle % 10 == 0) expect_each_covered_bit_counts(frames);
    }
    const auto ids = PosePublisher::sent_ids(BaseIds{}, format, true, true);
    for (const auto& [id, frame] : frames) EXPECT_TRUE(std::ranges::count(ids, id)) << id;
  }
}

}  // namespace
}  // namespace bevloc::can
