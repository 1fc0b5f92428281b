// Drives the fault line.
#pragma once

#include <memory>
#include <optional>

#include "drivers/gpio/gpio.h"
#include "firmware/devices/line_error_log.h"

namespace bevloc::firmware {

/// Tells the vehicle that the localizer must not be relied on. The line is active from open() until
/// set(false), and again from the destructor on. It depends on no other line. If the process is
/// killed, most chips keep the last level (docs/drivers.md). One thread.
class FaultLine {
 public:
  /// Opens the line. If there is no address, nothing is driven. Fails if the line cannot be opened.
  /// `gpio` must outlive the result.
  static Result<std::unique_ptr<FaultLine>> open(const std::optional<drivers::LineAddress>& address,
                                                 drivers::Gpio& gpio);
  ~FaultLine();
  FaultLine(const FaultLine&) = delete;
  FaultLine& operator=(const FaultLine&) = delete;

  /// Sets the line. A failure is logged once per cause, and the line is tried again at each call.
  void set(bool fault, Time now);

 private:
  explicit FaultLine(std::unique_ptr<drivers::OutputLine> line) : line_(std::move(line)) {}

  std::unique_ptr<drivers::OutputLine> line_;  ///< null without an address
  LineErrorLog errors_{"fault line", spdlog::level::err};
};

}  // namespace bevloc::firmware
