// Commands do not write over the files that they read.
#include "evaluation/check_outputs.h"

#include <cstdlib>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "evaluation/campaign/campaign_command.h"
#include "evaluation/campaign/integrity_command.h"
#include "evaluation/campaign/match_table.h"
#include "evaluation/campaign/tune_matches_command.h"
#include "evaluation/network/network_command.h"
#include "evaluation/network/rig_command.h"
#include "tests/evaluation/own_config.h"
#include "tests/evaluation/refusal.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;
using Words = std::vector<std::string>;

/// A folder with the inputs of the commands.
class CheckOutputs : public testing::Test {
 protected:
  CheckOutputs() {
    test::write_own_config(folder_.path());
    EXPECT_TRUE(write_file(file("model.onnx"), "a model"));
    EXPECT_TRUE(
        write_file(file("town.osm"),
                   test::read_text(BEVLOC_SOURCE_DIR "/tests/pipeline/map/fixtures/street.osm")));
    MatchTable table;
    table.places.resize(1);
    for (const SearchRange range : {SearchRange::kTracking, SearchRange::kAcquiring}) {
      MeasuredMatch& match = table.places[0].matches.emplace_back();
      match.range = range;
      match.sigma = {0.1, 0.1, 0.01};
    }
    EXPECT_TRUE(write_file(file("matches.csv"), to_csv(table)));
  }

  std::string file(const std::string& name) const { return folder_ / name; }

  /// Expects that a command refuses to write each of these inputs, and that these keep their bytes.
  template <typename Command>
  void expect_refusals(const Words& words, const std::string& option, const Words& inputs) const {
    for (const std::string& input : inputs) {
      const std::string before = test::read_text(file(input));
      Words all = words;
      all.insert(all.end(), {option, file(input)});
      EXPECT_THAT(test::refusal_of<Command>(all),
                  HasSubstr(input + ": found a file to write that is also read"));
      EXPECT_EQ(test::read_text(file(input)), before) << words[0];
    }
  }

  const test::TemporaryFolder folder_;
};

TEST_F(CheckOutputs, EachOutputIsComparedWithEachInput) {
  EXPECT_TRUE(check_outputs({file("new.json"), "", "/dev/null"}, {file("town.osm"), ""}));
  std::filesystem::create_hard_link(file("town.osm"), file("link"));
  const Status refused = check_outputs({"", file("link")}, {file("own.yaml"), file("town.osm")});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("link: found a file to write that is also read"));
}

TEST_F(CheckOutputs, AreComparedWithEachOther) {
  EXPECT_TRUE(check_outputs({file("a"), file("b"), "", ""}, {}));
  EXPECT_TRUE(check_outputs({"/dev/null", "/dev/null"}, {}));
  for (const std::string& second : {file("a"), file("./a"), folder_.path().string() + "/x/../a"}) {
    const Status refused = check_outputs({file("a"), "", second}, {});
    ASSERT_FALSE(refused) << second;
    EXPECT_EQ(refused.error().message,
              second + ": found one name for two files to write, wanted two names");
  }
}

TEST_F(CheckOutputs, OfTheCampaign) {
  const Words inputs{"own.yaml", "rig.yaml", "town.osm", "matches.csv"};
  const Words options{"--config",       file("own.yaml"), "--matches", file("matches.csv"), "--map",
                      file("town.osm"), "--modes",        "none",      "--duration",        "5"};
  Words campaign{"campaign"};
  campaign.insert(campaign.end(), options.begin(), options.end());
  expect_refusals<CampaignCommand>(campaign, "--json", inputs);
  Words integrity{"integrity", "--drives", "2"};
  integrity.insert(integrity.end(), options.begin(), options.end());
  expect_refusals<IntegrityCommand>(integrity, "--json", inputs);
}

TEST_F(CheckOutputs, OfMeasuredMatches) {
  expect_refusals<TuneMatchesCommand>({"matches", "--config", file("own.yaml"), "--drives", "2",
                                       "--duration", "1", "--map", file("town.osm")},
                                      "--csv", {"own.yaml", "rig.yaml", "town.osm"});
}

TEST_F(CheckOutputs, OfTheNetwork) {
  const Words words{"network", "--frames",      "1", "--model", file("model.onnx"),
                    "--map",   file("town.osm")};
  for (const char* option : {"--json", "--csv"}) {
    expect_refusals<NetworkCommand>(words, option, {"model.onnx", "town.osm"});
  }
}

TEST_F(CheckOutputs, OfARig) {
  const Words model{"--frames", "1", "--model", file("model.onnx")};
  Words given{"rig", file("rig.yaml")};
  given.insert(given.end(), model.begin(), model.end());
  expect_refusals<RigCommand>(given, "--json", {"rig.yaml", "model.onnx"});
  Words drawn{"rig", "--random", "7"};
  drawn.insert(drawn.end(), model.begin(), model.end());
  expect_refusals<RigCommand>(drawn, "--write", {"model.onnx"});
}

TEST_F(CheckOutputs, OfASimulatedDrive) {
  for (const std::string input : {"own.yaml", "rig.yaml"}) {
    const std::string before = test::read_text(file(input));
    const auto program = std::filesystem::path(BEVLOC_PROGRAM).parent_path() / "bevlocd";
    const std::string command = fmt::format(
        "{} --config {} --fast --duration 0.1 --out {} --json {} 2> {}", program.string(),
        file("own.yaml"), file("out"), file(input), file("error.txt"));
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 2);
    EXPECT_THAT(test::read_text(file("error.txt")), HasSubstr("file to write that is also read"));
    EXPECT_EQ(test::read_text(file(input)), before);
  }
}

}  // namespace
}  // namespace bevloc::evaluation
