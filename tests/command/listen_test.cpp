#include <cstdio>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "command/listen/listen_command.h"
#include "tests/support/command_line.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::command {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// A LOC_Status and a message that is not known.
const std::string kLog =
    "(0000000005.000000) can0 500#AD4481FF00007AD0\n(0000000005.100000) can0 123#00\n";

class ListenTest : public testing::Test {
 protected:
  /// What `bevloc listen` prints.
  struct Heard {
    Status status;
    std::string output;
  };
  Heard listen(std::vector<std::string> words) {
    parse(std::move(words));
    testing::internal::CaptureStdout();
    Status status = command_.run();
    std::fflush(stdout);
    return {status, testing::internal::GetCapturedStdout()};
  }
  void parse(std::vector<std::string> words) {
    command_.declare(app_);
    words.insert(words.begin(), "listen");
    test::parse(app_, std::move(words));
  }

  CLI::App app_;
  ListenCommand command_;
};

TEST_F(ListenTest, ReadsAPipe) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_EQ(write(ends[1], kLog.data(), kLog.size()), static_cast<ssize_t>(kLog.size()));
  close(ends[1]);
  const Heard heard = listen({"/dev/fd/" + std::to_string(ends[0])});
  close(ends[0]);
  ASSERT_TRUE(heard.status) << heard.status.error().message;
  EXPECT_THAT(heard.output, HasSubstr(" State=ACQUIRING "));
}

TEST_F(ListenTest, RefusesAFolder) {
  const Heard heard = listen({"/tmp"});
  ASSERT_FALSE(heard.status);
  EXPECT_EQ(heard.status.error().message,
            "/tmp: found a folder, wanted a CAN interface, a candump log or -");
}

TEST_F(ListenTest, RefusesANameThatIsTooLongForAFile) {
  const std::string name(5000, 'x');
  const Heard heard = listen({name});
  ASSERT_FALSE(heard.status);
  EXPECT_THAT(heard.status.error().message, StartsWith(name));
}

TEST_F(ListenTest, QuietJsonIsOneObjectOfTotals) {
  const test::TemporaryFolder folder;
  const std::string log = folder.path() / "can.log";
  std::ofstream(log) << kLog;
  const Heard heard = listen({"--quiet", "--json", log});
  ASSERT_TRUE(heard.status);
  const auto totals = nlohmann::json::parse(heard.output);
  EXPECT_EQ(
      totals["messages"][0],
      (nlohmann::json{{"message", "LOC_Status"}, {"frames", 1}, {"unusable", 0}, {"lost", 0}}));
  EXPECT_EQ(totals["other_frames"], 1);
}

TEST_F(ListenTest, ALogOfSeveralInterfacesIsCheckedByInterface) {
  const test::TemporaryFolder folder;
  const std::string log = folder.path() / "can.log";
  std::ofstream(log) << "(0000000005.000000)  can0 500#AD4481FF00007AD0\n"
                        "(0000000005.000000) vcan1 500#AD4481FF00007AD0\n"
                        "DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 3)\n";
  const Heard heard = listen({log});
  ASSERT_TRUE(heard.status) << heard.status.error().message;
  EXPECT_THAT(heard.output, StartsWith("5.000000 LOC_Status ok "));
  EXPECT_THAT(heard.output, HasSubstr("\n5.000000 LOC_Status ok "));
  EXPECT_THAT(heard.output,
              HasSubstr("\nLOC_Status                            2          0        0\n"));
}

TEST_F(ListenTest, QuietAndCountExcludeEachOther) {
  EXPECT_THROW(parse({"--quiet", "--count", "3", "can0"}), CLI::ExcludesError);
}

/// A bus that delivers one frame and then is passive.
class OneFrameBus final : public can::Bus {
 public:
  can::SendResult send(const can::Frame&, Time) override { return can::SendResult::kSent; }
  std::optional<can::ReceivedFrame> receive() override {
    return std::exchange(frame_, std::nullopt);
  }
  bool wait(Duration) override { return true; }
  can::BusCounters counters() const override {
    return {.receive_dropped = 12, .receive_ignored = 34};
  }
  can::BusCondition condition() const override {
    return {.state = can::BusState::kPassive,
            .faults = static_cast<uint8_t>(can::BusFault::kNoAcknowledge)};
  }

 private:
  std::optional<can::ReceivedFrame> frame_{{{.id = 0x500, .length = 8}, Time{}}};
};

TEST_F(ListenTest, SaysWhatTheBusLostAndItsCondition) {
  parse({"can0", "--count", "1"});
  OneFrameBus bus;
  can::BusListener listener({}, {});
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  command_.listen_to_bus(bus, listener);
  command_.print_totals(listener);
  std::fflush(stdout);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "bevloc: can0: the bus is now error-passive (no acknowledgement)\n");
  const std::string output = testing::internal::GetCapturedStdout();
  EXPECT_THAT(output, HasSubstr("\nframes dropped by the socket         12\n"));
  EXPECT_THAT(output, HasSubstr("\n29-bit, remote or bad frames         34\n"));
}

}  // namespace
}  // namespace bevloc::command
