#include "command/shell_word.h"

#include <gtest/gtest.h>

namespace bevloc::command {
namespace {

TEST(ShellWord, LeavesPlainWordsAsTheyAre) {
  EXPECT_EQ(shell_word("/etc/bevloc/bevlocd-2.yaml"), "/etc/bevloc/bevlocd-2.yaml");
}

TEST(ShellWord, QuotesWhatTheShellWouldChange) {
  EXPECT_EQ(shell_word("my config.yaml"), "'my config.yaml'");
  EXPECT_EQ(shell_word("$HOME/*.yaml"), "'$HOME/*.yaml'");
  EXPECT_EQ(shell_word("it's"), R"('it'\''s')");
  EXPECT_EQ(shell_word(""), "''");
}

}  // namespace
}  // namespace bevloc::command
