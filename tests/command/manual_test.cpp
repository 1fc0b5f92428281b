// Tests option tables, manual pages and completion with a small program of their own.
#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command/manual/completion.h"
#include "command/manual/installed_table.h"
#include "command/manual/man_page.h"
#include "command/manual/option_table.h"
#include "command/vehicle_commands.h"
#include "evaluation/drive/drive_config.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::command {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class ManualTest : public testing::Test {
 protected:
  ManualTest() {
    auto* paint = app_.add_subcommand("paint", "Paint a wall");
    paint->add_option("--colour", colour_, "Its colour")
        ->check(CLI::IsMember({"red", "royal", "blue"}))
        ->capture_default_str();
    paint->add_option("--file", file_, "A picture")->check(CLI::ExistingFile)->required();
    paint->add_flag("--wet", wet_, "Don't wait");
    paint->footer("Examples:\n  tool paint --colour red");
    auto* wall = app_.add_subcommand("wall", "Walls");
    wall->add_subcommand("build", "Build one");
    wall->add_subcommand("break", "Break one");
  }

  /// What the shell offers for a command line that ends at its last word.
  std::vector<std::string> offered(const std::vector<std::string>& words) {
    std::ofstream(folder_ / "script") << bash_completion("tool", table_of(app_));
    std::string line = "source " + (folder_ / "script").string() + "; COMP_WORDS=(tool";
    for (const std::string& word : words) line += " '" + word + "'";
    line += "); COMP_CWORD=" + std::to_string(words.size()) +
            "; _tool_complete; for word in \"${COMPREPLY[@]}\"; do echo \"$word\"; done";
    std::ofstream(folder_ / "line") << line;
    const std::string command =
        "cd " + folder_.path().string() + " && bash --norc -u " + (folder_ / "line").string();
    FILE* pipe = popen(command.c_str(), "r");
    std::string text;
    std::array<char, 256> buffer{};
    while (fgets(buffer.data(), buffer.size(), pipe) != nullptr) text += buffer.data();
    EXPECT_EQ(pclose(pipe), 0) << text;
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string word; std::getline(stream, word);) lines.push_back(word);
    return lines;
  }

  test::TemporaryFolder folder_;
  CLI::App app_{"A tool", "tool"};
  std::string colour_ = "red";
  std::string file_;
  bool wet_ = false;
};

TEST_F(ManualTest, TheTableHasEveryCommandAndOption) {
  const CommandEntry table = table_of(app_);
  ASSERT_EQ(table.commands.size(), 2U);
  EXPECT_EQ(all_commands(table).size(), 5U);
  const CommandEntry& paint = table.commands[0];
  ASSERT_EQ(paint.options.size(), 4U);  // --help too
  EXPECT_THAT(paint.options[1].choices, ElementsAre("red", "royal", "blue"));
  EXPECT_EQ(paint.options[1].default_value, "red");
  EXPECT_EQ(paint.options[2].value, "FILE");
  EXPECT_TRUE(paint.options[2].required);
  EXPECT_EQ(paint.options[3].value, "");
  EXPECT_EQ(table.commands[1].commands[0].path, "wall build");
}

TEST_F(ManualTest, BashCompletesCommandsOptionsWordsAndFiles) {
  EXPECT_THAT(offered({"pa"}), ElementsAre("paint"));
  EXPECT_THAT(offered({"wall", "b"}), ElementsAre("build", "break"));
  EXPECT_THAT(offered({"paint", "--co"}), ElementsAre("--colour"));
  EXPECT_THAT(offered({"paint", "--colour", "r"}), ElementsAre("red", "royal"));
  EXPECT_THAT(offered({"paint", "--wet", "--f"}), ElementsAre("--file"));
  std::ofstream(folder_ / "picture.png") << "x";
  EXPECT_THAT(offered({"paint", "--file", "pic"}), ElementsAre("picture.png"));
  EXPECT_THAT(offered({"wall", "nothing"}), ElementsAre());
}

TEST_F(ManualTest, ZshAcceptsItsScript) {
  if (std::system("command -v zsh >/dev/null") != 0) GTEST_SKIP() << "zsh is not installed";
  std::ofstream(folder_ / "_tool") << zsh_completion("tool", table_of(app_));
  EXPECT_EQ(std::system(("zsh -n " + (folder_ / "_tool").string()).c_str()), 0);
}

TEST_F(ManualTest, ThePageOfAProgramDescribesEveryOption) {
  const std::string page = man_page_of_program(
      {.name = "tool", .what = "does it", .see_also = {"other(1)"}}, table_of(app_));
  EXPECT_THAT(page, HasSubstr(".SS tool paint\n"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-\\-colour\\fR \\fIred|royal|blue\\fR"));
  EXPECT_THAT(page, HasSubstr("(required)"));
  EXPECT_THAT(page, HasSubstr("tool paint \\-\\-colour red"));
  EXPECT_THAT(page, HasSubstr("other(1)"));
}

TEST_F(ManualTest, AQuestionGetsNoFullStop) {
  app_.add_subcommand("ask", "Is the wall wet?");
  const std::string page = man_page_of_program({.name = "tool", .what = "x"}, table_of(app_));
  EXPECT_THAT(page, HasSubstr("Is the wall wet?\n"));
  EXPECT_THAT(page, HasSubstr("Paint a wall.\n"));
}

TEST_F(ManualTest, TextIsNeverARequestOfRoff) {
  const CommandEntry table{.name = "tool",
                           .path = "",
                           .description = ".dot first\n'quote and \\back",
                           .footer = "",
                           .options = {},
                           .commands = {}};
  const std::string page = man_page_of_program({.name = "tool", .what = "x"}, table);
  EXPECT_THAT(page, HasSubstr("\\&.dot first\n\\&'quote and \\eback"));
}

const OptionEntry& option_of(const CommandEntry& table, const std::string& command,
                             const std::string& option) {
  const auto entry = std::ranges::find(table.commands, command, &CommandEntry::name);
  const auto found = std::ranges::find_if(entry->options, [&](const OptionEntry& candidate) {
    return std::ranges::find(candidate.names, option) != candidate.names.end();
  });
  return *found;
}

TEST(VehicleCommands, NameNothingOfTheSimulator) {
  CLI::App app;
  CommandList commands;
  add_vehicle_commands(app, commands, nullptr);
  const CommandEntry table = table_of(app);
  for (const CommandEntry* command : all_commands(table)) {
    EXPECT_THAT(command->footer, Not(HasSubstr("config/demo.yaml"))) << command->name;
    for (const OptionEntry& option : command->options) {
      EXPECT_THAT(option.description, Not(HasSubstr("mock"))) << command->name;
    }
  }
  EXPECT_THAT(option_of(table, "init", "--cameras").choices, ElementsAre("v4l2", "libcamera"));
}

TEST(InstalledTable, HasTheCommandsOfTheVehicleAndThoseThatTheSimulatorAdds) {
  std::optional<evaluation::SimulationConfig> simulation;
  const firmware::SimulationReader reader = evaluation::simulation_reader(simulation);
  CLI::App app;
  CommandList commands;
  add_vehicle_commands(app, commands, &reader);
  app.add_subcommand("demo", "Drive");
  const test::TemporaryFolder folder;
  const std::filesystem::path here = folder / "libexec/bevloc-sim";
  // In a folder of a build there is no program for vehicles beside it.
  const CommandEntry alone = installed_table(app, here);
  EXPECT_THAT(option_of(alone, "init", "--cameras").choices,
              ElementsAre("mock", "v4l2", "libcamera"));
  std::filesystem::create_directories(here);
  std::filesystem::create_directories(folder / "bin");
  std::ofstream(folder / "bin/bevloc") << "the program for vehicles";
  const CommandEntry installed = installed_table(app, here);
  EXPECT_EQ(installed.commands.size(), alone.commands.size());
  EXPECT_EQ(installed.commands.back().name, "demo");
  EXPECT_THAT(option_of(installed, "init", "--cameras").choices, ElementsAre("v4l2", "libcamera"));
}

TEST(ManPageOfSchema, SaysWhatIsRequired) {
  const auto schema = nlohmann::ordered_json::parse(R"({"type": "object", "properties": {
    "wall": {"type": "object", "required": ["by"], "properties": {
      "by": {"enum": ["hand", "robot"]}, "name": {"type": "string"}, "tool": {"type": "string"}},
      "allOf": [{"if": {"required": ["by"], "properties": {"by": {"const": "robot"}}},
                 "then": {"required": ["name"]}}]}}})");
  const std::string page =
      man_page_of_schema({.name = "wall.yaml", .section = 5, .what = "a wall"}, schema);
  EXPECT_THAT(page, HasSubstr("hand, robot. Required.\n"));
  EXPECT_THAT(page, HasSubstr("\\fBwall.name\\fR\nstring. Required with by: robot.\n"));
  EXPECT_THAT(page, HasSubstr("\\fBwall.tool\\fR\nstring.\n"));
}

TEST(ManPageOfSchema, ShowsValuesDefaultsAndMeaning) {
  const auto schema = nlohmann::ordered_json::parse(R"({"type": "object", "properties": {
    "wall": {"type": "object", "description": "A wall.", "properties": {
      "height_m": {"type": "number", "minimum": 1, "maximum": 3, "default": 2, "description": "Its height."},
      "paint": {"enum": ["red", "blue"]}}}}})");
  const std::string page =
      man_page_of_schema({.name = "wall.yaml", .section = 5, .what = "a wall"}, schema);
  EXPECT_THAT(page, HasSubstr("\\fBwall.height_m\\fR\nnumber, 1 to 3. Default: 2.\nIts height.\n"));
  EXPECT_THAT(page, HasSubstr("red, blue."));
  EXPECT_THAT(page, Not(HasSubstr("depends on")));
}

}  // namespace
}  // namespace bevloc::command
