#include "command/doctor/machine.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include <sys/resource.h>
#include <sys/timex.h>
#include <sys/wait.h>
#include <unistd.h>

#include "command/shell_word.h"
#include "common/files.h"
#include "drivers/gpio/libgpiod_gpio.h"
#ifdef BEVLOC_HAS_LIBCAMERA
#include "drivers/camera/libcamera/libcamera_camera.h"
#endif

namespace bevloc::command {

bool Machine::exists(const std::filesystem::path& path) const {
  std::error_code error;
  return std::filesystem::exists(real(path), error);
}

std::string Machine::text_of(const std::filesystem::path& path) const {
  return read_file(real(path)).value_or("");
}

std::string Machine::line_of(const std::filesystem::path& path) const {
  const std::string text = text_of(path);
  return text.substr(0, text.find('\n'));
}

std::vector<std::string> Machine::names_in(const std::filesystem::path& folder) const {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(real(folder), error)) {
    names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

bool Machine::is_can_interface(const std::string& name) const {
  // ARPHRD_CAN of linux/if_arp.h as text.
  constexpr const char* kCanDevice = "280";
  return line_of("/sys/class/net/" + name + "/type") == kCanDevice;
}

ProcessLimits LinuxMachine::limits() const {
  ProcessLimits limits;
  rlimit limit{};
  getrlimit(RLIMIT_RTPRIO, &limit);
  // 99 is the highest priority that there is.
  limits.realtime_priority = static_cast<int64_t>(std::min<rlim_t>(limit.rlim_max, 99));
  getrlimit(RLIMIT_MEMLOCK, &limit);
  if (limit.rlim_max != RLIM_INFINITY) {
    limits.locked_memory_bytes = static_cast<int64_t>(limit.rlim_max);
  }
  return limits;
}

bool LinuxMachine::clock_is_synchronous() const {
  timex state{};
  return adjtimex(&state) != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
}

Result<int64_t> LinuxMachine::free_bytes(const std::filesystem::path& path) const {
  std::error_code error;
  const auto space = std::filesystem::space(path, error);
  if (error) return fail("{}: found no file system ({})", path.string(), error.message());
  return static_cast<int64_t>(space.available);
}

bool LinuxMachine::may_use(const std::filesystem::path& path) const {
  return access(path.c_str(), R_OK | W_OK) == 0;
}

Result<std::string> LinuxMachine::run(const std::vector<std::string>& words) const {
  std::string command;
  for (const std::string& word : words) command += shell_word(word) + ' ';
  FILE* pipe = popen((command + "2>/dev/null").c_str(), "re");
  if (pipe == nullptr) return fail("{}: cannot be started", command);
  std::string text;
  std::array<char, 4096> buffer{};
  for (size_t count = 0; (count = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    text.append(buffer.data(), count);
  }
  const int status = pclose(pipe);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return text;
  return fail("{}: found exit code {}, wanted 0", command,
              WIFEXITED(status) ? WEXITSTATUS(status) : -1);
}

std::vector<drivers::GpioChipInfo> LinuxMachine::gpio_chips() const {
  return drivers::LibgpiodGpio::chips();
}

Result<std::vector<std::string>> LinuxMachine::libcamera_ids() const {
#ifdef BEVLOC_HAS_LIBCAMERA
  return drivers::libcamera_ids();
#else
  return fail("found a bevloc that was built without libcamera");
#endif
}

}  // namespace bevloc::command
