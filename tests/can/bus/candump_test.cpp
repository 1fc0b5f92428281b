#include "can/bus/candump.h"

#include <clocale>
#include <locale>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bevloc::can {
namespace {

using std::chrono::nanoseconds;
using testing::HasSubstr;

constexpr nanoseconds kTime(1436509052249713123);

Frame sample_frame() {
  return {.id = 0x44, .length = 5, .data = {0x2A, 0x36, 0x6C, 0x2B, 0xBA}};
}

CandumpEntry parsed(std::string_view line) {
  const auto entry = parse_candump_line(line, "test:1");
  EXPECT_TRUE(entry) << entry.error().message;
  return entry ? *entry : CandumpEntry{};
}

TEST(Candump, WritesTheFormatOfCandump) {
  EXPECT_EQ(candump_line(kTime, "can0", sample_frame()), "(1436509052.249713) can0 044#2A366C2BBA");
  EXPECT_EQ(candump_line(kTime, "can0", sample_frame(), CandumpDigits::kNanoseconds),
            "(1436509052.249713123) can0 044#2A366C2BBA");
  EXPECT_EQ(candump_line(nanoseconds(1000), "vcan0", {.id = 0x7FF}),
            "(0000000000.000001) vcan0 7FF#");
}

TEST(Candump, DoesNotDependOnTheLocale) {
  struct Grouping : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale(), new Grouping));
  const std::string line = candump_line(kTime, "can0", sample_frame());
  const auto entry = parse_candump_line(line, "test:1");
  std::locale::global(before);
  EXPECT_EQ(line, "(1436509052.249713) can0 044#2A366C2BBA");
  ASSERT_TRUE(entry);
  EXPECT_EQ(entry->time, nanoseconds(1436509052249713000));
}

TEST(Candump, ReadsBackWhatItWrites) {
  for (uint8_t length = 0; length <= kMaxClassicLength; ++length) {
    Frame frame{.id = 0x100u + length, .length = length};
    for (uint8_t i = 0; i < length; ++i) frame.data[i] = static_cast<uint8_t>(251 * i + 17);
    const auto line = candump_line(kTime, "can1", frame, CandumpDigits::kNanoseconds);
    const CandumpEntry entry = parsed(line);
    EXPECT_EQ(entry.time, kTime);
    EXPECT_EQ(entry.interface, "can1");
    EXPECT_EQ(entry.kind, CandumpKind::kData);
    EXPECT_EQ(entry.frame, frame);
  }
}

TEST(Candump, ReadsBackTheFdFramesThatItWrites) {
  for (size_t length = 0; length <= kMaxFdLength; ++length) {
    if (!is_valid_length(FrameFormat::kFd, length)) continue;
    Frame frame{.id = 0x509,
                .length = static_cast<uint8_t>(length),
                .data = {},
                .format = FrameFormat::kFd};
    for (size_t i = 0; i < length; ++i) frame.data[i] = static_cast<uint8_t>(251 * i + 17);
    const CandumpEntry entry = parsed(candump_line(kTime, "can1", frame));
    EXPECT_EQ(entry.kind, CandumpKind::kData);
    EXPECT_EQ(entry.frame, frame);
  }
}

TEST(Candump, WritesFdAndErrorFramesAsCandumpDoes) {
  Frame frame = sample_frame();
  frame.format = FrameFormat::kFd;
  EXPECT_EQ(candump_line(kTime, "can0", frame), "(1436509052.249713) can0 044##12A366C2BBA");
  const ErrorFrame error{.classes = 0x44, .data = {0, 0x30, 0, 0, 0, 0, 0x80, 0x7F}};
  const std::string line = candump_line(kTime, "can0", error);
  EXPECT_EQ(line, "(1436509052.249713) can0 20000044#003000000000807F");
  EXPECT_EQ(parsed(line).kind, CandumpKind::kError);
  EXPECT_EQ(parsed(line).error, error);
}

TEST(Candump, RecognisesTheKindOfAFrame) {
  EXPECT_EQ(parsed("(1.000000) can0 123#").kind, CandumpKind::kData);
  EXPECT_EQ(parsed("(1.000000) can0 00000123#01").kind, CandumpKind::kExtended);
  EXPECT_EQ(parsed("(1.000000) can0 123#R").kind, CandumpKind::kRemote);
  EXPECT_EQ(parsed("(1.000000) can0 123#R8").kind, CandumpKind::kRemote);
  EXPECT_EQ(parsed("(1.000000) can0 7DF#R8_9").kind, CandumpKind::kRemote);
  EXPECT_EQ(parsed("(1.000000) can0 7DF#R8_F").kind, CandumpKind::kRemote);
  EXPECT_EQ(parsed("(1.000000) can0 123##1AABBCC").frame.format, FrameFormat::kFd);
  EXPECT_EQ(parsed("(1.000000) can0 123##5AABBCC").frame.length, 3);
  EXPECT_EQ(parsed("(1.000000) can0 00000123##1AA").kind, CandumpKind::kExtended);
  EXPECT_EQ(parsed("(1.000000) can0 20000040#0000000000000000").kind, CandumpKind::kError);
  EXPECT_EQ(parsed("(1.000000) can0 123#1122334455667788_B").frame.length, 8);
  EXPECT_EQ(parsed("(1.000000) can0 123#01 R").frame.length, 1);
}

TEST(Candump, ReadsAnInterfaceThatCandumpHasAligned) {
  const CandumpEntry entry = parsed("(1436509052.249713)   can0 504#D700000080000080");
  EXPECT_EQ(entry.interface, "can0");
  EXPECT_EQ(entry.kind, CandumpKind::kData);
  EXPECT_EQ(entry.frame.id, 0x504u);
}

TEST(Candump, RefusesBadLines) {
  for (const std::string_view line : {
           "nonsense",
           "(1.000000) can0",
           "1.000000 can0 123#00",
           "(1.0) can0 123#00",
           "(1.00000a) can0 123#00",
           "(-1.000000) can0 123#00",
           "(99999999999999.000000) can0 123#00",
           "(1.000000)  123#00",
           "(1.000000)  ",
           "(1.000000) can0 12#00",
           "(1.000000) can0 1234#00",
           "(1.000000) can0 800#00",
           "(1.000000) can0 G23#00",
           "(1.000000) can0 123#0",
           "(1.000000) can0 123#0G",
           "(1.000000) can0 123#001122334455667788",
           "(1.000000) can0 123#R9",
           "(1.000000) can0 123#R8_8",
           "(1.000000) can0 123#R7_9",
           "(1.000000) can0 123#R8_G",
           "(1.000000) can0 123#R8_",
           "(1.000000) can0 123##",
           "(1.000000) can0 123##1A",
           "(1.000000) can0 123##GAA",
           "(1.000000) can0 123##1001122334455667788",
           "(1.000000) can0 20000004#00",
           "(1.000000) can0 FFFFFFFF#00",
           "(1.000000) can0 123#00 X",
       }) {
    const auto entry = parse_candump_line(line, "drive.log:7");
    ASSERT_FALSE(entry) << line;
    EXPECT_THAT(entry.error().message, HasSubstr("drive.log:7"));
  }
}

TEST(Candump, ReadsALogAndNamesTheBadLine) {
  std::istringstream good("(1.000000) can0 001#01\n\n(2.500000) can0 002#02\r\n");
  const auto entries = read_candump(good, "drive.log");
  ASSERT_TRUE(entries) << entries.error().message;
  ASSERT_EQ(entries->size(), 2u);
  EXPECT_EQ((*entries)[1].time, nanoseconds(2'500'000'000));

  std::istringstream bad("(1.000000) can0 001#01\nwhat is this\n");
  const auto refused = read_candump(bad, "drive.log");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("drive.log:2: found 'what is this'"));
}

TEST(Candump, SkipsLinesAboutDroppedFrames) {
  std::istringstream log(
      "(1.000000) can0 001#01\n"
      "DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)\n"
      "(2.500000) can0 002#02\n");
  const auto entries = read_candump(log, "drive.log");
  ASSERT_TRUE(entries) << entries.error().message;
  EXPECT_EQ(entries->size(), 2u);
}

TEST(Candump, AMissingFileIsAnError) {
  const auto entries = read_candump_file("/nonexistent/drive.log");
  ASSERT_FALSE(entries);
  EXPECT_THAT(entries.error().message, HasSubstr("/nonexistent/drive.log"));
}

TEST(Candump, AFolderIsAnErrorAndNoEmptyLog) {
  const auto entries = read_candump_file("/tmp");
  ASSERT_FALSE(entries);
  EXPECT_EQ(entries.error().message, "/tmp: found no readable file, wanted a candump log");
}

}  // namespace
}  // namespace bevloc::can
