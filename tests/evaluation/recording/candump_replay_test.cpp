// Which candump logs are refused for their times, and which configurations.
#include <gtest/gtest.h>

#include "common/files.h"
#include "evaluation/recording/candump_inputs.h"
#include "evaluation/recording/replay_setup.h"
#include "tests/evaluation/recording/replay_config.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

/// What inputs_of_candump() says about lines with these times, and without the file's path. There
/// are no pictures, so that it always fails.
std::string message_for(const std::vector<std::string>& times) {
  const test::TemporaryFolder folder;
  const std::string log = (folder.path() / "can.log").string();
  std::string text = "\n";
  for (const std::string& time : times) text += fmt::format("({}) can0 7F0#00\n", time);
  EXPECT_TRUE(write_file(log, text));
  const auto inputs = inputs_of_candump(log, folder.path(), ReplaySetup{});
  EXPECT_FALSE(inputs);
  return inputs ? "" : inputs.error().message.substr(log.size());
}

TEST(CandumpReplay, RefusesAClockThatSteps) {
  EXPECT_EQ(message_for({"1.000000", "2.000000", "31536002.500000"}),
            ":4: found a time 31536000.5 s after the line before, wanted at most 60 s; the clock "
            "was set or the log was paused, so cut the log there and replay one part");
  EXPECT_EQ(message_for({"9.000000", "10.500000", "9.600000", "9.400000"}),
            ":5: found a time 1.1 s before that of an earlier line, wanted at most 1 s; the clock "
            "was set back or logs were joined, so cut the log there and replay one part");
}

TEST(CandumpReplay, AcceptsPausesAndFineDisorder) {
  EXPECT_EQ(message_for({"1.000000", "61.000000", "60.000000", "61.100000"})
                .find(": found none of the vehicle's messages"),
            0U);
}

/// A candump log has no positions of gpsd. Without positions it would find no pose.
TEST(CandumpReplay, RefusesAConfigurationWithGpsd) {
  const std::string text = test::replay_config_text();
  const test::TemporaryFolder folder;
  ReplayOverrides overrides;
  overrides.config = folder / "config.yaml";
  ASSERT_TRUE(write_file(overrides.config, text));
  const auto without = setup_of(overrides);
  ASSERT_TRUE(without) << without.error().message;
  ASSERT_TRUE(write_file(overrides.config,
                         text + "gnss: {driver: gpsd, antenna_m: [0, 0], latency_ms: 90}\n"));
  const auto with = setup_of(overrides);
  ASSERT_FALSE(with);
  EXPECT_EQ(with.error().message.find("replay: found the section gnss, wanted GNSS on the bus"), 0U)
      << with.error().message;
}

}  // namespace
}  // namespace bevloc::evaluation
