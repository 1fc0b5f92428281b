// The message tables of docs/can.md.
#pragma once

#include <string>

#include "can/message.h"

namespace bevloc::can {

/// One overview of the messages, then one table of signals per message, in Markdown.
std::string markdown_tables(const BaseIds& base = {});

}  // namespace bevloc::can
