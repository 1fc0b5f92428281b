#include "command/command_list.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace bevloc::command {
namespace {

/// Writes its name to a list when it runs.
class NamedCommand {
 public:
  NamedCommand(std::vector<std::string>& ran, std::string name)
      : ran_(ran), name_(std::move(name)) {}

  void declare(CLI::App& app) { app.add_subcommand(name_, "A command"); }
  Status run() {
    ran_.push_back(name_);
    return {};
  }

 private:
  std::vector<std::string>& ran_;
  std::string name_;
};

/// A command with a subcommand under each of two groups.
struct JudgingCommand {
  void declare(CLI::App& eval, CLI::App& tune) {
    eval.add_subcommand("match", "Evaluate");
    tune.add_subcommand("match", "Tune");
  }
  Result<Verdict> run() { return Verdict::kBad; }
};

struct FailingCommand {
  void declare(CLI::App& app) { app.add_subcommand("fails", "Fail"); }
  Status run() { return fail("found nothing"); }
};

struct First : NamedCommand {
  explicit First(std::vector<std::string>& ran) : NamedCommand(ran, "first") {}
};
struct Second : NamedCommand {
  explicit Second(std::vector<std::string>& ran) : NamedCommand(ran, "second") {}
};

class CommandListTest : public testing::Test {
 protected:
  CommandListTest() {
    CLI::App* eval = app_.add_subcommand("eval", "Evaluate")->require_subcommand(1);
    CLI::App* tune = app_.add_subcommand("tune", "Tune")->require_subcommand(1);
    commands_.add_with<First>(ran_, app_);
    commands_.add<JudgingCommand>(*eval, *tune);
    commands_.add_with<Second>(ran_, app_);
    commands_.add<FailingCommand>(app_);
  }

  int run(std::vector<std::string> words) {
    words.insert(words.begin(), "bevloc");
    std::vector<char*> argv;
    std::ranges::transform(words, std::back_inserter(argv),
                           [](std::string& w) { return w.data(); });
    return commands_.run(app_, static_cast<int>(argv.size()), argv.data());
  }

  std::vector<std::string> ran_;
  CLI::App app_;
  CommandList commands_;
};

TEST_F(CommandListTest, RunsOnlyTheCommandThatTheCommandLineNames) {
  EXPECT_EQ(run({"second"}), 0);
  EXPECT_EQ(ran_, std::vector<std::string>{"second"});
  EXPECT_EQ(run({"first"}), 0);
  EXPECT_EQ(ran_, (std::vector<std::string>{"second", "first"}));
}

TEST_F(CommandListTest, RunsACommandWithSubcommandsInTwoGroups) {
  EXPECT_EQ(run({"eval", "match"}), 1);
  EXPECT_EQ(run({"tune", "match"}), 1);
  EXPECT_TRUE(ran_.empty());
}

TEST_F(CommandListTest, ReturnsTwoForWrongUseAndForFailures) {
  EXPECT_EQ(run({"third"}), 2);
  EXPECT_EQ(run({"eval"}), 2);
  EXPECT_EQ(run({"fails"}), 2);
  EXPECT_TRUE(ran_.empty());
}

}  // namespace
}  // namespace bevloc::command
