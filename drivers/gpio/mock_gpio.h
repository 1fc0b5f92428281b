// GPIO lines without hardware: a test sees what was driven, and drives what is read.
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <vector>

#include "drivers/clock/clock.h"
#include "drivers/gpio/gpio.h"
#include "drivers/gpio/line_lookup.h"

namespace bevloc::drivers {

/// One chip of the label "mock" and the name "gpiochip0" whose lines have the given names, all at
/// low voltage. Times are the clock's. Thread safe if the clock is; must outlive its lines.
class MockGpio final : public Gpio {
 public:
  static constexpr const char* kChip = "mock";

  struct Change {
    Time time;
    bool high = false;
  };

  MockGpio(const std::vector<std::string>& line_names, const Clock& clock);

  Result<std::unique_ptr<OutputLine>> open_output(const LineAddress& address, bool active) override;
  Result<std::unique_ptr<InputLine>> open_input(const LineAddress& address) override;

  /// The voltage on the wire, as a meter would show it.
  bool high(const std::string& line) const;
  /// Every change of that voltage since the start.
  std::vector<Change> changes(const std::string& line) const;
  /// What stands at the other end of an input does.
  void drive(const std::string& line, bool high);
  /// From now on every use of every line fails, as if the chip had been unplugged.
  void unplug();

 private:
  class Output;
  class Input;

  struct Wire {
    bool high = false;
    bool active_low = false;  ///< as its user sees it
    bool listens = false;     ///< somebody reads its edges
    std::vector<Change> changes;
    std::deque<LineEdge> edges;
  };

  Result<unsigned> claim(const LineAddress& address);
  void release(unsigned line);
  void put(unsigned line, bool high);
  unsigned index_of(const std::string& line) const;

  const Clock& clock_;
  mutable std::mutex mutex_;
  std::condition_variable edge_came_;
  GpioChipInfo chip_{"gpiochip0", kChip, {}};
  std::vector<Wire> wires_;
  bool unplugged_ = false;
};

}  // namespace bevloc::drivers
