#include "common/output.h"

#include <string>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

TEST(Printable, ShowsControlCharactersAsNumbers) {
  const std::string text("a\0b\x1B[2J\x7F\t\xC3\xA9\n", 12);
  EXPECT_EQ(printable(text), "a\\x00b\\x1B[2J\\x7F\\x09\xC3\xA9\n");
}

}  // namespace
}  // namespace bevloc
