// The DBC file, which tells other tools how to read our frames.
#pragma once

#include <string>

#include "can/message.h"

namespace bevloc::can {

/// The DBC text of the message table at these base ids: messages, signals with unit, range and
/// value names, comments, and the attributes GenMsgCycleTime, GenSigStartValue (raw) and E2EDataId.
std::string dbc_text(const BaseIds& base = {});

}  // namespace bevloc::can
