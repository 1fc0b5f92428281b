#include <algorithm>
#include <string>
#include <vector>

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
  EXPECT_EQ(wheels->find("WR_Valid")->values_named("VALID"), std::vector<int64_t>{1});
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
  EXPECT_EQ(motion->find("MO_YawRate")->multiplexed_at, (std::vector<DbcValueRange>{{1, 1}}));
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

TEST(DbcReaderTest, ReadsTextThatOnlyLooksLikeUtf8AsLatin1) {
  const auto unit_of = [](const std::string& unit) {
    const auto dbc =
        parse_dbc("BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"" + unit + "\" Y\n", "x.dbc");
    return dbc ? dbc->messages[0].signals[0].unit : dbc.error().message;
  };
  EXPECT_EQ(unit_of("\xC2\xB0"), "\xC2\xB0");
  EXPECT_EQ(unit_of("\xF4\x8F\xBF\xBF"), "\xF4\x8F\xBF\xBF") << "the highest character";
  EXPECT_EQ(unit_of("\xC0\x80"), "\xC3\x80\xC2\x80") << "overlong";
  EXPECT_EQ(unit_of("\xE0\x82\xB0"), "\xC3\xA0\xC2\x82\xC2\xB0") << "overlong";
  EXPECT_EQ(unit_of("\xED\xA0\x80"), "\xC3\xAD\xC2\xA0\xC2\x80") << "a surrogate";
  EXPECT_EQ(unit_of("\xF4\x90\x80\x80"), "\xC3\xB4\xC2\x90\xC2\x80\xC2\x80")
      << "beyond the highest character";
}

TEST(DbcReaderTest, KeepsSignalsAndMessagesOnOneLine) {
  const std::string signal = " : 0|8@1+ (1,0) [0|0] \"\" ";
  const auto dbc = parse_dbc("BO_ 1 A: 8 X SG_ S" + signal + "Y,Z SG_ T" + signal +
                                 "Y BO_ 2 B: 8 X\n SG_ U" + signal + "\n SG_ V" + signal + "Y ;\n",
                             "x.dbc");
  ASSERT_TRUE(dbc) << dbc.error().message;
  ASSERT_EQ(dbc->messages.size(), 2U);
  EXPECT_NE(dbc->find("A")->find("T"), nullptr);
  EXPECT_EQ(dbc->find("A")->signals.size(), 2U);
  EXPECT_NE(dbc->find("B")->find("U"), nullptr);
  EXPECT_NE(dbc->find("B")->find("V"), nullptr);
}

TEST(DbcReaderTest, ReadsReceiversOnFurtherLines) {
  const std::string begin = "BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"\"";
  const std::string end = "\n SG_ T : 8|8@1+ (1,0) [0|0] \"\" Y\n";
  for (const std::string receivers : {" Y", "\n  Y,\n  Z", " Y,FILTER", " FILTER", " Y Z", ""}) {
    const auto dbc = parse_dbc(begin + receivers + end, "x.dbc");
    ASSERT_TRUE(dbc) << receivers << dbc.error().message;
    EXPECT_EQ(dbc->messages[0].signals.size(), 2U) << receivers;
  }
  EXPECT_EQ(error_of(begin + " Y," + end), "x.dbc:3: found SG_, wanted the name of a receiver");
}

TEST(DbcReaderTest, ReadsAllKindsOfLineEnds) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const std::string text =
        "BO_ 1 A: 8 X" + end + " SG_ S : 0|8@1+ (1,0) [0|0] \"\"" + end + "BO_ 2 B: 8 X" + end;
    const auto dbc = parse_dbc(text, "x.dbc");
    ASSERT_TRUE(dbc) << dbc.error().message;
    EXPECT_EQ(dbc->find("B")->line, 3);
  }
}

TEST(DbcReaderTest, NodesMayBeNamedLikeKeywords) {
  const auto dbc = parse_dbc(
      "VERSION \"\"\nBU_: X FILTER CAT_\nBO_ 1 A: 8 FILTER\nVAL_TABLE_ T 1 \"a\";\n", "x.dbc");
  ASSERT_TRUE(dbc) << dbc.error().message;
  EXPECT_EQ(dbc->messages.size(), 1U);
  EXPECT_EQ(parse_dbc("BU_: X BO_ 1 A: 8 X\n", "x.dbc")->messages.size(), 1U);
}

TEST(DbcReaderTest, SkipsUnknownStatementsButNoMessage) {
  const std::string message = "BO_ 1 A: 8 X\n";
  const auto dbc =
      parse_dbc(message + "BA_DEF_SGTYPE_ \"x\" INT 0 1;\nNEW_ 1 \"y\";\nBO_ 2 B: 8 X\n", "x.dbc");
  ASSERT_TRUE(dbc) << dbc.error().message;
  EXPECT_EQ(dbc->messages.size(), 2U);
  EXPECT_EQ(dbc->skipped.at("NEW_"), 1U);
  EXPECT_EQ(error_of(message + "NEW_ 1\nBO_ 2 B: 8 X\nVAL_TABLE_ T 1 \"a\";\n"),
            "x.dbc:2: found NEW_, wanted a keyword of DBC files, such as BO_ or VAL_");
  EXPECT_EQ(error_of(message + "CM_ \"a\"\nBO_ 2 B: 8 X\nVAL_TABLE_ T 1 \"a\";\n"),
            "x.dbc:3: found BO_, wanted ';'");
}

TEST(DbcReaderTest, FindsAllValuesOfAName) {
  const auto dbc = parse_dbc(
      "BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" Y\nVAL_ 1 S 1 \"R\" 7 \"R\" 2 \"N\" ;\n",
      "x.dbc");
  ASSERT_TRUE(dbc) << dbc.error().message;
  EXPECT_EQ(dbc->messages[0].signals[0].values_named("R"), (std::vector<int64_t>{1, 7}));
  EXPECT_TRUE(dbc->messages[0].signals[0].values_named("X").empty());
}

TEST(DbcReaderTest, GivesNamedValuesTheSignOfTheirSignal) {
  const auto values = [](const std::string& layout, const std::string& raw) {
    const auto dbc = parse_dbc(
        "BO_ 1 A: 8 X\n SG_ S : " + layout + " (1,0) [0|0] \"\" Y\nVAL_ 1 S " + raw + " \"N\" ;\n",
        "x.dbc");
    EXPECT_TRUE(dbc) << dbc.error().message;
    EXPECT_EQ(dbc->messages[0].left_out, "");
    return dbc->messages[0].signals[0].values_named("N").at(0);
  };
  EXPECT_EQ(values("0|16@1-", "32768"), -32768);
  EXPECT_EQ(values("0|16@1-", "-32768"), -32768);
  EXPECT_EQ(values("0|16@1-", "65535"), -1);
  EXPECT_EQ(values("0|16@1-", "32767"), 32767);
  EXPECT_EQ(values("0|16@1+", "32768"), 32768);
  EXPECT_EQ(values("0|8@1+", "-1"), 255);
  EXPECT_EQ(values("0|1@1-", "1"), -1);
  EXPECT_EQ(values("0|64@1-", "9223372036854775808"), INT64_MIN);
  EXPECT_EQ(values("0|8@1+", "256"), 256) << "no harm, because the signal never has it";
}

TEST(DbcReaderTest, LeavesOutMessagesThatCannotBeRight) {
  const auto left_out = [](const std::string& signals, const std::string& later = "") {
    const auto dbc = parse_dbc(
        "BO_ 1 A: 8 X\n" + signals + "\nBO_ 2 B: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" Y\n" + later,
        "x.dbc");
    if (!dbc) return dbc.error().message;
    EXPECT_EQ(dbc->find("B")->left_out, "");
    EXPECT_EQ(dbc->find("B")->signals.size(), 1U);
    EXPECT_TRUE(dbc->find("A")->signals.empty());
    return dbc->find("A")->left_out;
  };
  EXPECT_EQ(left_out(" SG_ S : 60|8@1+ (1,0) [0|0] \"\" Y"),
            "x.dbc:2: found signal S up to byte 9, wanted within the 8 bytes of message A");
  EXPECT_EQ(left_out(" SG_ S : 0|0@1+ (1,0) [0|0] \"\" Y"),
            "x.dbc:2: found signal S with 0 bits, wanted 1 to 64");
  EXPECT_EQ(left_out(" SG_ S : 0|8@1+ (0,0) [0|0] \"\" Y", "VAL_ 1 S 0 \"a\" ;\n"),
            "x.dbc:2: found signal S with scale 0, wanted another scale");
  EXPECT_EQ(left_out(" SG_ S : 0|8@1+ (1,0) [5|1] \"\" Y"),
            "x.dbc:2: found signal S from 5 to 1, wanted the smaller value first");
  EXPECT_EQ(left_out(" SG_ S m0 : 0|8@1+ (1,0) [0|0] \"\" Y"),
            "x.dbc:1: found message A with 0 multiplexors, wanted one multiplexor (M) beside "
            "multiplexed signals");
  EXPECT_EQ(left_out(" SG_ S : 0|8@1+ (1,0) [0|0] \"\" Y", "SIG_VALTYPE_ 1 S : 1;\n"),
            "x.dbc:5: found signal S with 8 bits, wanted 32 bits for this type");
  EXPECT_EQ(
      left_out(" SG_ S : 0|8@1- (1,0) [0|0] \"\" Y", "VAL_ 1 S 256 \"SNA\" ;\n"),
      "x.dbc:2: found value 256 of signal S with the name SNA, wanted a value that fits into 8 "
      "bits");
}

TEST(DbcReaderTest, ReadsTwoMultiplexorsWithTheirValues) {
  const auto dbc = parse_dbc(
      "BO_ 1 A: 8 X\n SG_ S M : 0|8@1+ (1,0) [0|0] \"\" Y\n SG_ T M : 8|8@1+ (1,0) [0|0] \"\" Y\n"
      " SG_ U m1 : 16|8@1+ (1,0) [0|0] \"\" Y\nSG_MUL_VAL_ 1 U S 1-1;\n"
      "BO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 X\n SG_ O : 0|0@1+ (0,0) [1|0] \"\" X\n",
      "x.dbc");
  ASSERT_TRUE(dbc) << dbc.error().message;
  ASSERT_EQ(dbc->messages.size(), 1U);
  EXPECT_EQ(dbc->messages[0].left_out, "");
  EXPECT_TRUE(dbc->messages[0].nested_multiplexing);
  EXPECT_EQ(dbc->messages[0].signals.size(), 3U);
}

TEST(DbcReaderTest, ReadsTheValuesOfTheOnlyMultiplexor) {
  const std::string message =
      "BO_ 1 A: 8 X\n SG_ S M : 0|8@1+ (1,0) [0|0] \"\" Y\n"
      " SG_ U m0 : 16|8@1+ (1,0) [0|0] \"\" Y\n";
  const auto dbc = parse_dbc(message + "SG_MUL_VAL_ 1 U S 0-3, 7 - 9;\n", "x.dbc");
  ASSERT_TRUE(dbc) << dbc.error().message;
  EXPECT_FALSE(dbc->messages[0].nested_multiplexing);
  const DbcSignal& signal = *dbc->messages[0].find("U");
  EXPECT_EQ(signal.multiplexed_at, (std::vector<DbcValueRange>{{0, 3}, {7, 9}}));
  EXPECT_TRUE(signal.is_present_at(2));
  EXPECT_FALSE(signal.is_present_at(4));
  EXPECT_TRUE(dbc->messages[0].find("S")->is_present_at(4));
  for (const std::string bad : {"3-0", "3", "a-b", "0-3x", "-3"}) {
    EXPECT_EQ(error_of(message + "SG_MUL_VAL_ 1 U S " + bad + ";\n"),
              "x.dbc:4: found " + bad + ", wanted a range of values, such as 2-5");
  }
}

TEST(DbcReaderTest, SaysWhereAQuoteBegins) {
  EXPECT_EQ(error_of("BO_ 1 A: 8 X\nCM_ BO_ 1 \"never\nclosed;\nBO_ 2 B: 8 X\n"),
            "x.dbc:2: found a quote that nothing closes, wanted ';'");
}

TEST(DbcReaderTest, SaysWhereAndWhatIsWrong) {
  const std::string message = "VERSION \"\"\nBO_ 1 A: 8 X\n";
  EXPECT_EQ(error_of(message + " SG_ S : 6|8@0+ (1,0) [0|0] \"\" Y\nBO_ 1 B: 8 X\n"),
            "x.dbc:4: found identifier 1 a second time, wanted each identifier once");
  EXPECT_EQ(error_of(message + " SG_ S : 0|8@2+ (1,0) [0|0] \"\" Y\n"),
            "x.dbc:3: found 2+, wanted byte order and sign: 0+, 0-, 1+ or 1-");
  EXPECT_EQ(error_of(message + "VAL_ 2 S 0 \"a\" ;\n"),
            "x.dbc:3: found 2, wanted the identifier of a message of this file");
  EXPECT_EQ(error_of(message + "VAL_ 1 S 0 \"a\" ;\n"),
            "x.dbc:3: found S, wanted the name of a signal of message A");
  EXPECT_EQ(error_of("VERSION \"\"\nBS_:\n"),
            "x.dbc: found no message, wanted a DBC file with BO_ lines");
  EXPECT_EQ(error_of("<html>"),
            "x.dbc:1: found <html>, wanted a keyword of DBC files, such as BO_ or VAL_");
  EXPECT_EQ(error_of(message + "CM_ \"no end"),
            "x.dbc:3: found a quote that nothing closes, wanted ';'");
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
