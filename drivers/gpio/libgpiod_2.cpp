// The calls to libgpiod 2 (Debian 13 has 2.2).
#include <cerrno>
#include <cstring>

#include <gpiod.h>

#include "drivers/gpio/libgpiod_calls.h"

namespace bevloc::drivers {
namespace {

template <auto free_function>
struct Freer {
  template <typename T>
  void operator()(T* object) const {
    free_function(object);
  }
};
using ChipInfo = std::unique_ptr<gpiod_chip_info, Freer<gpiod_chip_info_free>>;
using LineInfo = std::unique_ptr<gpiod_line_info, Freer<gpiod_line_info_free>>;
using LineSettings = std::unique_ptr<gpiod_line_settings, Freer<gpiod_line_settings_free>>;
using LineConfig = std::unique_ptr<gpiod_line_config, Freer<gpiod_line_config_free>>;
using RequestConfig = std::unique_ptr<gpiod_request_config, Freer<gpiod_request_config_free>>;
using LineRequest = std::unique_ptr<gpiod_line_request, Freer<gpiod_line_request_release>>;
using EventBuffer = std::unique_ptr<gpiod_edge_event_buffer, Freer<gpiod_edge_event_buffer_free>>;

gpiod_line_value value_of(bool active) {
  return active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
}

class Output final : public OutputLine {
 public:
  Output(LineRequest request, unsigned line, LineAddress address)
      : request_(std::move(request)), line_(line), address_(std::move(address)) {}

  Status set(bool active) override {
    if (gpiod_line_request_set_value(request_.get(), line_, value_of(active)) == 0) return {};
    return fail("{}: cannot be set: {}", to_string(address_), std::strerror(errno));
  }

 private:
  LineRequest request_;
  unsigned line_;
  LineAddress address_;
};

class Input final : public InputLine {
 public:
  Input(LineRequest request, unsigned line, LineAddress address)
      : request_(std::move(request)),
        line_(line),
        address_(std::move(address)),
        events_(gpiod_edge_event_buffer_new(1)) {}

  Result<bool> active() override {
    const gpiod_line_value value = gpiod_line_request_get_value(request_.get(), line_);
    if (value == GPIOD_LINE_VALUE_ERROR) return cannot_be_read();
    return value == GPIOD_LINE_VALUE_ACTIVE;
  }

  Result<std::optional<LineEdge>> next_edge(Duration timeout) override {
    const int events = gpiod_line_request_wait_edge_events(request_.get(), timeout.count());
    if (events == 0 || (events < 0 && errno == EINTR)) return std::nullopt;
    if (events < 0 || gpiod_line_request_read_edge_events(request_.get(), events_.get(), 1) != 1) {
      return cannot_be_read();
    }
    gpiod_edge_event* const event = gpiod_edge_event_buffer_get_event(events_.get(), 0);
    const auto time_ns = static_cast<int64_t>(gpiod_edge_event_get_timestamp_ns(event));
    return LineEdge{Time(Duration(time_ns)),
                    gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE};
  }

 private:
  tl::unexpected<Error> cannot_be_read() const {
    return fail("{}: cannot be read: {}", to_string(address_), std::strerror(errno));
  }

  LineRequest request_;
  unsigned line_;
  LineAddress address_;
  EventBuffer events_;
};

LineSettings settings_for(const LineAddress& address) {
  LineSettings settings(gpiod_line_settings_new());
  gpiod_line_settings_set_active_low(settings.get(), address.active_low);
  return settings;
}

Result<LineRequest> request(gpiod_chip& chip, unsigned offset, const LineAddress& address,
                            gpiod_line_settings& settings) {
  const LineConfig lines(gpiod_line_config_new());
  const RequestConfig config(gpiod_request_config_new());
  gpiod_request_config_set_consumer(config.get(), kGpioConsumer);
  gpiod_line_config_add_line_settings(lines.get(), &offset, 1, &settings);
  LineRequest request(gpiod_chip_request_lines(&chip, config.get(), lines.get()));
  if (!request) {
    return fail("{}: cannot be requested: {}", to_string(address), std::strerror(errno));
  }
  return request;
}

}  // namespace

GpioChipInfo info_of(gpiod_chip& chip) {
  const ChipInfo chip_info(gpiod_chip_get_info(&chip));
  if (!chip_info) return {};
  GpioChipInfo info{
      gpiod_chip_info_get_name(chip_info.get()), gpiod_chip_info_get_label(chip_info.get()), {}};
  for (unsigned offset = 0; offset < gpiod_chip_info_get_num_lines(chip_info.get()); ++offset) {
    GpioLineInfo& line = info.lines.emplace_back();
    const LineInfo line_info(gpiod_chip_get_line_info(&chip, offset));
    if (!line_info) continue;
    line.name = text_or_empty(gpiod_line_info_get_name(line_info.get()));
    if (!gpiod_line_info_is_used(line_info.get())) continue;
    line.consumer = text_or_empty(gpiod_line_info_get_consumer(line_info.get()));
    if (line.consumer.empty()) line.consumer = "the kernel";
  }
  return info;
}

Result<std::unique_ptr<OutputLine>> request_output(GpioChipHandle chip, unsigned line,
                                                   const LineAddress& address, bool active) {
  const LineSettings settings = settings_for(address);
  gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT);
  gpiod_line_settings_set_output_value(settings.get(), value_of(active));
  auto requested = request(*chip, line, address, *settings);
  if (!requested) return tl::unexpected(requested.error());
  return std::make_unique<Output>(std::move(*requested), line, address);
}

Result<std::unique_ptr<InputLine>> request_input(GpioChipHandle chip, unsigned line,
                                                 const LineAddress& address) {
  const LineSettings settings = settings_for(address);
  gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
  gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
  auto requested = request(*chip, line, address, *settings);
  if (!requested) return tl::unexpected(requested.error());
  return std::make_unique<Input>(std::move(*requested), line, address);
}

}  // namespace bevloc::drivers
