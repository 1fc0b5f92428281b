// Tests the section `live` of the configuration.
#include "firmware/config/live_config.h"

#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bevloc::firmware {
namespace {

using testing::HasSubstr;

/// Returns the section and the error message, which is empty without an error.
std::pair<LiveConfig, std::string> read_live_section(const std::string& section) {
  auto yaml = YamlMap::parse(section, "test");
  EXPECT_TRUE(yaml) << yaml.error().message;
  const auto config = read_live(*yaml);
  const Status finished = yaml->finish();
  return {*config, finished ? "" : finished.error().message};
}

TEST(LiveConfig, IsOffWithoutTheSection) {
  EXPECT_FALSE(read_live(std::nullopt));
}

TEST(LiveConfig, ServesThisMachineAloneByDefault) {
  const auto [config, error] = read_live_section("{}");
  EXPECT_EQ(error, "");
  EXPECT_EQ(authority_of(config), "127.0.0.1:8080");
  EXPECT_FALSE(config.open_to_network);
}

TEST(LiveConfig, RefusesOtherAddressesUnlessAKeySaysSo) {
  for (const char* address : {"0.0.0.0", "192.168.1.2", "::", "fe80::1"}) {
    const std::string keys = std::string("address: '") + address + "'";
    EXPECT_THAT(read_live_section("{" + keys + "}").second,
                HasSubstr("wanted a loopback address, or open_to_network: true"));
    EXPECT_EQ(read_live_section("{" + keys + ", open_to_network: true}").second, "");
  }
}

TEST(LiveConfig, TakesEveryLoopbackAddress) {
  for (const char* address : {"127.0.0.1", "127.8.9.10", "::1", "0:0:0:0:0:0:0:1"}) {
    EXPECT_EQ(read_live_section(std::string("{address: '") + address + "'}").second, "");
  }
}

TEST(LiveConfig, RefusesNamesAndPortsOutOfRange) {
  for (const char* keys : {"address: localhost", "address: 127.0.0.1.evil.example", "address: ''",
                           "port: 0", "port: 65536", "open: true"}) {
    EXPECT_NE(read_live_section(std::string("{") + keys + "}").second, "") << keys;
  }
}

}  // namespace
}  // namespace bevloc::firmware
