#include "can/messages/message.h"

namespace bevloc::can {

Frame blank_frame(const Message& message, const BaseIds& base) {
  Frame frame{.id = message.id(base), .length = message.length, .format = message.format};
  for (const Signal* signal : message.signals) {
    if (signal->has_sna) insert_raw(frame, *signal, signal->sna_raw());
  }
  return frame;
}

}  // namespace bevloc::can
