#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "can/dbc/dbc.h"
#include "can/dbc/near_name.h"
#include "can/messages/dbc_writer.h"
#include "can/messages/message_table.h"

namespace bevloc::can {
namespace {

const std::string kFixture = std::string(BEVLOC_SOURCE_DIR) + "/config/vehicle_demo.dbc";

std::string error_of(const std::string& text) {
  const auto dbc = parse_dbc(text, "x.dbc");
  return dbc ? "" : dbc.error().message;
}

TEST(DbcReaderTest, ReadsMessagesWithTheirSignals) {
  const auto dbc = read_dbc_file(kFixture);
  ASSERT_TRUE(dbc) << dbc.error().message;
  EXPECT_EQ(dbc->messages.size(), 7U);
  const DbcMessage* wheels = dbc->find("ESP_WheelsRear");
  ASSERT_NE(wheels, nullptr);
  EXPECT_EQ(wheels->id, 288U);
  EXPECT_EQ(wheels->length, 8);
  EXPECT_EQ(wheels->sender, "ESP");
  EXPECT_EQ(wheels->cycle_ms(), 20.0) << "the default";
  const DbcSignal* left = wheels->find("WR_Left");
  ASSERT_NE(left, nullptr);
  EXPECT_EQ(left->layout,
            (SignalLayout{23, 16, ByteOrder::kMotorola, RawType::kUnsigned, 0.01, 0.0}));
  EXPECT_EQ(left->unit, "km/h");
  EXPECT_DOUBLE_EQ(left->max, 655.33);
  EXPECT_EQ(wheels->find("WR_Valid")->find_value("VALID")->raw, 1);
  const DbcMessage* extended = dbc->find("DIAG_Extended");
  ASSERT_NE(extended, nullptr);
  EXPECT_TRUE(extended->is_extended);
  EXPECT_EQ(extended->id, 2566844926U & 0x1FFFFFFFU);
}

TEST(DbcReaderTest, ReadsMultiplexingFloatsAndAttributes) {
  const auto dbc = read_dbc_file(kFixture);
  ASSERT_TRUE(dbc) << dbc.error().message;
  const DbcMessage* motion = dbc->find("ESP_Motion");
  ASSERT_NE(motion, nullptr);
  EXPECT_EQ(motion->multiplexor()->name, "MO_Page");
  EXPECT_EQ(motion->find("MO_YawRate")->multiplexed_at, 1U);
  EXPECT_EQ(motion->find("MO_YawRate")->layout.type, RawType::kFloat);
  EXPECT_EQ(motion->cycle_ms(), 10.0);
  EXPECT_EQ(dbc->find("ESP_WheelsFront")->attributes.at("E2EProfile"), "P02")
      << "value 2 of the ENUM";
  EXPECT_EQ(dbc->find("ESP_WheelsFront")->attributes.at("E2EDataId"), "77");
  EXPECT_EQ(motion->attributes.at("E2EProfile"), "none");
}

TEST(DbcReaderTest, CountsWhatItSkips) {
  const auto dbc = read_dbc_file(kFixture);
  ASSERT_TRUE(dbc) << dbc.error().message;
  EXPECT_EQ(dbc->skipped.at("CM_"), 2U);
  EXPECT_EQ(dbc->skipped.at("BA_ (not of a message)"), 1U);
  EXPECT_EQ(dbc->skipped.at("VAL_ (environment variable)"), 1U);
  EXPECT_EQ(dbc->skipped.at("BO_ (signals without a message)"), 1U);
}

TEST(DbcReaderTest, ReadsWhatBevlocWrites) {
  const auto dbc = parse_dbc(dbc_text(), "bevloc.dbc");
  ASSERT_TRUE(dbc) << dbc.error().message;
  ASSERT_EQ(dbc->messages.size(), std::size(kMessages));
  for (const Message* message : kMessages) {
    const DbcMessage* read = dbc->find(message->name);
    ASSERT_NE(read, nullptr) << message->name;
    EXPECT_EQ(read->id, message->id({}));
    EXPECT_EQ(read->length, message->length);
    EXPECT_EQ(read->cycle_ms(), message->cycle_ms);
    for (const Signal* signal : message->signals) {
      const DbcSignal* found = read->find(signal->name);
      ASSERT_NE(found, nullptr) << signal->name;
      EXPECT_EQ(found->layout.start_bit, signal->start_bit);
      EXPECT_EQ(found->layout.length_bits, signal->length_bits);
      EXPECT_EQ(found->layout.scale, signal->scale);
    }
  }
}

TEST(DbcReaderTest, ReadsLatin1) {
  const auto dbc = parse_dbc("BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"\xB0/s\" Y\n", "x.dbc");
  ASSERT_TRUE(dbc) << dbc.error().message;
  EXPECT_EQ(dbc->messages[0].signals[0].unit, "°/s");
}

TEST(DbcReaderTest, SaysWhereAndWhatIsWrong) {
  const std::string message = "VERSION \"\"\nBO_ 1 A: 8 X\n";
  EXPECT_EQ(error_of(message + " SG_ S : 60|8@1+ (1,0) [0|0] \"\" Y\n"),
            "x.dbc:3: found signal S up to byte 9, wanted within the 8 bytes of message A");
  EXPECT_EQ(error_of(message + " SG_ S : 6|8@0+ (1,0) [0|0] \"\" Y\nBO_ 1 B: 8 X\n"),
            "x.dbc:4: found identifier 1 a second time, wanted each identifier once");
  EXPECT_EQ(error_of(message + " SG_ S : 0|8@2+ (1,0) [0|0] \"\" Y\n"),
            "x.dbc:3: found 2+, wanted byte order and sign: 0+, 0-, 1+ or 1-");
  EXPECT_EQ(error_of(message + " SG_ S : 0|0@1+ (1,0) [0|0] \"\" Y\n"),
            "x.dbc:3: found signal S with 0 bits, wanted 1 to 64");
  EXPECT_EQ(error_of(message + " SG_ S : 0|8@1+ (0,0) [0|0] \"\" Y\n"),
            "x.dbc:3: found signal S with scale 0, wanted another scale");
  EXPECT_EQ(error_of(message + " SG_ S m0 : 0|8@1+ (1,0) [0|0] \"\" Y\n"),
            "x.dbc:2: found message A with 0 multiplexors, wanted one multiplexor (M) beside "
            "multiplexed signals");
  EXPECT_EQ(error_of(message + "VAL_ 2 S 0 \"a\" ;\n"),
            "x.dbc:3: found 2, wanted the identifier of a message of this file");
  EXPECT_EQ(error_of(message + "VAL_ 1 S 0 \"a\" ;\n"),
            "x.dbc:3: found S, wanted the name of a signal of message A");
  EXPECT_EQ(error_of("VERSION \"\"\nBS_:\n"),
            "x.dbc: found no message, wanted a DBC file with BO_ lines");
  EXPECT_EQ(error_of("<html>"),
            "x.dbc:1: found <html>, wanted a keyword of DBC files, such as BO_ or VAL_");
  EXPECT_EQ(error_of(message + "CM_ \"no end"), "x.dbc:3: found the end of the file, wanted ';'");
  EXPECT_EQ(error_of("BO_ 4096 A: 8 X\n"),
            "x.dbc:1: found identifier 4096, wanted at most 2047, or 29 bits plus 2147483648");
}

TEST(NearNameTest, FindsWhatWasMeant) {
  const std::vector<std::string> names = {"WheelSpeedRL", "WheelSpeedRR", "YawRate"};
  EXPECT_EQ(near_name("WhelSpeedRL", names), "WheelSpeedRL");
  EXPECT_EQ(near_name("yawrate", names), "YawRate");
  EXPECT_EQ(near_name("Temperature", names), std::nullopt);
}

}  // namespace
}  // namespace bevloc::can
