#include "can/vehicle/vehicle_binder.h"

#include <string>

#include <gtest/gtest.h>

namespace bevloc::can {
namespace {

/// Speed and Other in the bytes 2 to 5, behind a checksum and a counter.
const std::string kBus =
    "BO_ 16 A: 8 X\n"
    " SG_ Crc : 0|8@1+ (1,0) [0|0] \"\" Y\n"
    " SG_ Counter : 8|4@1+ (1,0) [0|0] \"\" Y\n"
    " SG_ Speed : 16|16@1+ (0.01,0) [0|0] \"m/s\" Y\n"
    " SG_ Other : 32|16@1+ (0.01,0) [0|0] \"m/s\" Y\n"
    " SG_ Sigma : 48|8@1+ (1,0) [0|0] \"m\" Y\n"
    " SG_ Gear : 56|3@1+ (1,0) [0|0] \"\" Y\n"
    "BO_ 17 M: 8 X\n"
    " SG_ Page M : 0|4@1+ (1,0) [0|0] \"\" Y\n"
    " SG_ Crc m2 : 8|8@1+ (1,0) [0|0] \"\" Y\n"
    " SG_ Counter m2 : 16|4@1+ (1,0) [0|0] \"\" Y\n"
    " SG_ Far m16 : 32|16@1+ (0.01,0) [0|0] \"m/s\" Y\n"
    " SG_ Near m15 : 32|16@1+ (0.01,0) [0|0] \"m/s\" Y\n"
    "BO_ 18 Nine: 9 X\n"
    " SG_ Speed : 16|16@1+ (0.01,0) [0|0] \"m/s\" Y\n"
    "BO_ 19 Broken: 8 X\n"
    " SG_ Speed : 16|16@1+ (0,0) [0|0] \"m/s\" Y\n"
    "BO_ 20 F: 8 X\n"
    " SG_ Float : 0|32@1- (1,0) [0|0] \"m/s\" Y\n"
    "VAL_ 16 Gear 1 \"R\" 7 \"R\" 2 \"N\" ;\n"
    "SIG_VALTYPE_ 20 Float : 1;\n"
    "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 100;\n"
    "BA_DEF_DEF_ \"GenMsgCycleTime\" 20;\n";

class VehicleBinderTest : public testing::Test {
 protected:
  static Dbc dbc_of(const std::string& text) {
    auto dbc = parse_dbc(text, "x.dbc");
    EXPECT_TRUE(dbc) << (dbc ? "" : dbc.error().message);
    return std::move(*dbc);
  }

  template <typename T>
  static std::string error_of(const Bound<T>& bound) {
    return bound ? "" : bound.error().found + ", wanted " + bound.error().wanted;
  }

  /// Binds a signal as a speed.
  std::string speed(const std::string& signal, const std::string& message = "A") {
    return error_of(binder_.quantity(signal, message, Quantity::kSpeed, ""));
  }
  std::string protect(const ProtectionRequest& request) {
    return error_of(binder_.protect(request));
  }
  /// The error of finish(), which begins with the name of the message.
  std::string finish() {
    binder_.binding().wheels.wheels = {{0, WheelPlace::kVehicle}};
    const auto binding = binder_.finish();
    if (binding) return "";
    return binding.error().message + ": " + error_of<void>(tl::unexpected(binding.error().refusal));
  }

  Dbc dbc_ = dbc_of(kBus);
  VehicleBinder binder_{dbc_};
};

TEST_F(VehicleBinderTest, RefusesDataIdsThatTheChecksumDoesNotHold) {
  EXPECT_EQ(speed("Speed"), "");
  for (const ChecksumKind kind : {ChecksumKind::kXor, ChecksumKind::kCrc8Sae,
                                  ChecksumKind::kCrc8H2f, ChecksumKind::kE2eP02}) {
    EXPECT_EQ(protect({.message = "A", .kind = kind, .data_ids = {256}}),
              "data id 256, wanted at most 255; only e2e_p05 has 16 bits");
  }
  EXPECT_EQ(protect({.message = "A", .data_ids = {3}}),
            "data ids without a checksum, wanted an algorithm beside them");
  std::vector<uint16_t> ids(16, 3);
  ids.back() = 777;
  EXPECT_NE(protect({.message = "A", .kind = ChecksumKind::kE2eP02, .data_ids = ids}), "");
  EXPECT_EQ(protect({.message = "A", .kind = ChecksumKind::kE2eP05, .data_ids = {777}}), "");
}

TEST_F(VehicleBinderTest, RefusesDataIdsOfAttributesLikewise) {
  const auto finish_with = [](const std::string& profile, int data_id) {
    const Dbc dbc = dbc_of(kBus + "BA_ \"E2EProfile\" BO_ 16 \"" + profile +
                           "\";\nBA_ \"E2EDataId\" BO_ 16 " + std::to_string(data_id) + ";\n");
    VehicleBinder binder(dbc);
    binder.binding().wheels.wheels = {
        {*binder.quantity("Other", "A", Quantity::kSpeed, ""), WheelPlace::kVehicle}};
    const auto binding = binder.finish();
    return binding ? "" : error_of<void>(tl::unexpected(binding.error().refusal));
  };
  EXPECT_EQ(finish_with("P02", 333), "E2EDataId 333, wanted 0 to 255 for profile P02");
  EXPECT_EQ(finish_with("P02", 255), "");
  EXPECT_EQ(finish_with("P05", 333), "");
  EXPECT_EQ(finish_with("P05", 65536), "E2EDataId 65536, wanted 0 to 65535 for profile P05");
}

TEST_F(VehicleBinderTest, AnEntryKeepsTheProfileOfTheDbcUnlessItNamesAnAlgorithm) {
  const Dbc dbc = dbc_of(kBus +
                         "BA_ \"E2EProfile\" BO_ 16 \"P02\";\n"
                         "BA_ \"E2EDataId\" BO_ 16 7;\n");
  const auto checksum_with = [&](const ProtectionRequest& request) {
    VehicleBinder binder(dbc);
    binder.binding().wheels.wheels = {
        {*binder.quantity("Other", "A", Quantity::kSpeed, ""), WheelPlace::kVehicle}};
    EXPECT_EQ(error_of(binder.protect(request)), "");
    const auto binding = binder.finish();
    EXPECT_TRUE(binding);
    return binding ? binding->messages[0].protection.checksum : ChecksumKind::kXor;
  };
  EXPECT_EQ(checksum_with({.message = "A", .cycle_ms = 10.0}), ChecksumKind::kE2eP02);
  EXPECT_EQ(checksum_with({.message = "A", .kind = ChecksumKind::kNone}), ChecksumKind::kNone);
}

TEST_F(VehicleBinderTest, RefusesASecondEntryForAMessage) {
  EXPECT_EQ(speed("Speed"), "");
  EXPECT_EQ(protect({.message = "A", .checksum = "Crc", .kind = ChecksumKind::kXor}), "");
  EXPECT_EQ(protect({.message = "A", .cycle_ms = 20.0}),
            "a second entry for A, wanted one for each message");
  EXPECT_EQ(binder_.binding().messages[0].protection.checksum, ChecksumKind::kXor);
}

TEST_F(VehicleBinderTest, RefusesProtectionThatIsNotInEveryFrame) {
  EXPECT_EQ(speed("Near", "M"), "");
  EXPECT_EQ(protect({.message = "M", .counter = "Counter"}),
            "Counter, which is multiplexed, wanted a counter or checksum that "
            "is in every frame");
  EXPECT_EQ(protect({.message = "M", .checksum = "Crc", .kind = ChecksumKind::kXor}),
            "Crc, which is multiplexed, wanted a counter or checksum that is in "
            "every frame");
  EXPECT_EQ(protect({.message = "M", .counter = "A.Counter"}),
            "Counter of message A, wanted a signal of message M");
}

TEST_F(VehicleBinderTest, TakesAllValuesOfAName) {
  const auto condition = binder_.condition("Gear", "A", {"R", "2"});
  ASSERT_TRUE(condition);
  EXPECT_EQ(condition->values, (std::vector<int64_t>{1, 7, 2}));
}

TEST_F(VehicleBinderTest, RefusesASignalForTwoValues) {
  EXPECT_EQ(speed("Speed"), "");
  EXPECT_EQ(speed("Speed"), "A.Speed for a second value, wanted a signal for each value");
  EXPECT_EQ(speed("Other"), "");
  EXPECT_TRUE(binder_.quantity("Sigma", "A", Quantity::kLength, "m"));
  EXPECT_TRUE(binder_.quantity("Sigma", "A", Quantity::kLength, "m")) << "north and east";
  EXPECT_FALSE(binder_.quantity("Sigma", "A", Quantity::kHeading, "deg"));
}

TEST_F(VehicleBinderTest, KeepsTheFactorOfASignalThatIsAConditionToo) {
  ASSERT_TRUE(binder_.condition("Speed", "A", {"0"}));
  const auto signal = binder_.quantity("Speed", "A", Quantity::kSpeed, "km/h");
  ASSERT_TRUE(signal);
  EXPECT_DOUBLE_EQ(binder_.binding().signals[*signal].factor, 1.0 / 3.6);
}

TEST_F(VehicleBinderTest, RefusesSignalsThatCannotWork) {
  EXPECT_EQ(speed("Far", "M"),
            "Far, which is multiplexed at 16, wanted a "
            "value that fits into the 4 bits of Page");
  EXPECT_EQ(error_of(binder_.condition("Float", "F", {"1"})),
            "Float, which is a float, wanted a signal with whole numbers");
  EXPECT_EQ(speed("Speed", "Broken"),
            "Broken, which is left out (x.dbc:17: found signal Speed with "
            "scale 0, wanted another "
            "scale), wanted a message without mistakes");
}

TEST_F(VehicleBinderTest, RefusesValuesThatShareBits) {
  const auto finish_with = [](const std::string& other) {
    const Dbc dbc = dbc_of(
        "BO_ 16 A: 8 X\n"
        " SG_ Page M : 0|4@1+ (1,0) [0|0] \"\" Y\n"
        " SG_ Left : 16|16@1+ (0.01,0) [0|0] \"m/s\" Y\n"
        " SG_ Near m1 : 40|16@1+ (0.01,0) [0|0] \"m/s\" Y\n"
        " SG_ Other " +
        other +
        "@1+ (0.01,0) [0|0] \"m/s\" Y\n"
        "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 100;\nBA_DEF_DEF_ \"GenMsgCycleTime\" 20;\n");
    VehicleBinder binder(dbc);
    for (const std::string name : {"Left", "Near", "Other"}) {
      const auto signal = binder.quantity(name, "A", Quantity::kSpeed, "");
      binder.binding().wheels.wheels.push_back({*signal, WheelPlace::kVehicle});
    }
    const auto binding = binder.finish();
    return binding ? "" : error_of<void>(tl::unexpected(binding.error().refusal));
  };
  EXPECT_EQ(finish_with(": 24|16"),
            "A.Other in the bits of A.Left, wanted separate bits for each value");
  EXPECT_EQ(finish_with("m1 : 48|16"),
            "A.Other in the bits of A.Near, wanted separate bits for each value");
  EXPECT_EQ(finish_with("m2 : 40|16"), "") << "on another page";
}

TEST_F(VehicleBinderTest, BelievesNoRangeThatTheBitsDoNotReach) {
  const auto error_with = [](const std::string& range) {
    const Dbc dbc = dbc_of("BO_ 16 A: 8 X\n SG_ S : 0|8@1+ (0.01,0) [" + range + "] \"m/s\" Y\n");
    VehicleBinder binder(dbc);
    return error_of(binder.quantity("S", "A", Quantity::kSpeed, ""));
  };
  const std::string refused =
      "S, which reaches 2.55 m/s at most, wanted a signal that reaches 15 m/s; check its unit";
  EXPECT_EQ(error_with("0|0"), refused);
  EXPECT_EQ(error_with("0|655.33"), refused);
}

TEST_F(VehicleBinderTest, SpeedsAndYawRatesMustReachTheirValueOnThePositiveSide) {
  const auto error_with = [](const std::string& signal, Quantity quantity) {
    const Dbc dbc = dbc_of("BO_ 16 A: 8 X\n SG_ S : 0|32@1- " + signal + " Y\n");
    VehicleBinder binder(dbc);
    return error_of(binder.quantity("S", "A", quantity, ""));
  };
  EXPECT_EQ(error_with("(0.01,0) [-60|10] \"m/s\"", Quantity::kSpeed),
            "S, which reaches 10 m/s at most, wanted a signal that reaches 15 m/s; check its unit");
  EXPECT_EQ(error_with("(0.01,0) [-60|15] \"m/s\"", Quantity::kSpeed), "");
  EXPECT_EQ(
      error_with("(0.001,0) [-5|0.2] \"rad/s\"", Quantity::kYawRate),
      "S, which reaches 0.2 rad/s at most, wanted a signal that reaches 0.3 rad/s; check its unit");
  EXPECT_EQ(error_with("(1E-007,0) [-180|0] \"deg\"", Quantity::kPosition), "") << "in the west";
}

TEST_F(VehicleBinderTest, ALowestValueJustBelowZeroIsNoSign) {
  const auto has_sign = [](const std::string& signal, Quantity quantity) {
    const Dbc dbc = dbc_of("BO_ 16 A: 8 X\n SG_ S : 0|16@1- " + signal + " Y\n");
    VehicleBinder binder(dbc);
    const auto bound = binder.quantity("S", "A", quantity, "");
    EXPECT_TRUE(bound) << signal << error_of(bound);
    return bound && binder.binding().signals[*bound].has_sign;
  };
  EXPECT_FALSE(has_sign("(0.01,0) [-0.5|100] \"m/s\"", Quantity::kSpeed));
  EXPECT_TRUE(has_sign("(0.01,0) [-2|100] \"m/s\"", Quantity::kSpeed));
  EXPECT_FALSE(has_sign("(0.01,0) [-3|250] \"km/h\"", Quantity::kSpeed));
  EXPECT_TRUE(has_sign("(0.01,0) [-4|250] \"km/h\"", Quantity::kSpeed));
  EXPECT_FALSE(has_sign("(0.001,0) [-0.1|5] \"rad/s\"", Quantity::kYawRate));
  EXPECT_TRUE(has_sign("(0.001,0) [-0.5|5] \"rad/s\"", Quantity::kYawRate));
}

TEST_F(VehicleBinderTest, APositionNeedsFineStepsAndASigmaNeedsNoRange) {
  const auto error_with = [](const std::string& signal, Quantity quantity) {
    const Dbc dbc = dbc_of("BO_ 16 A: 8 X\n SG_ S : 0|" + signal + " Y\n");
    VehicleBinder binder(dbc);
    return error_of(binder.quantity("S", "A", quantity, ""));
  };
  EXPECT_EQ(error_with("8@1- (1,0) [-90|90] \"deg\"", Quantity::kPosition),
            "S in steps of 1 deg, wanted steps of at most 1e-05 deg; check its unit");
  EXPECT_EQ(error_with("32@1- (0.0001,0) [-90|90] \"deg\"", Quantity::kPosition),
            "S in steps of 0.0001 deg, wanted steps of at most 1e-05 deg; check its unit");
  EXPECT_EQ(error_with("32@1- (1E-005,0) [-90|90] \"deg\"", Quantity::kPosition), "");
  EXPECT_EQ(error_with("32@1- (0.0001,0) [-5400|5400] \"arcmin\"", Quantity::kPosition), "");
  EXPECT_EQ(error_with("16@1+ (1,0) [0|359] \"deg\"", Quantity::kHeading), "");
  EXPECT_EQ(error_with("6@1+ (0.01,0) [0|0] \"deg\"", Quantity::kHeadingSigma), "");
  EXPECT_EQ(error_with("8@1+ (1,0) [0|0] \"mm\"", Quantity::kLength), "");
}

TEST_F(VehicleBinderTest, RefusesDataIdsThatNoCounterChooses) {
  EXPECT_EQ(speed("Speed"), "");
  ProtectionRequest request{.message = "A",
                            .checksum = "Crc",
                            .kind = ChecksumKind::kCrc8H2f,
                            .data_ids = std::vector<uint16_t>(16, 3)};
  EXPECT_EQ(protect(request),
            "data_ids without a counter, wanted a counter beside them, or one data_id");
  request.counter = "Counter";
  EXPECT_EQ(protect(request), "");
}

TEST_F(VehicleBinderTest, RefusesAHighestCounterWithoutACounter) {
  EXPECT_EQ(speed("Speed"), "");
  ProtectionRequest request{.message = "A", .highest_counter = 14};
  EXPECT_EQ(protect(request), "highest_counter without a counter, wanted a counter beside it");
  request.counter = "Counter";
  EXPECT_EQ(protect(request), "");
}

TEST_F(VehicleBinderTest, RefusesSignalsAtSeveralValuesOfAMultiplexor) {
  const Dbc dbc = dbc_of(kBus + "SG_MUL_VAL_ 17 Near Page 1-2;\nSG_MUL_VAL_ 17 Far Page 3-3;\n");
  VehicleBinder binder(dbc);
  EXPECT_EQ(
      error_of(binder.quantity("Near", "M", Quantity::kSpeed, "")),
      "Near at several values of Page, wanted a signal that frames have at one value of Page, "
      "or always");
  EXPECT_EQ(error_of(binder.quantity("Far", "M", Quantity::kSpeed, "")), "");
}

TEST_F(VehicleBinderTest, RefusesLengthsThatNoFrameHas) {
  EXPECT_EQ(speed("Speed", "Nine"), "");
  EXPECT_EQ(finish(),
            "Nine: 9 bytes, wanted a length of CAN frames: 0 to 8, "
            "12, 16, 20, 24, 32, 48 or 64 "
            "bytes");
}

TEST_F(VehicleBinderTest, RefusesAChecksumInsideAValue) {
  const Dbc dbc = dbc_of(
      "BO_ 16 A: 8 X\n SG_ Crc : 23|8@0+ (1,0) [0|0] \"\" Y\n"
      " SG_ Speed : 16|16@1+ (0.01,0) [0|0] \"m/s\" Y\n");
  VehicleBinder binder(dbc);
  binder.binding().wheels.wheels = {
      {*binder.quantity("Speed", "A", Quantity::kSpeed, ""), WheelPlace::kVehicle}};
  ASSERT_TRUE(binder.protect(
      {.message = "A", .cycle_ms = 20.0, .checksum = "Crc", .kind = ChecksumKind::kXor}));
  const auto binding = binder.finish();
  ASSERT_FALSE(binding);
  EXPECT_EQ(binding.error().refusal.found, "A.Speed in the bits of its checksum");
}

TEST_F(VehicleBinderTest, RefusesACounterInsideAValue) {
  EXPECT_EQ(speed("Speed"), "");
  ASSERT_TRUE(binder_.condition("Gear", "A", {"N"}));
  EXPECT_EQ(protect({.message = "A", .counter = "Gear"}), "");
  EXPECT_EQ(finish(), "A: A.Gear in the bits of its counter, wanted separate bits for each");
}

TEST_F(VehicleBinderTest, RefusesAValueWhereAProfileHasItsCounter) {
  ASSERT_TRUE(binder_.condition("Counter", "A", {"1"}));
  EXPECT_EQ(speed("Speed"), "");
  EXPECT_EQ(protect({.message = "A", .kind = ChecksumKind::kE2eP02, .data_ids = {1}}), "");
  EXPECT_EQ(finish(), "A: A.Counter in the bits of its counter, wanted separate bits for each");
}

}  // namespace
}  // namespace bevloc::can
