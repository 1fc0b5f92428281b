#include "firmware/config/localizer_options.h"

namespace bevloc::firmware {

LocalizerOptions localizer_options_of(const Config& config) {
  LocalizerOptions options;
  options.solver = config.solver.kind;
  options.tracking = config.solver.tracking;
  options.acquiring = config.solver.acquiring;
  options.online_calibration = config.online_calibration;
  return options;
}

}  // namespace bevloc::firmware
