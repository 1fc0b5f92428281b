#include "can/listen/bus_listener.h"

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "can/messages/vehicle_encoder.h"

namespace bevloc::can {
namespace {

BusListener listener_of(const std::string& text) {
  auto dbc = parse_dbc(text, "x.dbc");
  EXPECT_TRUE(dbc) << dbc.error().message;
  std::vector<Dbc> files;
  files.push_back(std::move(*dbc));
  return BusListener(std::move(files), {});
}

const std::string kMultiplexed =
    "BO_ 16 A: 8 X\n SG_ Page M : 0|4@1+ (1,0) [0|15] \"\" Y\n"
    " SG_ One m1 : 8|8@1+ (0.5,0) [0|0] \"m\" Y\n SG_ Two m2 : 8|8@1+ (1,0) [0|0] \"\" Y\n"
    "VAL_ 16 Two 7 \"SEVEN\" 255 \"SNA\" ;\n";

TEST(BusListenerTest, DecodesTheSignalsOfTheFrame) {
  BusListener listener = listener_of(kMultiplexed);
  const DecodedFrame* one = listener.decode({.id = 16, .length = 8, .data = {1, 5}});
  ASSERT_NE(one, nullptr);
  EXPECT_EQ(text_of(*one, 1.5), "1.500000 A Page=1 One=2.5m");
  const DecodedFrame* two = listener.decode({.id = 16, .length = 8, .data = {2, 7}});
  EXPECT_EQ(text_of(*two, 1.5), "1.500000 A Page=2 Two=SEVEN");
  const DecodedFrame* sna = listener.decode({.id = 16, .length = 8, .data = {2, 255}});
  EXPECT_TRUE(nlohmann::json::parse(json_of(*sna, 2.0))["signals"]["Two"].is_null());
  EXPECT_EQ(listener.decode({.id = 17, .length = 0}), nullptr);
  EXPECT_EQ(listener.unknown(), 1U);
  EXPECT_EQ(listener.totals().at("A").frames, 3U);
}

TEST(BusListenerTest, ShowsNoValueThatBevlocdWouldNotUse) {
  BusListener listener = listener_of(
      "BO_ 16 A: 8 X\n SG_ V : 0|8@1+ (0.5,0) [0|50.2] \"m\" Y\n"
      " SG_ L : 8|8@1+ (1,0) [0|100] \"\" Y\n"
      "VAL_ 16 L 7 \"sna\" 101 \"ERROR\" ;\n");
  const auto shown = [&](uint8_t value, uint8_t level) {
    const DecodedFrame* frame = listener.decode({.id = 16, .length = 8, .data = {value, level}});
    const auto json = nlohmann::json::parse(json_of(*frame, 0.0))["signals"];
    EXPECT_EQ(json["V"].is_null(), !frame->signals[0].is_available);
    EXPECT_EQ(json["L"].is_null(), !frame->signals[1].is_available);
    return text_of(*frame, 0.0);
  };
  EXPECT_EQ(shown(100, 100), "0.000000 A V=50m L=100");
  EXPECT_EQ(shown(101, 7), "0.000000 A V=50.5m(not_available) L=sna");
  EXPECT_EQ(shown(255, 101), "0.000000 A V=127.5m(not_available) L=ERROR(not_available)");
  EXPECT_EQ(shown(0, 102), "0.000000 A V=0m L=102(not_available)");
}

TEST(BusListenerTest, KnowsTheSnaOfASignedSignalThatIsWrittenWithoutASign) {
  BusListener listener = listener_of(
      "BO_ 256 A: 8 X\n SG_ Yaw : 0|16@1- (0.01,0) [0|0] \"deg/s\" Y\n"
      "VAL_ 256 Yaw 32768 \"SNA\" ;\n");
  const DecodedFrame* frame = listener.decode({.id = 256, .length = 2, .data = {0x00, 0x80}});
  EXPECT_EQ(text_of(*frame, 0.0), "0.000000 A short Yaw=SNA");
  EXPECT_TRUE(nlohmann::json::parse(json_of(*frame, 0.0))["signals"]["Yaw"].is_null());
  frame = listener.decode({.id = 256, .length = 2, .data = {0x01, 0x80}});
  EXPECT_EQ(text_of(*frame, 0.0), "0.000000 A short Yaw=-327.67deg/s");
}

TEST(BusListenerTest, DecodesSignalsAtSeveralValuesOfTheMultiplexor) {
  BusListener listener = listener_of(kMultiplexed + "SG_MUL_VAL_ 16 One Page 1-1, 4-5;\n");
  const DecodedFrame* frame = listener.decode({.id = 16, .length = 8, .data = {5, 5}});
  EXPECT_EQ(text_of(*frame, 0.0), "0.000000 A Page=5 One=2.5m");
  frame = listener.decode({.id = 16, .length = 8, .data = {2, 7}});
  EXPECT_EQ(text_of(*frame, 0.0), "0.000000 A Page=2 Two=SEVEN");
}

TEST(BusListenerTest, DecodesWhatFitsIntoAShortFrame) {
  BusListener listener = listener_of(kMultiplexed);
  const DecodedFrame* frame = listener.decode({.id = 16, .length = 1, .data = {1}});
  EXPECT_EQ(text_of(*frame, 0.0), "0.000000 A short Page=1");
  const DecodedFrame* empty = listener.decode({.id = 16, .length = 0});
  EXPECT_TRUE(empty->signals.empty());
}

TEST(BusListenerTest, KeepsWholeNumbersExact) {
  BusListener listener = listener_of(
      "BO_ 16 A: 8 X\n SG_ U : 0|64@1+ (1,0) [0|0] \"\" Y\n SG_ S : 0|64@1- (1,0) [0|0] \"\" Y\n"
      "BO_ 17 B: 8 X\n SG_ N : 0|40@1+ (2,0) [0|0] \"m\" Y\n SG_ F : 0|40@1+ (0.01,0) [0|0] \"\" "
      "Y\n"
      " SG_ P : 0|8@1+ (0.1,0) [0|0] \"\" Y\n");
  const DecodedFrame* whole = listener.decode(
      {.id = 16, .length = 8, .data = {0xFE, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}});
  EXPECT_EQ(text_of(*whole, 0.0), "0.000000 A U=18446744073709551614 S=-2");
  EXPECT_NE(json_of(*whole, 0.0).find("{\"U\":18446744073709551614,\"S\":-2}"), std::string::npos);
  const DecodedFrame* scaled =
      listener.decode({.id = 17, .length = 8, .data = {3, 0xFF, 0xFF, 0xFF, 0xFF}});
  EXPECT_EQ(text_of(*scaled, 0.0), "0.000000 B N=2199023255046m F=10995116275.23 P=0.3");
}

TEST(BusListenerTest, DoesNotKnowMessagesThatAreLeftOut) {
  BusListener listener =
      listener_of("BO_ 1280 LOC_Status: 8 X\n SG_ S : 0|8@1+ (0,0) [0|0] \"\" Y\nBO_ 16 B: 8 X\n");
  EXPECT_EQ(listener.decode({.id = 1280, .length = 8}), nullptr);
  EXPECT_EQ(listener.unknown(), 1U);
  EXPECT_NE(listener.decode({.id = 16, .length = 8}), nullptr);
}

TEST(BusListenerTest, ChecksTheProtectionOfBevlocsMessages) {
  BusListener listener({}, {});
  VehicleEncoder encoder(BaseIds{}, {49.0, 8.4}, 1.6);
  const Frame first = encoder.odometry(OdometrySample{.speed_mps = 10.0})[0];
  EXPECT_EQ(listener.decode(first)->e2e, E2eResult::kOk);
  EXPECT_EQ(listener.decode(first)->e2e, E2eResult::kRepeated);
  Frame damaged = encoder.odometry(OdometrySample{.speed_mps = 10.0})[0];
  damaged.data[3] ^= 1;
  const DecodedFrame* decoded = listener.decode(damaged);
  EXPECT_EQ(decoded->e2e, E2eResult::kWrongCrc);
  const auto json = nlohmann::json::parse(json_of(*decoded, 0.0));
  EXPECT_EQ(json["message"], "VEH_WheelSpeed");
  EXPECT_EQ(json["e2e"], "wrong_crc");
  EXPECT_EQ(listener.totals().at("VEH_WheelSpeed").unusable, 2U);
}

TEST(BusListenerTest, ChecksEachInterfaceOnItsOwn) {
  BusListener listener({}, {});
  VehicleEncoder encoder(BaseIds{}, {49.0, 8.4}, 1.6);
  Frame frame = encoder.odometry(OdometrySample{.speed_mps = 10.0})[0];
  EXPECT_EQ(listener.decode(frame, "can0")->e2e, E2eResult::kOk);
  EXPECT_EQ(listener.decode(frame, "can1")->e2e, E2eResult::kOk);
  encoder.odometry(OdometrySample{.speed_mps = 10.0});  // lost on both
  frame = encoder.odometry(OdometrySample{.speed_mps = 10.0})[0];
  EXPECT_EQ(listener.decode(frame, "can0")->e2e, E2eResult::kSomeLost);
  EXPECT_EQ(listener.decode(frame, "can1")->e2e, E2eResult::kSomeLost);
  EXPECT_EQ(listener.decode(frame, "can1")->e2e, E2eResult::kRepeated);
  const BusListener::Total& total = listener.totals().at("VEH_WheelSpeed");
  EXPECT_EQ(total.frames, 5U);
  EXPECT_EQ(total.unusable, 1U);
  EXPECT_EQ(total.lost, 2U);
}

}  // namespace
}  // namespace bevloc::can
