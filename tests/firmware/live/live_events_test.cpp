// Tests the events that the live page gets.
#include "firmware/live/live_events.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/bev_grid.h"
#include "tests/firmware/live/hand_made_localization.h"

namespace bevloc::firmware {
namespace {

using testing::StartsWith;

/// The data of an event of this name.
nlohmann::json data_of(const std::string& event, const std::string& name) {
  EXPECT_THAT(event, StartsWith("event: " + name + "\ndata: "));
  EXPECT_THAT(event, testing::EndsWith("}\n\n"));
  const size_t start = event.find("data: ") + 6;
  EXPECT_EQ(event.find('\n', start), event.size() - 2) << "data is one line";
  return nlohmann::json::parse(event.substr(start));
}

class LiveEventsTest : public testing::Test {
 protected:
  LiveEventsTest() {
    map_.elements.push_back(
        {ElementClass::kRoadBoundary, Appearance::kUnknown, {{-50.0, 3.0}, {50.0, 3.0}}});
    LiveFeed feed(made_.rig, 5);
    feed.set_viewers(1);
    feed.offer(made_.snapshot());
    feed.take([this](const LiveSample& sample) { sample_ = sample; });
    sample_.image = made_.frameset.frames[0].image();  // the copy above points to the feed
  }

  HandMadeLocalization made_;
  HdMap map_;
  LiveSample sample_;
};

TEST_F(LiveEventsTest, TheMaskHasOneCharacterForFourCells) {
  const auto cells = static_cast<size_t>(kRasterGrid.cells());
  std::vector<float> logits(3 * cells, -5.0F);
  EXPECT_EQ(mask_text(logits), std::string(cells / 4, '0'));
  logits[0] = 5.0F;              // a divider in the first row and column: level 3
  logits[2 * cells + 3] = 0.5F;  // a boundary in the second character: level 2
  const std::string text = mask_text(logits);
  EXPECT_EQ(text[0], '0' + 3);
  EXPECT_EQ(text[1], '0' + (2 << 4));
  EXPECT_EQ(text[2], '0');
}

TEST_F(LiveEventsTest, AMatchHasTheMapAtBothPosesAndTheDistributions) {
  const MapIndex index(map_);
  const nlohmann::json data = data_of(match_event(index, sample_), "match");
  EXPECT_EQ(data["evidence"], true);
  EXPECT_DOUBLE_EQ(data["correction"][2].get<double>(), 1.0);
  EXPECT_EQ(data["x"]["probability"].size(), 5u);
  EXPECT_DOUBLE_EQ(data["yaw"]["step"].get<double>(), 0.2);
  // [class, x, y, ...]: at the prior, 1 m left of the map's axis, the line is 2 m to the left.
  EXPECT_EQ(data["prior"][0][0], 2);
  EXPECT_DOUBLE_EQ(data["prior"][0][2].get<double>(), 2.0);
  EXPECT_NE(data["corrected"][0][2], data["prior"][0][2]);
}

TEST_F(LiveEventsTest, WithoutEvidenceThereIsNoCorrectedPose) {
  const MapIndex index(map_);
  sample_.match.evidence = Evidence::kNone;
  EXPECT_TRUE(data_of(match_event(index, sample_), "match")["corrected"].is_null());
  PictureMaker pictures;
  const auto camera = data_of(camera_event(index, made_.rig, sample_, pictures), "camera");
  EXPECT_TRUE(camera["corrected"].is_null());
}

TEST_F(LiveEventsTest, ACameraHasItsPictureAndTheMapInPixels) {
  const MapIndex index(map_);
  PictureMaker pictures;
  const auto data = data_of(camera_event(index, made_.rig, sample_, pictures), "camera");
  EXPECT_EQ(data["camera"], "front_left");
  EXPECT_EQ(data["width_px"], 64);
  EXPECT_THAT(data["jpeg"].get<std::string>(), StartsWith("/9j/"));  // a JPEG in base64
  EXPECT_FALSE(data["prior"].empty());
  EXPECT_NE(data["prior"], data["corrected"]);
}

/// A camera that exposed 1 m later shows the map as from 1 m farther on.
TEST_F(LiveEventsTest, ACameraHasTheMapAsAtItsExposure) {
  map_.elements.push_back(
      {ElementClass::kLaneDivider, Appearance::kUnknown, {{15.0, -3.0}, {15.0, 3.0}}});
  const MapIndex index(map_);
  PictureMaker pictures;
  const auto data_at = [&](const Se2& prior, const Se2& reference_from_exposure) {
    LiveSample sample = sample_;
    sample.prior = prior;
    sample.reference_from_exposure = reference_from_exposure;
    return data_of(camera_event(index, made_.rig, sample, pictures), "camera");
  };
  sample_.match.correction = {0.5, 0.0, 0.0};
  const auto moved = data_at({5.0, 1.0, 0.0}, {1.0, 0.0, 0.0});
  const auto farther = data_at({6.0, 1.0, 0.0}, {});
  EXPECT_EQ(moved["prior"], farther["prior"]);
  EXPECT_EQ(moved["corrected"], farther["corrected"]);
  EXPECT_NE(moved["prior"], data_at({5.0, 1.0, 0.0}, {})["prior"]);
  // The vehicle drives from the corrected pose, in the direction that it has there.
  sample_.match.correction = {0.0, 0.0, radians(90.0)};
  EXPECT_EQ(data_at({5.0, 1.0, radians(-90.0)}, {1.0, 0.0, 0.0})["corrected"],
            data_at({6.0, 1.0, radians(-90.0)}, {})["corrected"]);
}

TEST_F(LiveEventsTest, ADamagedImageGivesNoEvent) {
  const MapIndex index(map_);
  sample_.image.format = PixelFormat::kMjpeg;
  sample_.image.bytes_used = 100;
  PictureMaker pictures;
  EXPECT_EQ(camera_event(index, made_.rig, sample_, pictures), "");
}

TEST_F(LiveEventsTest, AStatusSaysWhenItWasSentAlsoInStandby) {
  for (const Phase phase : {Phase::kStandby, Phase::kRunning}) {
    Telemetry telemetry;
    telemetry.phase = phase;
    const std::string event = status_event(telemetry, {}, {}, std::chrono::milliseconds(12'345));
    EXPECT_DOUBLE_EQ(data_of(event, "status")["sent_s"].get<double>(), 12.345);
  }
}

TEST_F(LiveEventsTest, TheTrailSaysWhereItWasInterrupted) {
  EXPECT_EQ(trail_event({{1.234, 2.0, true, false}, {5.0, 6.0, false, true}}),
            "event: trail\ndata: [[1.23,2.0,1,0],[5.0,6.0,0,1]]\n\n");
}

TEST_F(LiveEventsTest, TheMapIsRelativeToItsCentre) {
  map_.name = "a \"street\"";
  const MapIndex index(map_);
  const auto data = data_of(map_event(index, {10.0, 1.0}, 150.0), "map");
  EXPECT_EQ(data["name"], map_.name);
  EXPECT_EQ(data["lines"][0], nlohmann::json::parse("[2, -60.0, 2.0, 40.0, 2.0]"));
}

}  // namespace
}  // namespace bevloc::firmware
