// Tests the reader of gpsd's reports and the client.
#include <cerrno>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/gnss/gpsd_client.h"
#include "tests/support/mock_gpsd.h"
#include "tests/support/text.h"

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const std::string kFix =
    R"({"class":"TPV","device":"/dev/ttyACM0","mode":3,"time":"2026-11-23T22:23:04.125Z",)"
    R"("lat":49.0112,"lon":8.4044,"epx":2.1,"epy":3.2,"track":271.5,"speed":12.5,"epd":4.0})";

/// As gpsd 3.22 writes it for NMEA with GST, from a receiver with an RTK fix.
const std::string kRtkFix =
    R"({"class":"TPV","device":"/dev/pts/0","status":3,"mode":3,"time":"2026-11-24T03:25:31.400Z",)"
    R"("ept":0.005,"lat":49.011200000,"lon":8.404960578,"altHAE":157.0000,"altMSL":110.0000,)"
    R"("alt":110.0000,"epv":23.000,"track":90.0000,"magtrack":92.5516,"magvar":2.6,"speed":12.000,)"
    R"("climb":0.000,"epc":230.00,"geoidSep":47.000,"eph":13.300,"sep":22.800})";
std::string accuracy_at(const std::string& second) {
  return R"({"class":"GST","device":"/dev/pts/0","time":"2026-11-24T03:25:)" + second +
         R"(Z","rms":0.5,"major":0.3,"minor":0.2,"orient":10.0,"lat":0.25,"lon":0.30,"alt":0.6})";
}

GpsdLine line_of(const std::string& text) {
  return GpsdReader().read(text).line;
}

/// A report of a fix with `from` replaced by `to`.
std::string fix_with(const std::string& from, const std::string& to) {
  return test::replaced(kFix, from, to);
}

/// Reads a fix and the accuracy for it. Returns the sigma of a second fix.
double sigma_after_accuracy(GpsdReader& reader, const std::string& second_fix) {
  reader.read(kRtkFix);
  reader.read(accuracy_at("31.200"));
  return reader.read(second_fix).fix.sigma_east_m;
}

TEST(GpsdReaderTest, ReadsAFixWithItsErrorsAndTime) {
  const GpsdReport report = GpsdReader().read(kFix);
  ASSERT_EQ(report.line, GpsdLine::kFix);
  EXPECT_DOUBLE_EQ(report.fix.latitude_deg, 49.0112);
  EXPECT_DOUBLE_EQ(report.fix.longitude_deg, 8.4044);
  EXPECT_DOUBLE_EQ(report.fix.sigma_east_m, 2.1);
  EXPECT_DOUBLE_EQ(report.fix.sigma_north_m, 3.2);
  EXPECT_EQ(report.fix.course_deg, 271.5);
  EXPECT_DOUBLE_EQ(report.fix.sigma_course_deg, 4.0);
  EXPECT_EQ(report.fix.speed_mps, 12.5);
  EXPECT_EQ(report.fix.utc, seconds(1795472584) + milliseconds(125));
}

TEST(GpsdReaderTest, DividesTheHorizontalErrorOverTheAxes) {
  const auto report =
      GpsdReader().read(fix_with(R"("epx":2.1,"epy":3.2)", R"("eph":2.82842712475)"));
  ASSERT_EQ(report.line, GpsdLine::kFix);
  EXPECT_NEAR(report.fix.sigma_east_m, 2.0, 1e-9);
  EXPECT_NEAR(report.fix.sigma_north_m, 2.0, 1e-9);
}

// As gpsd 3.22 writes it for UBX: eph is hAcc of the receiver, epx and epy are 15 m times the
// dilution of precision.
TEST(GpsdReaderTest, PrefersTheReceiversHorizontalErrorToTheGuessForTheAxes) {
  const auto report = GpsdReader().read(
      fix_with(R"("epx":2.1,"epy":3.2)", R"("epx":16.774,"epy":13.999,"eph":0.800)"));
  ASSERT_EQ(report.line, GpsdLine::kFix);
  EXPECT_NEAR(report.fix.sigma_east_m, 0.8 / std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(report.fix.sigma_north_m, 0.8 / std::sqrt(2.0), 1e-9);
}

TEST(GpsdReaderTest, PrefersTheReceiversOwnAccuracy) {
  GpsdReader reader;
  EXPECT_NEAR(reader.read(kRtkFix).fix.sigma_east_m, 13.3 / std::sqrt(2.0), 1e-9);
  EXPECT_EQ(reader.read(accuracy_at("31.200")).line, GpsdLine::kAccuracy);
  EXPECT_DOUBLE_EQ(reader.read(kRtkFix).fix.sigma_north_m, 0.25);
  EXPECT_DOUBLE_EQ(reader.read(kRtkFix).fix.sigma_east_m, 0.30);
  reader.read(accuracy_at("29.800"));
  EXPECT_GT(reader.read(kRtkFix).fix.sigma_east_m, 9.0) << "1.6 s old";
  reader.read(accuracy_at("31.600"));
  EXPECT_GT(reader.read(kRtkFix).fix.sigma_east_m, 9.0) << "of a later fix";
}

TEST(GpsdReaderTest, ForgetsTheAccuracyWhenTheKindOfFixChanges) {
  GpsdReader reader;
  const std::string single = test::replaced(kRtkFix, "\"status\":3", "\"status\":1");
  EXPECT_GT(sigma_after_accuracy(reader, single), 9.0);
  EXPECT_GT(reader.read(single).fix.sigma_east_m, 9.0) << "until the next GST";
}

TEST(GpsdReaderTest, DoesNotGiveTheAccuracyOfOneReceiverToAnother) {
  GpsdReader reader;
  EXPECT_GT(sigma_after_accuracy(reader, test::replaced(kRtkFix, "/dev/pts/0", "/dev/pts/1")), 9.0);
}

TEST(GpsdReaderTest, ReadsOnlyTimesOfTheFormThatItNames) {
  EXPECT_EQ(utc_of("2026-11-23T22:23:04.125Z"), seconds(1795472584) + milliseconds(125));
  EXPECT_EQ(utc_of("2026-11-23T22:23:04Z"), seconds(1795472584));
  for (const char* text :
       {"2026-11-23T22:23:04.125Zgarbage", "2026-11-23T22:23:0x4Z", "2026-11-23T22:23: 4Z",
        "2026-11-23T22:23:4e0Z", "2026-11-23T22:23:04", "2026-11-01 00:00:00", ""}) {
    EXPECT_EQ(utc_of(text), std::nullopt) << text;
  }
}

TEST(GpsdReaderTest, SaysWhyALineIsNoFix) {
  EXPECT_EQ(line_of(R"({"class":"SKY","hdop":1.0})"), GpsdLine::kOther);
  EXPECT_EQ(line_of(R"({"class":"TPV","mode":1})"), GpsdLine::kNoFix);
  EXPECT_EQ(line_of(fix_with("\"mode\":3", "\"mode\":1")), GpsdLine::kNoFix);
  EXPECT_EQ(line_of(fix_with("49.0112", "\"49\"")), GpsdLine::kNoFix);
  EXPECT_EQ(line_of(fix_with("\"epx\":2.1,", "")), GpsdLine::kNoAccuracy);
  EXPECT_EQ(line_of(fix_with("\"time\"", "\"tame\"")), GpsdLine::kNoTime);
  EXPECT_EQ(line_of(fix_with("2026-11", "2026-13")), GpsdLine::kNoTime);
  EXPECT_EQ(line_of(fix_with("\"mode\":3", "\"mode\":3,\"status\":8")), GpsdLine::kNotSatellites);
  EXPECT_EQ(line_of(fix_with("\"mode\":3", "\"mode\":3,\"status\":5")), GpsdLine::kNotSatellites);
  EXPECT_EQ(line_of(fix_with("49.0112", "91")), GpsdLine::kOutOfRange);
  EXPECT_EQ(line_of(fix_with("8.4044", "181")), GpsdLine::kOutOfRange);
  EXPECT_EQ(line_of(fix_with("2.1", "1e9")), GpsdLine::kOutOfRange);
  EXPECT_EQ(line_of(fix_with("2.1", "-1")), GpsdLine::kOutOfRange);
  EXPECT_EQ(line_of(fix_with("12.5", "1200")), GpsdLine::kOutOfRange);
  EXPECT_EQ(line_of(fix_with("2.1", "nan")), GpsdLine::kNotReadable);
  EXPECT_EQ(line_of(kFix.substr(0, 60)), GpsdLine::kNotReadable);
  EXPECT_EQ(line_of("$GPGGA,1,2"), GpsdLine::kNotReadable);
  EXPECT_EQ(line_of("[1]"), GpsdLine::kNotReadable);
  EXPECT_EQ(line_of(std::string(5000, '[')), GpsdLine::kNotReadable);
}

/// What the test waits for comes over the loopback interface within this time.
constexpr Duration kPatience = seconds(5);

class GpsdClientTest : public testing::Test {
 protected:
  /// Connects the client and takes what it says first.
  std::string connect() {
    client_.wait(now_, Duration::zero());
    gpsd_.accept_client();
    if (!client_.is_connected()) client_.wait(now_, kPatience);
    EXPECT_TRUE(client_.is_connected());
    return gpsd_.heard();
  }
  std::optional<GnssFix> next_fix() {
    client_.wait(now_, kPatience);
    return client_.take_fix();
  }
  uint64_t lines(GpsdLine kind) const {
    return client_.counters().lines[static_cast<size_t>(kind)];
  }

  test::MockGpsd gpsd_;
  GpsdClient client_{{.address = "127.0.0.1", .port = gpsd_.port(), .device = "/dev/ttyACM0"}};
  Time now_{};
};

TEST_F(GpsdClientTest, AsksForTheReportsOfOneReceiver) {
  EXPECT_EQ(connect(), "?WATCH={\"enable\":true,\"json\":true,\"device\":\"/dev/ttyACM0\"};\n");
  EXPECT_EQ(watch_command({}), "?WATCH={\"enable\":true,\"json\":true};\n");
}

TEST_F(GpsdClientTest, ReadsReportsInPieces) {
  connect();
  gpsd_.say("{\"class\":\"VERSION\"}\r\n" + kFix.substr(0, 30));
  EXPECT_FALSE(next_fix());
  gpsd_.say(kFix.substr(30) + "\r\n" + kFix + "\r\n");
  EXPECT_TRUE(next_fix());
  EXPECT_TRUE(client_.take_fix());
  EXPECT_FALSE(client_.take_fix());
  EXPECT_EQ(lines(GpsdLine::kFix), 2U);
  EXPECT_EQ(lines(GpsdLine::kOther), 1U);
}

TEST_F(GpsdClientTest, ConnectsAgainAfterALoss) {
  connect();
  gpsd_.say(kFix + "\n");
  EXPECT_TRUE(next_fix());
  gpsd_.hang_up();
  EXPECT_FALSE(next_fix());
  EXPECT_FALSE(client_.is_connected());
  now_ += milliseconds(150);
  client_.wait(now_, Duration::zero());
  client_.wait(now_, Duration::zero());
  EXPECT_FALSE(client_.is_connected()) << "not before the pause has passed";
  now_ += milliseconds(100);
  connect();
  gpsd_.say(kFix + "\n");
  EXPECT_TRUE(next_fix());
  EXPECT_EQ(client_.counters().connected, 2U);
}

TEST_F(GpsdClientTest, WaitsLongerAfterEachFailure) {
  gpsd_.stop_listening();
  std::vector<int> tries_ms;
  for (uint64_t failed = 0; tries_ms.size() < 8;) {
    client_.wait(now_, Duration::zero());  // begins
    client_.wait(now_, Duration::zero());  // sees the refusal
    if (client_.counters().failed > failed) {
      failed = client_.counters().failed;
      tries_ms.push_back(static_cast<int>(now_.time_since_epoch() / milliseconds(1)));
    }
    now_ += milliseconds(100);
  }
  EXPECT_EQ(tries_ms, (std::vector<int>{0, 200, 600, 1400, 3000, 6200, 11200, 16200}));
  EXPECT_EQ(client_.counters().failure, ECONNREFUSED);
}

TEST_F(GpsdClientTest, SkipsALineThatIsTooLong) {
  connect();
  for (int i = 0; i < 5; ++i) {
    gpsd_.say(std::string(4096, 'x'));
    EXPECT_FALSE(next_fix());
  }
  EXPECT_EQ(client_.counters().too_long, 1U);
  gpsd_.say(kFix + "\n" + kFix + "\n");
  EXPECT_TRUE(next_fix());
  EXPECT_FALSE(client_.take_fix()) << "the first one is the end of the long line";
  EXPECT_EQ(lines(GpsdLine::kNotReadable), 0U);
}

TEST_F(GpsdClientTest, GivesUpAConnectionThatIsSilent) {
  connect();
  now_ += GpsdClient::kSilence - milliseconds(1);
  client_.wait(now_, Duration::zero());
  EXPECT_TRUE(client_.is_connected());
  now_ += milliseconds(1);
  client_.wait(now_, Duration::zero());
  EXPECT_FALSE(client_.is_connected());
  EXPECT_EQ(client_.counters().silent, 1U);
}

TEST_F(GpsdClientTest, CountsAnAddressThatIsNone) {
  GpsdClient client({.address = "localhost", .port = 2947, .device = ""});
  client.wait(now_, Duration::zero());
  EXPECT_EQ(client.counters().failed, 1U);
  EXPECT_EQ(client.counters().failure, EINVAL);
}

}  // namespace
}  // namespace bevloc::drivers
