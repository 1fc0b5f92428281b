// Writes the constants of the localizer's messages for the consumers in can/consumer.
#pragma once

#include <string>

#include "can/messages/message.h"

namespace bevloc::can {

/// Returns a C99 header with length, cycle, data id and signals of each LOC_ message.
std::string consumer_header_text(const BaseIds& base);

/// Returns the same constants as a Python module.
std::string consumer_python_text(const BaseIds& base);

}  // namespace bevloc::can
