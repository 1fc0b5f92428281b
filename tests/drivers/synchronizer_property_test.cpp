// Property tests of the synchronizer with random frames: properties that always hold, and the
// number of each injected fault.
#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/frameset/synchronizer.h"
#include "sim/random.h"

namespace bevloc::drivers {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr Duration kExposurePeriod = milliseconds(100);
constexpr SynchronizerConfig kConfig{
    .tolerance = milliseconds(2), .wait = milliseconds(60), .min_cameras = 1};

struct Arrival {
  Time now;
  int camera = 0;
  Time time;
};

Frame frame_of(const Arrival& arrival) {
  Frame frame;
  frame.camera = arrival.camera;
  frame.time = arrival.time;
  return frame;
}

/// Adds arrivals in order, polls every millisecond in between, and keeps the emitted framesets.
class Feeder {
 public:
  explicit Feeder(const SynchronizerConfig& config) : synchronizer_(config) {}

  void feed(std::vector<Arrival> arrivals) {
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const Arrival& a, const Arrival& b) { return a.now < b.now; });
    for (const Arrival& arrival : arrivals) {
      poll_until(arrival.now);
      synchronizer_.add(frame_of(arrival), arrival.now);
      poll(arrival.now);
    }
    poll_until(now_ + kExposurePeriod);
  }

  const std::vector<Frameset>& sets() const { return sets_; }
  const FramesetSynchronizer& synchronizer() const { return synchronizer_; }

 private:
  void poll_until(Time end) {
    for (; now_ < end; now_ += milliseconds(1)) poll(now_);
  }
  void poll(Time now) {
    while (auto set = synchronizer_.poll(now)) sets_.push_back(std::move(*set));
  }

  FramesetSynchronizer synchronizer_;
  std::vector<Frameset> sets_;
  Time now_{};
};

void expect_valid_sets(const std::vector<Frameset>& sets, const SynchronizerConfig& config) {
  std::set<std::pair<int, Time>> seen;
  Time previous = Time::min();
  for (const Frameset& set : sets) {
    EXPECT_GT(set.time, previous);
    previous = set.time;
    EXPECT_GE(static_cast<int>(set.present.count()), config.min_cameras);
    EXPECT_LE(set.spread, config.tolerance);
    Time earliest = Time::max();
    Time latest = Time::min();
    for (int camera = 0; camera < kCameraCount; ++camera) {
      if (!set.present[camera]) continue;
      const Frame& frame = set.frames[camera];
      EXPECT_EQ(frame.camera, camera);
      EXPECT_TRUE(seen.emplace(camera, frame.time).second) << "one frame in two framesets";
      earliest = std::min(earliest, frame.time);
      latest = std::max(latest, frame.time);
    }
    EXPECT_EQ(set.time, earliest);
    EXPECT_EQ(set.spread, latest - earliest);
  }
}

void expect_all_accounted_for(const FramesetSynchronizer& synchronizer) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const SynchronizerCounters& c = synchronizer.counters(camera);
    EXPECT_EQ(c.added, c.emitted + c.duplicate + c.out_of_order + c.late + c.future + c.overflow +
                           c.unmatched);
  }
}

class SynchronizerProperty : public testing::TestWithParam<uint64_t> {};

TEST_P(SynchronizerProperty, AnyFramesGiveValidSets) {
  sim::Random random(GetParam());
  const SynchronizerConfig config{.tolerance = milliseconds(random.integer(0, 40)),
                                  .wait = milliseconds(random.integer(40, 120)),
                                  .min_cameras = random.integer(1, kCameraCount)};
  std::vector<Arrival> arrivals;
  for (int i = 0; i < 800; ++i) {
    const Time time(milliseconds(random.integer(0, 5000)));
    const Duration delay = milliseconds(random.integer(-5, 150));
    arrivals.push_back({std::max(Time{}, time + delay), random.integer(0, kCameraCount - 1), time});
  }
  Feeder feeder(config);
  feeder.feed(arrivals);
  expect_valid_sets(feeder.sets(), config);
  expect_all_accounted_for(feeder.synchronizer());
}

enum class Injected { kNone, kDrop, kLate, kDuplicate, kOutOfOrder, kFuture };

struct Expected {
  uint64_t missing = 0;
  uint64_t late = 0;
  uint64_t duplicate = 0;
  uint64_t out_of_order = 0;
  uint64_t future = 0;
};

/// Generates the arrivals of one camera at 10 Hz with at most 2 ms of jitter and with random
/// faults.
std::vector<Arrival> arrivals_with_faults(sim::Random& random, int camera, int periods,
                                          Expected& expected) {
  std::vector<Arrival> arrivals;
  int missed_in_a_row = 0;
  Time newest{};
  for (int k = 1; k <= periods; ++k) {
    const Time trigger = Time(k * kExposurePeriod);
    const Time time = trigger + microseconds(random.integer(0, 2000));
    const Time usual = time + milliseconds(20) + microseconds(random.integer(0, 15000));
    Injected fault = Injected::kNone;
    // Camera 0 has no faults, so that every frameset exists. No camera is missing so often in a row
    // that the synchronizer stops waiting for it.
    if (camera > 0 && missed_in_a_row < FramesetSynchronizer::kPatience - 1 && random.chance(0.3)) {
      fault = static_cast<Injected>(random.integer(1, 5));
    }
    const bool misses = fault != Injected::kNone && fault != Injected::kDuplicate;
    missed_in_a_row = misses ? missed_in_a_row + 1 : 0;
    expected.missing += misses ? 1 : 0;
    switch (fault) {
      case Injected::kNone:
        arrivals.push_back({usual, camera, time});
        break;
      case Injected::kDrop:
        break;
      case Injected::kLate:
        arrivals.push_back({trigger + milliseconds(random.integer(65, 95)), camera, time});
        ++expected.late;
        break;
      case Injected::kDuplicate:
        arrivals.push_back({usual, camera, time});
        arrivals.push_back({usual + milliseconds(random.integer(0, 60)), camera, time});
        ++expected.duplicate;
        break;
      case Injected::kOutOfOrder:
        // Instead of this frame, one arrives that is older than the camera's latest frame.
        if (newest == Time{}) break;
        arrivals.push_back({usual, camera, newest - microseconds(random.integer(1, 90'000))});
        ++expected.out_of_order;
        break;
      case Injected::kFuture:
        arrivals.push_back({usual, camera, usual + milliseconds(random.integer(1, 100'000))});
        ++expected.future;
        break;
    }
    if (fault == Injected::kNone || fault == Injected::kDuplicate || fault == Injected::kLate) {
      newest = time;
    }
  }
  return arrivals;
}

TEST_P(SynchronizerProperty, EachFaultIsCountedOnce) {
  constexpr int kPeriods = 150;
  sim::Random random(GetParam());
  std::vector<Arrival> arrivals;
  std::array<Expected, kCameraCount> expected;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const auto of_camera = arrivals_with_faults(random, camera, kPeriods, expected[camera]);
    arrivals.insert(arrivals.end(), of_camera.begin(), of_camera.end());
  }
  Feeder feeder(kConfig);
  feeder.feed(arrivals);
  EXPECT_EQ(feeder.sets().size(), static_cast<size_t>(kPeriods));
  expect_valid_sets(feeder.sets(), kConfig);
  expect_all_accounted_for(feeder.synchronizer());
  for (int camera = 0; camera < kCameraCount; ++camera) {
    SCOPED_TRACE(kCameraNames[camera]);
    const SynchronizerCounters& counters = feeder.synchronizer().counters(camera);
    EXPECT_EQ(counters.missing, expected[camera].missing);
    EXPECT_EQ(counters.late, expected[camera].late);
    EXPECT_EQ(counters.duplicate, expected[camera].duplicate);
    EXPECT_EQ(counters.out_of_order, expected[camera].out_of_order);
    EXPECT_EQ(counters.future, expected[camera].future);
    EXPECT_EQ(counters.overflow + counters.unmatched, 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, SynchronizerProperty, testing::Range<uint64_t>(0, 30));

}  // namespace
}  // namespace bevloc::drivers
