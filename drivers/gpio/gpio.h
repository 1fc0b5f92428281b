// The interfaces of GPIO lines, mock or real.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/result.h"
#include "common/time.h"

namespace bevloc::drivers {

/// A line of a chip, and its polarity.
struct LineAddress {
  std::string chip;         ///< label ("pinctrl-bcm2711") or name ("gpiochip0") of the chip
  std::string line;         ///< name ("TRIGGER") of the line, or its number on the chip ("17")
  bool active_low = false;  ///< whether the line is active at low voltage
};

/// The name that other programs see as the user of our lines (gpioinfo shows it).
inline constexpr const char* kGpioConsumer = "bevloc";

/// Returns "gpiochip0 TRIGGER", for messages.
std::string to_string(const LineAddress& address);

/// A line that bevloc drives. When the object is destroyed or the process ends, the kernel releases
/// the line. Then most chips keep the last level, and some let the line float. One thread.
class OutputLine {
 public:
  virtual ~OutputLine() = default;

  /// Does not block and does not allocate. Fails when the chip was removed.
  virtual Status set(bool active) = 0;
};

struct LineEdge {
  Time time;            ///< time of the chip's interrupt on the steady clock
  bool active = false;  ///< the level after the edge
};

/// A line that another device drives. One thread.
class InputLine {
 public:
  virtual ~InputLine() = default;

  /// Returns the present level. Fails when the chip was removed.
  virtual Result<bool> active() = 0;

  /// Returns the oldest edge that was not fetched yet and waits up to `timeout` for one. A timeout
  /// of zero does not wait. Edges are lost when they are not fetched in time (the kernel keeps at
  /// least 16), and edges that follow faster than the interrupt is served are merged. active()
  /// always returns the true level.
  virtual Result<std::optional<LineEdge>> next_edge(Duration timeout) = 0;
};

/// Opens lines. Every implementation passes tests/drivers/gpio_conformance_test.cpp. Opening fails
/// when there is no such chip (the message lists the chips), when the chip has no such line or
/// several of this name, and when the line is in use (the message names its user). The object must
/// outlive its lines. One thread.
class Gpio {
 public:
  virtual ~Gpio() = default;

  /// Opens an output, which has the level `active` from the beginning, without a glitch.
  virtual Result<std::unique_ptr<OutputLine>> open_output(const LineAddress& address,
                                                          bool active) = 0;
  virtual Result<std::unique_ptr<InputLine>> open_input(const LineAddress& address) = 0;
};

}  // namespace bevloc::drivers
