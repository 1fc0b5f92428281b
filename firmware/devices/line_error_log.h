// Logs the errors of a GPIO line, each cause once.
#pragma once

#include <string_view>

#include <spdlog/spdlog.h>

#include "common/result.h"
#include "firmware/telemetry/cause_log.h"

namespace bevloc::firmware {

/// Logs the errors of one line. One thread.
class LineErrorLog {
 public:
  /// `line` is the name of the line in the log. It must outlive this object.
  LineErrorLog(std::string_view line, spdlog::level::level_enum level)
      : line_(line), level_(level) {}

  void note(const Error& error, Time now) {
    if (!causes_.is_new(error.message, now)) return;
    spdlog::log(level_, "gpio: {}: {}; check the chip, then restart bevlocd", line_, error.message);
  }

 private:
  std::string_view line_;
  spdlog::level::level_enum level_;
  CauseLog causes_;
};

}  // namespace bevloc::firmware
