#include "firmware/devices/fault_line.h"

namespace bevloc::firmware {

Result<std::unique_ptr<FaultLine>> FaultLine::open(
    const std::optional<drivers::LineAddress>& address, drivers::Gpio& gpio) {
  std::unique_ptr<drivers::OutputLine> line;
  if (address) {
    auto opened = gpio.open_output(*address, true);
    if (!opened) return fail("gpio: {}", opened.error().message);
    line = std::move(*opened);
  }
  return std::unique_ptr<FaultLine>(new FaultLine(std::move(line)));
}

FaultLine::~FaultLine() {
  // A failure is not logged, because a process that ends cannot do more.
  if (line_) std::ignore = line_->set(true);
}

void FaultLine::set(bool fault, Time now) {
  if (!line_) return;
  if (Status status = line_->set(fault); !status) errors_.note(status.error(), now);
}

}  // namespace bevloc::firmware
