#include "evaluation/drive/fault_socket.h"

#include <future>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;

/// The length of the planned drive.
constexpr double kPlanned_s = 80.0;

firmware::CanConfig own_bus_without_heading_valid() {
  firmware::CanConfig can;
  can.vehicle.emplace().gnss.emplace().heading = 0;
  return can;
}

class FaultSocketTest : public testing::Test {
 protected:
  void SetUp() override {
    auto server = FaultServer::open(path_, faults_, {kPlanned_s, true, can_});
    ASSERT_TRUE(server) << server.error().message;
    server_ = std::move(*server);
  }

  /// Sends a command from another thread while the server steps.
  Result<std::string> send(const std::string& command) {
    auto answer =
        std::async(std::launch::async, [&] { return send_fault_command(path_, command); });
    while (answer.wait_for(std::chrono::milliseconds(1)) != std::future_status::ready) {
      server_->step(12.0);
    }
    return answer.get();
  }
  std::string error_of(const std::string& command) {
    const auto answer = send(command);
    return answer ? "" : answer.error().message;
  }

  const test::TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_ / "socket";
  const firmware::CanConfig can_ = own_bus_without_heading_valid();
  const std::shared_ptr<sim::FaultBoard> faults_ = std::make_shared<sim::FaultBoard>();
  std::unique_ptr<FaultServer> server_;
};

TEST_F(FaultSocketTest, SetsListsAndClears) {
  EXPECT_THAT(send("set gnss_jump east_m=5 for_s=3").value(),
              HasSubstr("1: gnss_jump from_s=12 until_s=15 east_m=5"));
  ASSERT_EQ(faults_->active(sim::FaultInput::kGnss, 13.0).size(), 1U);
  send("set camera_dark camera=front");
  const std::string list = send("list").value();
  EXPECT_THAT(list, HasSubstr("1: gnss_jump"));
  EXPECT_THAT(list, HasSubstr("2: camera_dark from_s=12 camera=front"));
  EXPECT_TRUE(send("clear 1"));
  ASSERT_EQ(faults_->list().size(), 1U);
  EXPECT_EQ(faults_->list()[0].number, 2U);
  EXPECT_TRUE(send("clear"));
  EXPECT_TRUE(faults_->list().empty());
}

TEST_F(FaultSocketTest, SaysWhyACommandIsRefused) {
  EXPECT_THAT(error_of("jump"), HasSubstr("found 'jump', wanted set, list or clear"));
  EXPECT_THAT(error_of("set gnss_jump up_m=3"), HasSubstr("up_m"));
  EXPECT_THAT(error_of("set map_shifted east_m=3"), HasSubstr("simulation.faults"));
  EXPECT_THAT(error_of("set hang_vision"), HasSubstr("--fast"));
  EXPECT_THAT(error_of("set gnss_no_heading"),
              HasSubstr("found gnss_no_heading, wanted can.vehicle.gnss.heading_valid"));
  EXPECT_THAT(error_of("clear 7"), HasSubstr("found 7"));
  EXPECT_THAT(error_of("clear all"), HasSubstr("found all"));
  EXPECT_TRUE(faults_->list().empty());
}

TEST_F(FaultSocketTest, RefusesASuspensionBeyondTheEndOfTheDrive) {
  EXPECT_THAT(error_of("set clock_suspend gap_s=69"), HasSubstr("found 69, wanted at most 68.0"));
  EXPECT_THAT(error_of("set clock_suspend gap_s=21 from_s=60"), HasSubstr("wanted at most 20.0"));
  EXPECT_THAT(error_of("set clock_suspend gap_s=3600"), HasSubstr("simulation.faults"));
  EXPECT_TRUE(faults_->list().empty());
  EXPECT_EQ(error_of("set clock_suspend gap_s=60"), "");
  EXPECT_THAT(error_of("set clock_suspend gap_s=9"), HasSubstr("found 9, wanted at most 8.0"));
  EXPECT_EQ(error_of("set clock_suspend gap_s=8"), "");
  EXPECT_EQ(error_of("set clock_gap gap_s=3600"), "") << "the drive goes on with the clock";
}

TEST_F(FaultSocketTest, AServerReplacesTheSocketOfAnEarlierRunAndRemovesItsOwn) {
  const auto second = FaultServer::open(path_, faults_, {kPlanned_s, true, can_});
  EXPECT_TRUE(second);
  server_.reset();
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_THAT(send_fault_command(path_, "list").error().message, HasSubstr(path_.string()));
}

}  // namespace
}  // namespace bevloc::evaluation
