// The calls to libgpiod 1 (Debian 12 has 1.6).
#include <cerrno>
#include <cstring>

#include <gpiod.h>

#include "common/kernel_time.h"
#include "drivers/gpio/libgpiod_calls.h"

namespace bevloc::drivers {
namespace {

class Output final : public OutputLine {
 public:
  Output(GpioChipHandle chip, gpiod_line* line, LineAddress address)
      : chip_(std::move(chip)), line_(line), address_(std::move(address)) {}

  Status set(bool active) override {
    if (gpiod_line_set_value(line_, active ? 1 : 0) == 0) return {};
    return fail("{}: cannot be set: {}", to_string(address_), std::strerror(errno));
  }

 private:
  GpioChipHandle chip_;  // closing the chip releases the line
  gpiod_line* line_;
  LineAddress address_;
};

class Input final : public InputLine {
 public:
  Input(GpioChipHandle chip, gpiod_line* line, LineAddress address)
      : chip_(std::move(chip)), line_(line), address_(std::move(address)) {}

  Result<bool> active() override {
    const int value = gpiod_line_get_value(line_);
    if (value < 0) return cannot_be_read();
    return value == 1;
  }

  Result<std::optional<LineEdge>> next_edge(Duration timeout) override {
    const timespec wait = timespec_of(timeout);
    const int events = gpiod_line_event_wait(line_, &wait);
    if (events == 0 || (events < 0 && errno == EINTR)) return std::nullopt;
    gpiod_line_event event{};
    if (events < 0 || gpiod_line_event_read(line_, &event) != 0) return cannot_be_read();
    return LineEdge{Time(duration_of(event.ts)), event.event_type == GPIOD_LINE_EVENT_RISING_EDGE};
  }

 private:
  tl::unexpected<Error> cannot_be_read() const {
    return fail("{}: cannot be read: {}", to_string(address_), std::strerror(errno));
  }

  GpioChipHandle chip_;
  gpiod_line* line_;
  LineAddress address_;
};

Result<gpiod_line*> request(gpiod_chip& chip, unsigned offset, const LineAddress& address,
                            int direction, bool active) {
  const gpiod_line_request_config config{
      kGpioConsumer, direction, address.active_low ? int{GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW} : 0};
  gpiod_line* const line = gpiod_chip_get_line(&chip, offset);
  if (line == nullptr || gpiod_line_request(line, &config, active ? 1 : 0) != 0) {
    return fail("{}: cannot be requested: {}", to_string(address), std::strerror(errno));
  }
  return line;
}

}  // namespace

GpioChipInfo info_of(gpiod_chip& chip) {
  GpioChipInfo info{gpiod_chip_name(&chip), gpiod_chip_label(&chip), {}};
  for (unsigned offset = 0; offset < gpiod_chip_num_lines(&chip); ++offset) {
    GpioLineInfo& line = info.lines.emplace_back();
    gpiod_line* const handle = gpiod_chip_get_line(&chip, offset);
    if (handle == nullptr) continue;
    line.name = text_or_empty(gpiod_line_name(handle));
    if (!gpiod_line_is_used(handle)) continue;
    line.consumer = text_or_empty(gpiod_line_consumer(handle));
    if (line.consumer.empty()) line.consumer = "the kernel";
  }
  return info;
}

Result<std::unique_ptr<OutputLine>> request_output(GpioChipHandle chip, unsigned line,
                                                   const LineAddress& address, bool active) {
  const auto requested = request(*chip, line, address, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, active);
  if (!requested) return tl::unexpected(requested.error());
  return std::make_unique<Output>(std::move(chip), *requested, address);
}

Result<std::unique_ptr<InputLine>> request_input(GpioChipHandle chip, unsigned line,
                                                 const LineAddress& address) {
  const auto requested = request(*chip, line, address, GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES, false);
  if (!requested) return tl::unexpected(requested.error());
  return std::make_unique<Input>(std::move(chip), *requested, address);
}

}  // namespace bevloc::drivers
