// A machine for the tests of the doctor and of init.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "command/doctor/machine.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::test {

/// A machine whose files lie in a folder of the test.
class FakeMachine final : public command::Machine {
 public:
  std::filesystem::path root() const override { return folder_.path(); }
  command::ProcessLimits limits() const override { return process_limits; }
  bool clock_is_synchronous() const override { return synchronous; }
  Result<int64_t> free_bytes(const std::filesystem::path&) const override { return free; }
  bool may_use(const std::filesystem::path&) const override { return permitted; }
  Result<std::string> run(const std::vector<std::string>& words) const override {
    const auto answer = programs.find(words.front());
    if (answer == programs.end()) return fail("{}: missing", words.front());
    return answer->second;
  }

  std::vector<drivers::GpioChipInfo> gpio_chips() const override { return chips; }
  Result<std::vector<std::string>> libcamera_ids() const override { return camera_ids; }

  void put(const std::string& file, const std::string& text) {
    std::filesystem::create_directories(real(file).parent_path());
    std::ofstream(real(file)) << text;
  }

  command::ProcessLimits process_limits;
  bool synchronous = true;
  bool permitted = true;
  int64_t free = int64_t{10} << 30;
  std::map<std::string, std::string> programs;  ///< what they print
  std::vector<drivers::GpioChipInfo> chips;
  std::vector<std::string> camera_ids;

 private:
  TemporaryFolder folder_;
};

}  // namespace bevloc::test
