// Tests the option --live, with which every bevlocd serves its live page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/daemon/program.h"
#include "tests/support/command_line.h"

namespace bevloc::firmware {
namespace {

/// The configuration after a command line, starting without the section `live`.
std::optional<LiveConfig> live_after(std::vector<std::string> words) {
  CLI::App app;
  ProgramOptions options;
  declare_options(app, options);
  words.insert(words.begin(), {"--config", "demo.yaml"});
  test::parse(app, std::move(words));
  Config config;
  EXPECT_TRUE(override_config(options, config));
  return config.live;
}

TEST(LiveOption, IsOffByDefault) {
  EXPECT_FALSE(live_after({}));
}

TEST(LiveOption, TakesAPortOrTheDefault) {
  EXPECT_EQ(authority_of(live_after({"--live"}).value()), "127.0.0.1:8080");
  EXPECT_EQ(authority_of(live_after({"--live", "9000"}).value()), "127.0.0.1:9000");
  EXPECT_EQ(authority_of(live_after({"--live", "--check-config"}).value()), "127.0.0.1:8080");
}

TEST(LiveOption, RefusesWhatIsNoPort) {
  for (const char* port : {"0", "65536", "80x", "-1"}) {
    EXPECT_THROW(live_after({"--live", port}), CLI::ParseError) << port;
  }
}

}  // namespace
}  // namespace bevloc::firmware
