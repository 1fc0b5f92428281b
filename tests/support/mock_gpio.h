// Mock GPIO lines: a test reads the driven levels and drives the read levels.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <vector>

#include "drivers/clock/clock.h"
#include "drivers/gpio/gpio.h"
#include "drivers/gpio/line_lookup.h"

namespace bevloc::test {

/// One chip with the label "mock" and the name "gpiochip0". All its lines start at low voltage.
/// Thread-safe if the clock is. Must outlive its lines.
class MockGpio final : public drivers::Gpio {
 public:
  static constexpr const char* kChip = "mock";

  struct Change {
    Time time;
    bool high = false;
  };

  /// `clock` gives the times of changes and edges, and must outlive the chip.
  MockGpio(const std::vector<std::string>& line_names, const drivers::Clock& clock);

  Result<std::unique_ptr<drivers::OutputLine>> open_output(const drivers::LineAddress& address,
                                                           bool active) override;
  Result<std::unique_ptr<drivers::InputLine>> open_input(
      const drivers::LineAddress& address) override;

  /// Whether the voltage on the wire is high.
  bool high(const std::string& line) const;
  /// Returns all changes of the voltage since construction.
  std::vector<Change> changes(const std::string& line) const;
  /// Sets the voltage of an input, as the device at the other end would.
  void drive(const std::string& line, bool high);
  /// Simulates the removal of the chip: from now on every use of a line fails.
  void unplug();

 private:
  class Output;
  class Input;

  struct Wire {
    bool high = false;
    bool active_low = false;  ///< the polarity that its user asked for
    bool is_input = false;    ///< the line is open as an input and collects edges
    std::vector<Change> changes;
    std::deque<drivers::LineEdge> edges;
  };

  Result<unsigned> claim(const drivers::LineAddress& address);
  void release(unsigned line);
  void put(unsigned line, bool high);
  unsigned index_of(const std::string& line) const;

  const drivers::Clock& clock_;
  mutable std::mutex mutex_;
  std::condition_variable edge_arrived_;
  drivers::GpioChipInfo chip_{"gpiochip0", kChip, {}};
  std::vector<Wire> wires_;
  bool unplugged_ = false;
};

}  // namespace bevloc::test
