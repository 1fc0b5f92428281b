// Prints the DBC file of the message table: bevloc_dbc > can/bevloc.dbc
#include <iostream>

#include <CLI/CLI.hpp>

#include "can/messages/consumer_writer.h"
#include "can/messages/dbc_writer.h"
#include "can/messages/markdown_writer.h"
#include "common/option_checks.h"
#include "common/output.h"

int main(int argc, char** argv) {
  CLI::App app("Prints the DBC file of bevloc's CAN messages.");
  bevloc::can::BaseIds base;
  bool markdown = false;
  const CLI::Range base_range(uint32_t{bevloc::can::BaseIds::kFirst},
                              uint32_t{bevloc::can::BaseIds::kLast});
  app.add_option("--localizer-base", base.localizer, "first identifier of the LOC_ messages")
      ->check(base_range)
      ->capture_default_str();
  app.add_option("--vehicle-base", base.vehicle, "first identifier of the VEH_ messages")
      ->check(base_range)
      ->capture_default_str();
  auto* tables = app.add_flag("--markdown", markdown, "print the tables of docs/can.md instead");
  bool c_header = false;
  auto* header =
      app.add_flag("--c-header", c_header, "print can/consumer/bevloc_messages.h instead")
          ->excludes(tables);
  bool python = false;
  app.add_flag("--python", python, "print can/consumer/bevloc_messages.py instead")
      ->excludes(tables)
      ->excludes(header);
  if (const auto ended = bevloc::parse_options(app, argc, argv)) return *ended;
  if (!base.are_apart()) {
    std::cerr
        << "bevloc_dbc: --localizer-base: found less than 0x40 between it and "
           "--vehicle-base, wanted at least 0x40, so that messages do not share identifiers\n";
    return bevloc::kBadInput;
  }
  std::cout << (markdown   ? bevloc::can::markdown_tables(base)
                : c_header ? bevloc::can::consumer_header_text(base)
                : python   ? bevloc::can::consumer_python_text(base)
                           : bevloc::can::dbc_text(base));
  const bevloc::Status printed = bevloc::flush_output();
  if (!printed) std::cerr << "bevloc_dbc: " << printed.error().message << '\n';
  return printed ? 0 : bevloc::kBadInput;
}
