// Takes the capabilities of root away, so that permissions and limits count for root, too.
#pragma once

#include <thread>

#include <gtest/gtest.h>
#include <linux/capability.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace bevloc::test {

/// Removes the calling thread's capabilities for good.
inline void drop_capabilities() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct none[_LINUX_CAPABILITY_U32S_3] = {};
  ASSERT_EQ(syscall(SYS_capset, &header, none), 0);
}

/// Runs `work` in a thread of its own, which has no capabilities.
template <typename Work>
void without_capabilities(Work work) {
  std::jthread([&work] {
    drop_capabilities();
    work();
  }).join();
}

}  // namespace bevloc::test
