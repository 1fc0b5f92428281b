// What `bevloc doctor` and `bevloc init` ask the operating system.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/result.h"
#include "drivers/gpio/line_lookup.h"

namespace bevloc::command {

/// The hard limits of this process.
struct ProcessLimits {
  int64_t realtime_priority = 0;               ///< RLIMIT_RTPRIO
  std::optional<int64_t> locked_memory_bytes;  ///< RLIMIT_MEMLOCK; nothing if unlimited
};

/// This machine, or a folder that stands for one in a test. Paths are those of the machine, such as
/// "/proc/cpuinfo". One thread.
class Machine {
 public:
  virtual ~Machine() = default;

  /// Returns the folder that stands for "/".
  virtual std::filesystem::path root() const = 0;
  virtual ProcessLimits limits() const = 0;
  /// Whether the kernel's clock is kept synchronous by NTP, PTP or GNSS.
  virtual bool clock_is_synchronous() const = 0;
  /// The free space for this user of the file system that holds `path`.
  virtual Result<int64_t> free_bytes(const std::filesystem::path& path) const = 0;
  /// Whether this user may read and write the file.
  virtual bool may_use(const std::filesystem::path& path) const = 0;
  /// Returns what a program prints to stdout. Fails if it is missing or ends with another exit code
  /// than 0.
  virtual Result<std::string> run(const std::vector<std::string>& words) const = 0;
  /// The GPIO chips that this user may open.
  virtual std::vector<drivers::GpioChipInfo> gpio_chips() const = 0;
  /// The ids of the cameras that libcamera knows. Fails in a build without libcamera.
  virtual Result<std::vector<std::string>> libcamera_ids() const = 0;

  std::filesystem::path real(const std::filesystem::path& path) const {
    return root() / path.relative_path();
  }
  bool exists(const std::filesystem::path& path) const;
  /// Returns the first line of a file, or an empty text if it cannot be read.
  std::string line_of(const std::filesystem::path& path) const;
  /// Returns the whole file, or an empty text if it cannot be read.
  std::string text_of(const std::filesystem::path& path) const;
  /// Returns the names in a folder, sorted, or none if it cannot be read.
  std::vector<std::string> names_in(const std::filesystem::path& folder) const;
  /// Whether this is the name of a CAN interface, real or virtual.
  bool is_can_interface(const std::string& name) const;
};

/// The machine that this process runs on.
class LinuxMachine final : public Machine {
 public:
  std::filesystem::path root() const override { return "/"; }
  ProcessLimits limits() const override;
  bool clock_is_synchronous() const override;
  Result<int64_t> free_bytes(const std::filesystem::path& path) const override;
  bool may_use(const std::filesystem::path& path) const override;
  Result<std::string> run(const std::vector<std::string>& words) const override;
  std::vector<drivers::GpioChipInfo> gpio_chips() const override;
  Result<std::vector<std::string>> libcamera_ids() const override;
};

}  // namespace bevloc::command
