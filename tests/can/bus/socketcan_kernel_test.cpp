// Tests of SocketCanBus on a CAN interface of the kernel. They are skipped if there is none.
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include "can/bus/socketcan_bus.h"
#include "common/kernel_time.h"
#include "tests/can/bus/bus_under_test.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class SocketCanKernel : public testing::Test {
 protected:
  void SetUp() override {
    other_ = open({});
    if (!other_) GTEST_SKIP() << "SocketCan: not available on this machine";
  }

  static std::unique_ptr<SocketCanBus> open(const SocketCanOptions& options) {
    auto bus = SocketCanBus::open(kernel_interface(), options);
    return bus ? std::move(*bus) : nullptr;
  }

  std::unique_ptr<SocketCanBus> other_;
};

/// Sends an error report to the interface, as a driver does.
void report_error(uint32_t classes, uint8_t controller_status,
                  const std::string& interface = kernel_interface()) {
  const int descriptor = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  ASSERT_EQ(bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  can_frame raw{};
  raw.can_id = CAN_ERR_FLAG | classes;
  raw.can_dlc = CAN_ERR_DLC;
  raw.data[1] = controller_status;
  ASSERT_EQ(write(descriptor, &raw, sizeof(raw)), static_cast<ssize_t>(sizeof(raw)));
  close(descriptor);
}

TEST_F(SocketCanKernel, FiltersInTheKernel) {
  const auto reader = open({.accepted_ids = {0x401, 0x403}});
  ASSERT_TRUE(reader);
  for (uint32_t id = 0x400; id < 0x405; ++id) other_->send({.id = id}, Time{});
  for (const uint32_t id : {0x401u, 0x403u}) {
    ASSERT_TRUE(reader->wait(seconds(10)));
    EXPECT_EQ(reader->receive()->frame.id, id);
  }
  EXPECT_FALSE(reader->receive());
}

TEST_F(SocketCanKernel, ReceivesFdFramesWithoutBeingOpenedForFd) {
  const auto sender = open({.fd = true});
  if (!sender) GTEST_SKIP() << "SocketCan: a classic interface";
  for (const uint8_t length : {uint8_t{8}, uint8_t{12}}) {
    const Frame frame{.id = 0x401, .length = length, .format = FrameFormat::kFd};
    ASSERT_EQ(sender->send(frame, Time{}), SendResult::kSent);
    ASSERT_TRUE(other_->wait(seconds(10)));
    EXPECT_EQ(other_->receive()->frame, frame);
  }
}

TEST_F(SocketCanKernel, ConfirmsItsOwnFramesThroughTheFilter) {
  const auto sender = open({.accepted_ids = {0x401}, .confirmed_ids = {0x510, 0x511}});
  ASSERT_TRUE(sender);
  for (const uint32_t id : {0x510u, 0x511u, 0x512u}) {
    ASSERT_EQ(sender->send({.id = id}, Time{}), SendResult::kSent);
  }
  EXPECT_TRUE(sender->wait(seconds(10)));
  EXPECT_FALSE(sender->receive());
  EXPECT_EQ(sender->counters().confirmed, 2u);
  EXPECT_LT(sender->counters().confirmation_max, seconds(10));
}

TEST_F(SocketCanKernel, ReceivesFramesOfOtherNodesWithReservedIds) {
  const auto sender =
      open({.accepted_ids = {0x401}, .confirmed_ids = {0x510}, .reserved_ids = {0x510, 0x511}});
  ASSERT_TRUE(sender);
  for (const uint32_t id : {0x510u, 0x511u, 0x512u}) other_->send({.id = id}, Time{});
  for (const uint32_t id : {0x510u, 0x511u}) {
    ASSERT_TRUE(sender->wait(seconds(10)));
    EXPECT_EQ(sender->receive()->frame.id, id);
  }
  EXPECT_FALSE(sender->receive());
}

TEST_F(SocketCanKernel, HoldsAFrameBackUntilThePreviousOneIsConfirmed) {
  const auto sender = open({.confirmed_ids = {0x510}});
  ASSERT_TRUE(sender);
  EXPECT_EQ(sender->send({.id = 0x510}, Time{}), SendResult::kSent);
  EXPECT_EQ(sender->send({.id = 0x510, .length = 1}, Time{}), SendResult::kWaiting);
  EXPECT_TRUE(sender->wait(seconds(10)));
  EXPECT_FALSE(sender->receive());
  EXPECT_EQ(sender->send({.id = 0x510, .length = 2}, Time{}), SendResult::kSent);
  EXPECT_EQ(sender->counters().send_replaced, 1u);
}

TEST_F(SocketCanKernel, StampsFramesByTheKernel) {
  const auto reader = open({});
  ASSERT_TRUE(reader);
  const Time before = steady_now();
  ASSERT_EQ(other_->send({.id = 1}, Time{}), SendResult::kSent);
  const Time after = steady_now();
  ASSERT_TRUE(reader->wait(seconds(10)));
  const auto received = reader->receive();
  ASSERT_TRUE(received);
  constexpr Duration kConversionError = milliseconds(1);  // two clocks are read one after the other
  EXPECT_GE(received->received, before - kConversionError);
  EXPECT_LE(received->received, after + kConversionError);
  const BusCounters counters = reader->counters();
  EXPECT_EQ(counters.software_stamped + counters.hardware_stamped, 1u);
}

constexpr const char* kAddInterface = "ip link add bevloc0 type vcan && ip link set bevloc0 up";

TEST(SocketCanInterface, AListenerNoticesThatItIsUpAgain) {
  if (std::system((kAddInterface + std::string(" 2> /dev/null")).c_str()) != 0) {
    GTEST_SKIP() << "SocketCan: needs ip, vcan and CAP_NET_ADMIN";
  }
  const auto listener = SocketCanBus::open("bevloc0");
  ASSERT_TRUE(listener);
  ASSERT_EQ(std::system("ip link set bevloc0 down"), 0);
  (*listener)->wait(milliseconds(0));
  (*listener)->receive();
  EXPECT_EQ((*listener)->condition().state, BusState::kDown);
  ASSERT_EQ(std::system("ip link set bevloc0 up"), 0);
  (*listener)->wait(milliseconds(0));
  EXPECT_EQ((*listener)->condition().state, BusState::kActive);
  EXPECT_EQ(std::system("ip link del bevloc0"), 0);
}

TEST(SocketCanInterface, StartsAnewAlsoIfItWasDownBetweenTwoFrames) {
  if (std::system((kAddInterface + std::string(" 2> /dev/null")).c_str()) != 0) {
    GTEST_SKIP() << "SocketCan: needs ip, vcan and CAP_NET_ADMIN";
  }
  const auto sender = SocketCanBus::open("bevloc0", {.confirmed_ids = {0x510}});
  const auto listener = SocketCanBus::open("bevloc0");
  ASSERT_TRUE(sender && listener);
  report_error(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, "bevloc0");
  for (const auto& bus : {sender->get(), listener->get()}) {
    ASSERT_TRUE(bus->wait(seconds(10)));
    EXPECT_FALSE(bus->receive());
    EXPECT_EQ(bus->condition().state, BusState::kPassive);
  }
  ASSERT_EQ((*sender)->send({.id = 0x510}, Time{}), SendResult::kSent);
  ASSERT_EQ(std::system("ip link set bevloc0 down && ip link set bevloc0 up"), 0);
  for (const auto& bus : {sender->get(), listener->get()}) {
    EXPECT_FALSE(bus->receive()) << "the kernel reports the failure before it delivers frames";
    bus->wait(milliseconds(0));
    EXPECT_EQ(bus->condition(), BusCondition{});
  }
  EXPECT_EQ((*sender)->send({.id = 0x510}, Time{}), SendResult::kSent) << "without an echo";
  EXPECT_EQ(std::system("ip link del bevloc0"), 0);
}

/// One end of a vxcan pair has no carrier while the other end is down, like an interface whose
/// controller is bus-off.
TEST(SocketCanInterface, ThatIsBusOffAtTheStartIsNamed) {
  const std::string add =
      "(ip link add bevloc0 type vxcan peer name bevloc1 && ip link set bevloc0 up) 2> /dev/null";
  if (std::system(add.c_str()) != 0) {
    GTEST_SKIP() << "SocketCan: needs ip, vxcan and CAP_NET_ADMIN";
  }
  const auto bus = SocketCanBus::open("bevloc0");
  ASSERT_TRUE(bus);
  EXPECT_EQ((*bus)->condition().state, BusState::kOff);
  ASSERT_EQ(std::system("ip link set bevloc1 up"), 0);
  const auto other = SocketCanBus::open("bevloc1");
  ASSERT_TRUE(other);
  EXPECT_EQ((*other)->condition(), BusCondition{});
  ASSERT_EQ((*other)->send({.id = 0x510}, Time{}), SendResult::kSent);
  ASSERT_TRUE((*bus)->wait(seconds(10)));
  EXPECT_TRUE((*bus)->receive());
  EXPECT_EQ((*bus)->condition(), BusCondition{});
  EXPECT_EQ(std::system("ip link del bevloc0"), 0);
}

TEST(SocketCanInterface, ThatComesBackAsAClassicOneIsNamed) {
  if (std::system((kAddInterface + std::string(" 2> /dev/null")).c_str()) != 0) {
    GTEST_SKIP() << "SocketCan: needs ip, vcan and CAP_NET_ADMIN";
  }
  const std::string down = "ip link set bevloc0 down && ip link set bevloc0 mtu ";
  const std::string up = " && ip link set bevloc0 up";
  ASSERT_EQ(std::system((down + std::to_string(CANFD_MTU) + up).c_str()), 0);
  const auto sender = SocketCanBus::open("bevloc0", {.fd = true});
  const auto listener = SocketCanBus::open("bevloc0", {.fd = true});
  const auto classic = SocketCanBus::open("bevloc0");
  ASSERT_TRUE(sender && listener && classic);
  const Frame frame{.id = 0x510, .length = 64, .format = FrameFormat::kFd};
  ASSERT_EQ((*sender)->send(frame, Time{}), SendResult::kSent);
  const auto change = [&](int mtu) {
    ASSERT_EQ(std::system((down + std::to_string(mtu) + up).c_str()), 0);
    for (SocketCanBus* bus : {sender->get(), listener->get(), classic->get()}) {
      while (bus->receive()) continue;
      bus->wait(milliseconds(0));
    }
  };
  change(CAN_MTU);
  EXPECT_EQ((*sender)->send(frame, Time{}), SendResult::kBusDown);
  EXPECT_EQ(to_string((*sender)->condition()), "down (interface without CAN FD)");
  EXPECT_EQ(to_string((*listener)->condition()), "ok (interface without CAN FD)");
  EXPECT_EQ(to_string((*classic)->condition()), "ok");
  change(CANFD_MTU);
  EXPECT_EQ((*sender)->send(frame, Time{}), SendResult::kSent);
  EXPECT_EQ((*sender)->condition(), BusCondition{});
  EXPECT_EQ((*listener)->condition(), BusCondition{});
  EXPECT_EQ(std::system("ip link del bevloc0"), 0);
}

TEST(SocketCanInterface, IsFoundAgainByItsNameAfterALoss) {
  const std::string add = kAddInterface;
  if (std::system((add + " 2> /dev/null").c_str()) != 0) {
    GTEST_SKIP() << "SocketCan: needs ip, vcan and CAP_NET_ADMIN";
  }
  const auto sender = SocketCanBus::open("bevloc0", {.confirmed_ids = {0x510}});
  const auto reader = SocketCanBus::open("bevloc0");
  ASSERT_TRUE(sender && reader);
  ASSERT_EQ((*sender)->send({.id = 0x510}, Time{}), SendResult::kSent);
  ASSERT_EQ(std::system("ip link del bevloc0"), 0);
  // The appliance's receiving thread does the same: it waits, and then reads all frames.
  while ((*sender)->wait(milliseconds(0))) (*sender)->receive();
  while ((*reader)->wait(milliseconds(0))) (*reader)->receive();
  EXPECT_EQ((*sender)->send({.id = 0x510}, Time{}), SendResult::kBusDown);
  EXPECT_EQ((*sender)->send({.id = 0x510}, Time{}), SendResult::kBusDown);
  EXPECT_EQ((*sender)->condition().state, BusState::kDown);

  ASSERT_EQ(std::system(add.c_str()), 0);
  bool heard = false;
  for (int attempt = 0; attempt < 100 && !heard; ++attempt) {
    (*sender)->send({.id = 0x510}, Time{});
    heard = (*reader)->wait(milliseconds(10)) && (*reader)->receive();
    (*sender)->receive();
  }
  EXPECT_TRUE(heard);
  EXPECT_EQ((*sender)->condition().state, BusState::kActive);
  EXPECT_GE((*sender)->counters().reopened, 1u);
  EXPECT_EQ(std::system("ip link del bevloc0"), 0);
}

TEST_F(SocketCanKernel, ReceivesErrorReports) {
  report_error(CAN_ERR_CRTL | CAN_ERR_ACK, CAN_ERR_CRTL_TX_PASSIVE);
  ASSERT_TRUE(other_->wait(seconds(10)));
  EXPECT_FALSE(other_->receive());
  EXPECT_EQ(to_string(other_->condition()), "error-passive (no acknowledgement)");
  report_error(CAN_ERR_RESTARTED, 0);
  ASSERT_TRUE(other_->wait(seconds(10)));
  EXPECT_FALSE(other_->receive());
  EXPECT_EQ(other_->condition(), BusCondition{});
  EXPECT_EQ(other_->counters().error_frames, 2u);
}

}  // namespace
}  // namespace bevloc::can
