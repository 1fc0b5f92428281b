// Tests health check, metrics, status and latency histogram.
#include "firmware/status/telemetry.h"

#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "firmware/status/metrics.h"
#include "firmware/status/status_json.h"
#include "tests/firmware/status/running_telemetry.h"
#include "tests/support/text.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;
using testing::Not;

/// The telemetry of an appliance that has every device.
Telemetry with_every_device() {
  Telemetry telemetry = running(HealthState::kTracking, Why::kMatchUncertain);
  telemetry.snapshot.authentication.emplace();
  telemetry.snapshot.trigger.emplace();
  telemetry.snapshot.gnss.emplace();
  telemetry.snapshot.recording.emplace();
  return telemetry;
}

std::string metrics(const Telemetry& telemetry) {
  return metrics_text(telemetry, {1e6, 2.5}, {});
}

TEST(LatencyHistogram, CountsInRanges) {
  LatencyHistogram histogram;
  EXPECT_EQ(histogram.counts().quantile_ms(0.5), 0.0);
  for (const int latency_ms : {5, 10, 25, 25, 2000}) histogram.add(milliseconds(latency_ms));
  const LatencyCounts counts = histogram.counts();
  EXPECT_EQ(counts.total(), 5u);
  EXPECT_EQ(counts.in_range[0], 2u);  // a limit belongs to the range below it
  EXPECT_EQ(counts.in_range[2], 2u);
  EXPECT_EQ(counts.in_range.back(), 1u);
  EXPECT_EQ(counts.sum, milliseconds(2065));
  EXPECT_EQ(counts.quantile_ms(0.4), 10.0);
  EXPECT_EQ(counts.quantile_ms(0.6), 25.0);
  EXPECT_EQ(counts.quantile_ms(1.0), LatencyCounts::kUpper_ms.back());
}

TEST(HealthCheck, IsGoodWithAValidPose) {
  EXPECT_TRUE(check_health(running(HealthState::kTracking), Duration{}).good);
  const HealthCheck degraded =
      check_health(running(HealthState::kDegraded, Why::kGnssMissing), Duration{});
  EXPECT_TRUE(degraded.good);
  EXPECT_THAT(degraded.reason, HasSubstr("DEGRADED: GNSS missing: Check the antenna"));
}

TEST(HealthCheck, IsBadWhenLostAndInFault) {
  EXPECT_FALSE(check_health(running(HealthState::kLost, Why::kPoseStale), Duration{}).good);
  EXPECT_FALSE(check_health(running(HealthState::kFault, Why::kNetworkFault), Duration{}).good);
}

TEST(HealthCheck, AStartIsGoodUntilAnInputIsMissing) {
  EXPECT_TRUE(check_health(Telemetry{}, Duration{}).good);
  EXPECT_TRUE(check_health(running(HealthState::kInit, Why::kNoInitialPose), Duration{}).good);
  EXPECT_TRUE(
      check_health(running(HealthState::kAcquiring, Why::kMatchUncertain), Duration{}).good);
  EXPECT_FALSE(check_health(running(HealthState::kInit, Why::kOdometryMissing), Duration{}).good);
}

TEST(HealthCheck, IsBadBeforeThePoseIsValidIfSomebodyHasToHelp) {
  for (const Why reason : {Why::kCameraMissing, Why::kCamerasUnsynchronized, Why::kGnssMissing,
                           Why::kOdometryImplausible, Why::kForeignSender, Why::kCalibrationFault,
                           Why::kOutsideMap, Why::kMapFault}) {
    for (const HealthState state : {HealthState::kInit, HealthState::kAcquiring}) {
      EXPECT_FALSE(check_health(running(state, reason), Duration{}).good) << words_of(reason);
    }
  }
}

TEST(HealthCheck, IsBadWhileALostPoseIsNotFoundAgain) {
  Telemetry telemetry = running(HealthState::kAcquiring, Why::kMatchUncertain);
  telemetry.snapshot.estimation.invalid_since = Time(seconds(100));
  telemetry.time = Time(seconds(110));
  EXPECT_TRUE(check_health(telemetry, Duration{}).good);
  telemetry.time = Time(seconds(112));
  const HealthCheck health = check_health(telemetry, Duration{});
  EXPECT_FALSE(health.good);
  EXPECT_THAT(health.reason, HasSubstr("ACQUIRING, no valid pose for 12 s: match uncertain: "));
}

TEST(HealthCheck, StandbyIsGood) {
  Telemetry telemetry;
  telemetry.phase = Phase::kStandby;
  EXPECT_TRUE(check_health(telemetry, std::chrono::hours(1)).good);
}

TEST(HealthCheck, IsBadWhenAThreadHangs) {
  Telemetry telemetry = running(HealthState::kTracking);
  telemetry.view.hung = "vision";
  const HealthCheck health = check_health(telemetry, Duration{});
  EXPECT_FALSE(health.good);
  EXPECT_THAT(health.reason, HasSubstr("vision"));
  telemetry.view.hung.clear();
  EXPECT_FALSE(check_health(telemetry, seconds(3)).good);
}

TEST(PoseIsValid, NotWhileNobodyUpdatesIt) {
  Telemetry telemetry = running(HealthState::kTracking);
  telemetry.time = Time(seconds(100));
  telemetry.snapshot.estimation.pose.time = Time(seconds(100));
  EXPECT_TRUE(pose_is_valid(telemetry, milliseconds(300)));
  const Duration silent = seconds(3);
  EXPECT_FALSE(pose_is_valid(telemetry, silent));
  EXPECT_THAT(metrics_text(telemetry, {}, silent), HasSubstr("bevloc_pose_valid 0\n"));
  EXPECT_EQ(status_json(telemetry, {}, silent)["valid"], false);
  telemetry.time = Time(seconds(103));  // CAN out hangs
  EXPECT_FALSE(pose_is_valid(telemetry, milliseconds(0)));
}

TEST(HealthCheck, EveryReasonHasAnAdvice) {
  std::set<std::string> advices;
  for (int bit = 0; bit < kWhyCount; ++bit) {
    const auto reason = static_cast<Why>(1u << bit);
    EXPECT_STRNE(advice_for(reason), "") << words_of(reason);
    EXPECT_NE(words_of(reason), "");
  }
}

TEST(HealthCheck, TheAdviceFitsEachCauseOfAReason) {
  EXPECT_THAT(advice_for(Why::kCamerasUnsynchronized), HasSubstr("without a trigger"));
  EXPECT_THAT(advice_for(Why::kMapFault), HasSubstr("datum and origin"));
  EXPECT_THAT(advice_for(Why::kGnssContradicts), HasSubstr("delay of GNSS"));
}

TEST(Metrics, ShowStateAndPose) {
  const std::string text = metrics(running(HealthState::kDegraded, Why::kGnssMissing));
  for (const char* line :
       {"bevloc_state{state=\"DEGRADED\"} 1\n", "bevloc_state{state=\"TRACKING\"} 0\n",
        "bevloc_why{reason=\"GNSS missing\"} 1\n", "bevloc_why{reason=\"overload\"} 0\n",
        "bevloc_pose_valid 1\n", "bevloc_sigma_meters{axis=\"lateral\"} 0.5\n",
        "bevloc_protection_level_meters{axis=\"longitudinal\"} 1.25\n",
        "process_resident_memory_bytes 1000000\n", "process_cpu_seconds_total 2.5\n",
        "# TYPE bevloc_latency_seconds histogram\n"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
}

TEST(Metrics, CountHowOftenThePoseWasLost) {
  Telemetry telemetry = running(HealthState::kTracking);
  telemetry.snapshot.estimation.lost = 2;
  EXPECT_THAT(metrics(telemetry), HasSubstr("bevloc_lost_total 2\n"));
}

TEST(Metrics, ShowCountersOfCamerasAndQueues) {
  Telemetry telemetry = running(HealthState::kTracking);
  telemetry.snapshot.queue_drops = {.samples = 4, .reports = 5, .predictions = 6};
  telemetry.snapshot.cameras[1].captured = 7;
  telemetry.snapshot.cameras[1].driver.overrun = 3;
  telemetry.snapshot.cameras[1].dirty = true;
  const std::string text = metrics(telemetry);
  for (const char* line :
       {"bevloc_queue_dropped_total{queue=\"samples\"} 4\n",
        "bevloc_queue_dropped_total{queue=\"reports\"} 5\n",
        "bevloc_queue_dropped_total{queue=\"predictions\"} 6\n",
        "bevloc_camera_frames_captured_total{camera=\"front\"} 7\n",
        "bevloc_camera_frames_lost_total{camera=\"front\",reason=\"overrun\"} 3\n",
        "bevloc_camera_view_fault{camera=\"front\",fault=\"dirty\"} 1\n",
        "bevloc_camera_frames_captured_total{camera=\"back\"} 0\n"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
}

TEST(Metrics, ShowWhatBecameOfTheReportsOfGpsd) {
  Telemetry telemetry = running(HealthState::kTracking);
  EXPECT_THAT(metrics(telemetry), Not(HasSubstr("bevloc_gnss_connected")));
  GnssCounters& gnss = telemetry.snapshot.gnss.emplace();
  gnss.connected = true;
  gnss.samples = 5;
  gnss.gpsd.lines[static_cast<size_t>(drivers::GpsdLine::kNoFix)] = 3;
  gnss.fixes[static_cast<size_t>(drivers::FixVerdict::kStale)] = 2;
  gnss.fixes[static_cast<size_t>(drivers::FixVerdict::kUsable)] = 5;
  gnss.max_age = milliseconds(250);
  const std::string text = metrics(telemetry);
  for (const char* line :
       {"bevloc_gnss_connected 1\n", "bevloc_gnss_samples_total 5\n",
        "bevloc_gnss_refused_total{reason=\"no_fix\"} 3\n",
        "bevloc_gnss_refused_total{reason=\"stale\"} 2\n", "bevloc_gnss_age_max_seconds 0.25\n"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
  EXPECT_EQ(status_json(telemetry, {}, Duration{})["gnss"]["fixes_refused"], 2);
}

TEST(Metrics, ShowTheRecording) {
  Telemetry telemetry = running(HealthState::kTracking);
  EXPECT_THAT(metrics(telemetry), Not(HasSubstr("bevloc_recording")));
  telemetry.snapshot.recording = {.images = 1,
                                  .events = 2,
                                  .images_dropped = 3,
                                  .events_dropped = 4,
                                  .bytes = 5'000'000,
                                  .black_boxes = 6,
                                  .failed = true};
  const std::string text = metrics(telemetry);
  for (const char* line :
       {"bevloc_recording_written_total{kind=\"image\"} 1\n",
        "bevloc_recording_written_total{kind=\"event\"} 2\n",
        "bevloc_recording_dropped_total{kind=\"image\"} 3\n",
        "bevloc_recording_dropped_total{kind=\"event\"} 4\n",
        "bevloc_recording_bytes_total 5000000\n", "bevloc_recording_black_boxes_total 6\n",
        "bevloc_recording_failed 1\n"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
}

TEST(Metrics, NoStateHoldsInStandby) {
  Telemetry standby;
  standby.phase = Phase::kStandby;
  const std::string text = metrics(standby);
  EXPECT_THAT(text, HasSubstr("bevloc_can_state{state=\"ok\"} 0\n"));
  EXPECT_THAT(text, Not(testing::ContainsRegex("bevloc_(can_)?state\\{[^}]*\\} 1")));
  EXPECT_THAT(metrics(running(HealthState::kTracking)),
              HasSubstr("bevloc_can_state{state=\"ok\"} 1\n"));
}

TEST(Metrics, LatencyBucketsAreCumulative) {
  Telemetry telemetry = running(HealthState::kTracking);
  telemetry.snapshot.estimation.latency.in_range[0] = 1;
  telemetry.snapshot.estimation.latency.in_range[1] = 2;
  telemetry.snapshot.estimation.latency.in_range.back() = 4;
  const std::string text = metrics(telemetry);
  EXPECT_THAT(text, HasSubstr("bevloc_latency_seconds_bucket{le=\"0.02\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("bevloc_latency_seconds_bucket{le=\"+Inf\"} 7\n"));
  EXPECT_THAT(text, HasSubstr("bevloc_latency_seconds_count 7\n"));
}

TEST(Metrics, CountsEachLossOfAuthentication) {
  Telemetry telemetry = running(HealthState::kTracking);
  telemetry.snapshot.vehicle_input.foreign = 11;
  telemetry.snapshot.authentication = {
      .incomplete = 12, .wrong_length = 13, .bad_announcements = 14};
  const std::string text = metrics(telemetry);
  const auto refused = [](const std::string& reason, int count) {
    return HasSubstr("bevloc_vehicle_refused_total{reason=\"" + reason + "\"} " +
                     std::to_string(count) + "\n");
  };
  EXPECT_THAT(text, refused("foreign", 11));
  EXPECT_THAT(text, refused("authentication_incomplete", 12));
  EXPECT_THAT(text, refused("authentication_wrong_length", 13));
  EXPECT_THAT(text, refused("bad_announcement", 14));
}

TEST(Metrics, NoSeriesOccursTwice) {
  std::istringstream lines(metrics(with_every_device()));
  std::set<std::string> seen;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_TRUE(seen.insert(line.substr(0, line.rfind(' '))).second || line.starts_with('#'))
        << line;
  }
  EXPECT_GT(seen.size(), 150u);
}

/// The names of metrics in a text.
std::set<std::string> metric_names_in(const std::string& text) {
  const std::regex name("\\b(bevloc|process)_[a-z0-9_]+");
  std::set<std::string> names;
  for (std::sregex_iterator match(text.begin(), text.end(), name), end; match != end; ++match) {
    names.insert(match->str());
  }
  return names;
}

TEST(Metrics, TheDashboardNamesOnlyExistingOnes) {
  const auto dashboard =
      nlohmann::json::parse(test::read_text(BEVLOC_SOURCE_DIR "/docs/grafana/bevloc.json"));
  const std::set<std::string> existing = metric_names_in(metrics(with_every_device()));
  size_t queries = 0;
  for (const auto& panel : dashboard["panels"]) {
    for (const auto& target : panel.value("targets", nlohmann::json::array())) {
      ++queries;
      const std::set<std::string> used = metric_names_in(target["expr"].get<std::string>());
      EXPECT_FALSE(used.empty()) << target["expr"];
      for (const std::string& name : used) EXPECT_TRUE(existing.contains(name)) << name;
    }
  }
  EXPECT_GE(queries, 10u);
}

TEST(Metrics, ThePageListsEachOne) {
  const std::set<std::string> listed =
      metric_names_in(test::read_text(BEVLOC_SOURCE_DIR "/docs/live.md"));
  std::istringstream lines(metrics(with_every_device()));
  int types = 0;
  for (std::string word, name; lines >> word;) {
    if (word != "TYPE") continue;
    ++types;
    lines >> name;
    EXPECT_TRUE(listed.contains(name)) << name;
  }
  EXPECT_GT(types, 20);
}

using KeysByName = std::map<std::string, std::set<std::string>>;

/// The names of all keys inside a value.
std::set<std::string> keys_in(const nlohmann::json& value) {
  std::set<std::string> keys;
  if (!value.is_structured()) return keys;
  for (const auto& [key, inner] : value.items()) {
    if (value.is_object()) keys.insert(key);
    keys.merge(keys_in(inner));
  }
  return keys;
}

/// The words that a cell of a table marks as code.
std::set<std::string> code_in(const std::string& cell) {
  const std::regex code("`([^`]+)`");
  std::set<std::string> words;
  for (std::sregex_iterator match(cell.begin(), cell.end(), code), end; match != end; ++match) {
    words.insert(match->str(1));
  }
  return words;
}

/// The table of docs/live.md: the keys of the status, each with the keys in it.
KeysByName listed_keys() {
  std::istringstream lines(test::read_text(BEVLOC_SOURCE_DIR "/docs/live.md"));
  std::string line;
  while (std::getline(lines, line) && line != "### Keys of `/status.json`") {
  }
  KeysByName listed;
  while (std::getline(lines, line) && !line.starts_with('#')) {
    if (!line.starts_with("| `")) continue;
    const size_t second = line.find('|', 1);
    const size_t third = line.find('|', second + 1);
    const std::set<std::string> inside = code_in(line.substr(second, third - second));
    for (const std::string& key : code_in(line.substr(0, second))) listed[key] = inside;
  }
  return listed;
}

TEST(StatusJson, ThePageListsEachKey) {
  const nlohmann::json status = status_json(with_every_device(), {}, Duration{});
  KeysByName sent;
  for (const auto& [key, value] : status.items()) sent[key] = keys_in(value);
  EXPECT_EQ(listed_keys(), sent);
}

TEST(StatusJson, HasOnlyTheFirstFiveKeysInStandby) {
  Telemetry standby;
  standby.phase = Phase::kStandby;
  std::set<std::string> keys;
  const nlohmann::json status = status_json(standby, {}, Duration{});
  for (const auto& [key, value] : status.items()) keys.insert(key);
  EXPECT_EQ(keys, (std::set<std::string>{"version", "phase", "healthy", "health", "valid"}));
}

TEST(StatusJson, ShowsReasonsWithAdvice) {
  const nlohmann::json status =
      status_json(running(HealthState::kLost, Why::kOdometryMissing), {2e6, 1.0}, Duration{});
  EXPECT_EQ(status["state"], "LOST");
  EXPECT_EQ(status["valid"], false);
  EXPECT_EQ(status["healthy"], false);
  EXPECT_EQ(status["why"][0]["reason"], "odometry missing");
  EXPECT_EQ(status["why"][0]["do"], advice_for(Why::kOdometryMissing));
  EXPECT_DOUBLE_EQ(status["pose"]["sigma"]["lateral_m"].get<double>(), 0.5);
  EXPECT_EQ(status["cameras"].size(), 6u);
  EXPECT_DOUBLE_EQ(status["memory_mb"].get<double>(), 2.0);
}

}  // namespace
}  // namespace bevloc::firmware
