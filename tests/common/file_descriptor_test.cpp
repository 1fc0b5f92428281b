// A file descriptor has one owner, which closes it.
#include "common/file_descriptor.h"

#include <array>
#include <type_traits>

#include <fcntl.h>
#include <gtest/gtest.h>

namespace bevloc {
namespace {

static_assert(!std::is_copy_constructible_v<FileDescriptor>);
static_assert(!std::is_copy_assignable_v<FileDescriptor>);

bool is_open(int number) {
  return fcntl(number, F_GETFD) >= 0;
}

class FileDescriptorTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(pipe(ends_.data()), 0); }
  void TearDown() override {
    for (const int end : ends_) {
      if (is_open(end)) close(end);
    }
  }

  std::array<int, 2> ends_{-1, -1};
};

TEST_F(FileDescriptorTest, IsClosedAtTheEndOfItsOwner) {
  {
    const FileDescriptor owner(ends_[0]);
    EXPECT_EQ(owner.get(), ends_[0]);
    EXPECT_TRUE(is_open(ends_[0]));
  }
  EXPECT_FALSE(is_open(ends_[0]));
  EXPECT_TRUE(is_open(ends_[1]));
}

TEST_F(FileDescriptorTest, AMoveMakesAnotherOwner) {
  FileDescriptor first(ends_[0]);
  {
    const FileDescriptor second(std::move(first));
    EXPECT_EQ(first.get(), -1);
    EXPECT_EQ(second.get(), ends_[0]);
  }
  EXPECT_FALSE(is_open(ends_[0]));
}

TEST_F(FileDescriptorTest, AnAssignmentClosesTheFormerDescriptor) {
  FileDescriptor owner(ends_[0]);
  owner = FileDescriptor(ends_[1]);
  EXPECT_FALSE(is_open(ends_[0]));
  EXPECT_EQ(owner.get(), ends_[1]);
  EXPECT_TRUE(is_open(ends_[1]));
}

TEST_F(FileDescriptorTest, ResetClosesAndTakesAnother) {
  FileDescriptor owner(ends_[0]);
  owner.reset(ends_[1]);
  EXPECT_FALSE(is_open(ends_[0]));
  EXPECT_EQ(owner.get(), ends_[1]);
  owner.reset();
  EXPECT_FALSE(is_open(ends_[1]));
  EXPECT_EQ(owner.get(), -1);
  owner.reset();
}

}  // namespace
}  // namespace bevloc
