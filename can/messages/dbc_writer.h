// Writes the DBC file, which describes the messages and signals for other CAN tools.
#pragma once

#include <string>

#include "can/messages/message.h"

namespace bevloc::can {

/// Returns the message table as DBC text, with these base ids: messages, signals with unit, range
/// and value names, comments, and the attributes GenMsgCycleTime, GenSigStartValue (raw), E2EDataId
/// and BevlocVersion (the version of the program that wrote the file).
std::string dbc_text(const BaseIds& base = {});

}  // namespace bevloc::can
