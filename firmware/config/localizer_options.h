// The options of the localizer that a configuration asks for.
#pragma once

#include "firmware/config/config.h"
#include "pipeline/localization/localizer.h"

namespace bevloc::firmware {

LocalizerOptions localizer_options_of(const Config& config);

}  // namespace bevloc::firmware
