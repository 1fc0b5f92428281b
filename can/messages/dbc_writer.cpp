#include "can/messages/dbc_writer.h"

#include <functional>
#include <iterator>

#include <fmt/format.h>

#include "can/messages/message_table.h"
#include "common/version.h"

namespace bevloc::can {
namespace {

// The lines that follow VERSION.
constexpr std::string_view kHeader = R"(

NS_ :
	CM_
	BA_DEF_
	BA_
	VAL_
	BA_DEF_DEF_

BS_:

BU_: LOCALIZER VEHICLE

)";

constexpr std::string_view kAttributes =
    R"(BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_ BO_ "E2EProfile" STRING;
BA_DEF_ BO_ "E2EDataId" INT 0 65535;
BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG","reserved","reserved","reserved","reserved","reserved","reserved","reserved","reserved","reserved","reserved","StandardCAN_FD","ExtendedCAN_FD";
BA_DEF_ BO_ "CANFD_BRS" ENUM "0","1";
BA_DEF_ "BusType" STRING;
BA_DEF_ "BevlocVersion" STRING;
BA_DEF_ SG_ "GenSigStartValue" FLOAT -2147483648 4294967295;
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_DEF_DEF_ "E2EProfile" "P02";
BA_DEF_DEF_ "E2EDataId" 0;
BA_DEF_DEF_ "VFrameFormat" "StandardCAN";
BA_DEF_DEF_ "CANFD_BRS" "0";
BA_DEF_DEF_ "BusType" "";
BA_DEF_DEF_ "BevlocVersion" "";
BA_DEF_DEF_ "GenSigStartValue" 0;
BA_ "BusType" "CAN FD";
)";

constexpr std::string_view kFileComment =
    "The pose of the vehicle in its HD map (LOC_) and the sensors that the localizer needs from "
    "the vehicle (VEH_). Intel byte order. Every classic frame carries AUTOSAR E2E profile P02 "
    "with one constant data id per message (attribute E2EDataId) for all 16 counters, every FD "
    "frame profile P05: ignore a frame whose CHECKSUM is wrong or whose COUNTER did not change, "
    "and treat a signal as not available after 3 cycles without a good frame. A signal whose value "
    "is SNA is not available. The localizer sends LOC_Solution or the other LOC_ messages, never "
    "both. Generated from the message table of bevloc.";

using Out = std::back_insert_iterator<std::string>;

std::string_view sender_name(Sender sender) {
  return sender == Sender::kLocalizer ? "LOCALIZER" : "VEHICLE";
}
std::string_view receiver_name(Sender sender) {
  return sender == Sender::kLocalizer ? "VEHICLE" : "LOCALIZER";
}

void for_each_signal(const Message& message, const std::function<void(const Signal&)>& visit) {
  for (const Signal* signal : e2e_header(message.format)) visit(*signal);
  for (const Signal* signal : message.signals) visit(*signal);
}

void write_message(Out out, const Message& message, const BaseIds& base) {
  fmt::format_to(out, "BO_ {} {}: {} {}\n", message.id(base), message.name, message.length,
                 sender_name(message.sender));
  for_each_signal(message, [&](const Signal& signal) {
    fmt::format_to(out, " SG_ {} : {}|{}@1{} ({},{}) [{}|{}] \"{}\" {}\n", signal.name,
                   signal.start_bit, signal.length_bits, signal.is_signed ? '-' : '+', signal.scale,
                   signal.offset, signal.min, signal.max, signal.unit,
                   receiver_name(message.sender));
  });
  fmt::format_to(out, "\n");
}

void write_comments(Out out, const Message& message, uint32_t id) {
  if (!message.comment.empty()) fmt::format_to(out, "CM_ BO_ {} \"{}\";\n", id, message.comment);
  for_each_signal(message, [&](const Signal& signal) {
    if (signal.comment.empty()) return;
    fmt::format_to(out, "CM_ SG_ {} {} \"{}\";\n", id, signal.name, signal.comment);
  });
}

void write_attributes(Out out, const Message& message, uint32_t id) {
  fmt::format_to(out, "BA_ \"GenMsgCycleTime\" BO_ {} {};\n", id, message.cycle_ms);
  fmt::format_to(out, "BA_ \"E2EDataId\" BO_ {} {};\n", id, message.data_id);
  if (message.format == FrameFormat::kFd) {
    fmt::format_to(out, "BA_ \"E2EProfile\" BO_ {} \"P05\";\n", id);
    fmt::format_to(out, "BA_ \"VFrameFormat\" BO_ {} 14;\n", id);
    fmt::format_to(out, "BA_ \"CANFD_BRS\" BO_ {} 1;\n", id);
  }
  for_each_signal(message, [&](const Signal& signal) {
    if (!signal.has_sna) return;
    fmt::format_to(out, "BA_ \"GenSigStartValue\" SG_ {} {} {};\n", id, signal.name,
                   signal.sna_raw());
  });
}

void write_values(Out out, const Message& message, uint32_t id) {
  for_each_signal(message, [&](const Signal& signal) {
    if (signal.value_names.empty() && !signal.has_sna) return;
    fmt::format_to(out, "VAL_ {} {}", id, signal.name);
    for (const ValueName& value : signal.value_names) {
      fmt::format_to(out, " {} \"{}\"", value.raw, value.name);
    }
    if (signal.has_sna) fmt::format_to(out, " {} \"SNA\"", signal.sna_raw());
    fmt::format_to(out, " ;\n");
  });
}

}  // namespace

std::string dbc_text(const BaseIds& base) {
  std::string text = fmt::format("VERSION \"{}\"{}", version(), kHeader);
  const Out out = std::back_inserter(text);
  for (const Message* message : kMessages) write_message(out, *message, base);
  fmt::format_to(out, "CM_ \"{}\";\n", kFileComment);
  for (const Message* message : kMessages) write_comments(out, *message, message->id(base));
  text += kAttributes;
  fmt::format_to(out, "BA_ \"BevlocVersion\" \"{}\";\n", version());
  for (const Message* message : kMessages) write_attributes(out, *message, message->id(base));
  for (const Message* message : kMessages) write_values(out, *message, message->id(base));
  return text;
}

}  // namespace bevloc::can
