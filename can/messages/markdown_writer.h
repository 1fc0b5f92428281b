// Writes the message tables of docs/can.md.
#pragma once

#include <string>

#include "can/messages/message.h"

namespace bevloc::can {

/// Returns, in Markdown, one table of all messages and then one table of signals per message.
std::string markdown_tables(const BaseIds& base = {});

}  // namespace bevloc::can
