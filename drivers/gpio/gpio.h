// Single GPIO lines, whatever drives them.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/result.h"
#include "common/time.h"

namespace bevloc::drivers {

/// Which wire, and what its voltage means.
struct LineAddress {
  std::string chip;         ///< the chip's label ("pinctrl-bcm2711") or its name ("gpiochip0")
  std::string line;         ///< the line's name ("TRIGGER") or its number on the chip ("17")
  bool active_low = false;  ///< whether the line is active at low voltage
};

/// "gpiochip0 TRIGGER", for messages.
std::string to_string(const LineAddress& address);

/// A line that we drive. When it is given up, by its destructor or because the process dies, the
/// kernel takes it back: most chips keep the last level, some let the line float.
/// One thread at a time.
class OutputLine {
 public:
  virtual ~OutputLine() = default;

  /// Does not block and does not allocate. Fails when the chip is gone.
  virtual Status set(bool active) = 0;
};

struct LineEdge {
  Time time;            ///< when the chip's interrupt came, on the steady clock
  bool active = false;  ///< what the line became
};

/// A line that others drive. One thread at a time.
class InputLine {
 public:
  virtual ~InputLine() = default;

  /// What the line is now. Fails when the chip is gone.
  virtual Result<bool> active() = 0;

  /// The oldest edge that was not fetched yet; waits for one, `timeout` at most. Zero only looks.
  /// A user who fetches too seldom loses edges (the kernel keeps 16 at least), and edges that
  /// follow faster than the interrupt is served become one: active() is the truth.
  virtual Result<std::optional<LineEdge>> next_edge(Duration timeout) = 0;
};

/// Where lines come from. Every implementation passes tests/drivers/gpio_conformance_test.cpp.
/// Opening fails, with a sentence that says so, when there is no such chip (it lists those that
/// there are), when the chip has no such line, when two have it, and when somebody else uses the
/// line (it says who). It must outlive its lines. Threads: any, one at a time.
class Gpio {
 public:
  virtual ~Gpio() = default;

  /// The line is `active` from the moment on that it is ours, without a glitch.
  virtual Result<std::unique_ptr<OutputLine>> open_output(const LineAddress& address,
                                                          bool active) = 0;
  virtual Result<std::unique_ptr<InputLine>> open_input(const LineAddress& address) = 0;
};

}  // namespace bevloc::drivers
