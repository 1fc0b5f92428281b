#include "can/messages/markdown_writer.h"

#include <iterator>

#include <fmt/format.h>

#include "can/messages/message_table.h"

namespace bevloc::can {
namespace {

using Out = std::back_insert_iterator<std::string>;

void write_signal_row(Out out, const Signal& signal) {
  fmt::format_to(out, "| {} | {} | {}{} | {} | {} | {} to {} |", signal.name, signal.start_bit,
                 signal.is_signed ? 'S' : 'U', signal.length_bits, signal.scale, signal.unit,
                 signal.min, signal.max);
  if (signal.has_sna) fmt::format_to(out, " {:#x}", signal.sna_raw());
  fmt::format_to(out, " | {}", signal.comment);
  const char* separator = signal.comment.empty() ? "" : " ";
  for (const ValueName& value : signal.value_names) {
    fmt::format_to(out, "{}{} {}", separator, value.raw, value.name);
    separator = ", ";
  }
  fmt::format_to(out, " |\n");
}

void write_message_table(Out out, const Message& message, const BaseIds& base) {
  fmt::format_to(out, "\n### {} (0x{:03X})\n\n{}\n\n", message.name, message.id(base),
                 message.comment);
  fmt::format_to(out,
                 "| Signal | Start bit | Bits | Step | Unit | Range | SNA (raw) | Meaning |\n");
  fmt::format_to(out, "|---|---|---|---|---|---|---|---|\n");
  for (const Signal* signal : message.signals) write_signal_row(out, *signal);
}

}  // namespace

std::string markdown_tables(const BaseIds& base) {
  std::string text =
      "| Id | Message | From | Cycle | Bytes | E2E data id |\n|---|---|---|---|---|---|\n";
  const Out out = std::back_inserter(text);
  for (const Message* message : kMessages) {
    fmt::format_to(out, "| 0x{:03X} | {} | {} | {} ms | {} | 0x{:02X} |\n", message->id(base),
                   message->name, message->sender == Sender::kLocalizer ? "localizer" : "vehicle",
                   message->cycle_ms, message->length, message->data_id);
  }
  for (const Message* message : kMessages) write_message_table(out, *message, base);
  return text;
}

}  // namespace bevloc::can
