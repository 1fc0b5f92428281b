#include "evaluation/choice_option.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/command_line.h"

namespace bevloc::evaluation {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

enum class Rows { kSolvers, kAll };

class ChoiceOption : public testing::Test {
 protected:
  ChoiceOption() {
    add_choice(app_, "--rows", rows_, {{"solvers", Rows::kSolvers}, {"all", Rows::kAll}}, "Rows");
  }

  void parse(std::vector<std::string> arguments) { test::parse(app_, std::move(arguments)); }

  CLI::App app_;
  Rows rows_ = Rows::kAll;
};

TEST_F(ChoiceOption, SetsTheValueOfTheName) {
  parse({});
  EXPECT_EQ(rows_, Rows::kAll);
  parse({"--rows", "solvers"});
  EXPECT_EQ(rows_, Rows::kSolvers);
}

TEST_F(ChoiceOption, HelpListsTheNamesAndTheDefault) {
  EXPECT_THAT(app_.help(), HasSubstr("{solvers,all}"));
  // CLI11 2.1 writes `=all`, 2.4 writes `[all]`.
  EXPECT_THAT(app_.help(), AnyOf(HasSubstr("=all"), HasSubstr("[all]")));
}

TEST_F(ChoiceOption, ErrorListsTheNames) {
  try {
    parse({"--rows", "some"});
    FAIL() << "no error";
  } catch (const CLI::ValidationError& error) {
    EXPECT_STREQ(error.what(), "--rows: some not in {solvers,all}");
  }
}

}  // namespace
}  // namespace bevloc::evaluation
