#include "command/listen/listen_command.h"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "can/bus/candump.h"
#include "can/bus/socketcan_bus.h"
#include "common/json_dump.h"
#include "common/option_checks.h"

namespace bevloc::command {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void note_interrupt(int) {
  interrupted = 1;
}

/// Lets Ctrl-C end the reading, also while no line comes. A second Ctrl-C ends the program.
void watch_for_interrupt() {
  struct sigaction action {};
  action.sa_handler = note_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // without SA_RESTART: a read returns
  sigaction(SIGINT, &action, nullptr);
}

/// Prints which parts of a file are not decoded.
void print_left_out(const can::Dbc& dbc) {
  for (const can::DbcMessage& message : dbc.messages) {
    if (!message.left_out.empty()) {
      fmt::print(stderr, "bevloc: {}; message {} is left out\n", message.left_out, message.name);
    } else if (message.nested_multiplexing) {
      fmt::print(stderr,
                 "bevloc: {}:{}: found several multiplexors in message {}, wanted one; its "
                 "multiplexed signals are left out\n",
                 dbc.file, message.line, message.name);
    }
  }
}

}  // namespace

void ListenCommand::declare(CLI::App& app) {
  auto* listen = app.add_subcommand("listen", "Decode a CAN bus, live or from a candump log");
  listen->footer(
      "Examples:\n"
      "  bevloc listen can0                         bevloc's messages on an interface\n"
      "  bevloc listen --dbc vehicle.dbc can.log    a log of another bus, too\n"
      "  bevloc listen --message LOC_Status --json can.log\n"
      "  candump -L can0 | bevloc listen -");
  listen->add_option("SOURCE", source_, "CAN interface, candump log, or - for standard input")
      ->required();
  // Each --dbc takes one value, because a further one is the SOURCE.
  listen
      ->add_option("--dbc", dbc_files_,
                   "DBC file, may be repeated; bevloc's own messages are known without one")
      ->allow_extra_args(false);
  listen->add_option("--message", messages_, "Print this message only, may be repeated")
      ->allow_extra_args(false);
  listen->add_flag("--bad", only_bad_,
                   "Print only frames that fail the end-to-end check or follow lost ones");
  auto* quiet = listen->add_flag("--quiet", quiet_, "Print the totals only");
  listen->add_flag(
      "--json", json_,
      "Print one JSON object per frame and no totals; with --quiet, one object with the totals");
  listen->add_option("--count", count_, "End after this number of printed frames")
      ->check(whole_number())
      ->excludes(quiet);
  listen->add_option("--duration", duration_s_, "End after this number of seconds")
      ->check(number_between(0.001, 1e9));
  const CLI::Range base_range(uint32_t{can::BaseIds::kFirst}, uint32_t{can::BaseIds::kLast});
  listen->add_option("--localizer-base", base_.localizer, "First identifier of the LOC_ messages")
      ->check(base_range);
  listen->add_option("--vehicle-base", base_.vehicle, "First identifier of the VEH_ messages")
      ->check(base_range);
}

Result<can::BusListener> ListenCommand::make_listener() const {
  if (!base_.are_apart()) {
    return fail(
        "--localizer-base: found {:#x} beside --vehicle-base {:#x}, wanted at least {:#x} between "
        "them, so that messages do not share identifiers",
        base_.localizer, base_.vehicle, can::BaseIds::kFamily);
  }
  std::vector<can::Dbc> files;
  for (const std::string& file : dbc_files_) {
    auto dbc = can::read_dbc_file(file);
    if (!dbc) return tl::unexpected(dbc.error());
    print_left_out(*dbc);
    files.push_back(std::move(*dbc));
  }
  can::BusListener listener(std::move(files), base_);
  for (const std::string& message : messages_) {
    if (!listener.knows(message)) {
      return fail("--message: found {}, wanted a message of the DBC files", message);
    }
  }
  return listener;
}

bool ListenCommand::is_wanted(const can::DecodedFrame& frame) const {
  const bool named =
      messages_.empty() || std::ranges::find(messages_, frame.message->name) != messages_.end();
  const bool bad = frame.e2e && *frame.e2e != can::E2eResult::kOk;
  return named && !quiet_ && (bad || !only_bad_);
}

bool ListenCommand::show(const can::Frame& frame, std::string_view interface, double time_s,
                         can::BusListener& listener) {
  const can::DecodedFrame* decoded = listener.decode(frame, interface);
  if (decoded == nullptr || !is_wanted(*decoded)) return true;
  std::cout << (json_ ? can::json_of(*decoded, time_s) : can::text_of(*decoded, time_s)) << '\n';
  ++printed_;
  return count_ == 0 || printed_ < count_;
}

Status ListenCommand::listen_to_log(std::istream& log, const std::string& name,
                                    can::BusListener& listener) {
  can::CandumpReader reader(log, name);
  std::optional<double> first_s;
  while (interrupted == 0) {
    const auto entry = reader.next();
    if (!entry) return tl::unexpected(entry.error());
    if (!*entry) break;
    const can::CandumpEntry& line = **entry;
    if (line.kind != can::CandumpKind::kData) continue;
    const double time_s = std::chrono::duration<double>(line.time).count();
    if (!first_s) first_s = time_s;
    if (duration_s_ > 0.0 && time_s - *first_s > duration_s_) break;
    if (!show(line.frame, line.interface, time_s, listener)) break;
  }
  return {};
}

Status ListenCommand::listen_to_interface(can::BusListener& listener) {
  auto bus = can::SocketCanBus::open(source_);
  if (!bus) {
    return fail("{} (a log file of this name was not found either)", bus.error().message);
  }
  listen_to_bus(**bus, listener);
  return {};
}

void ListenCommand::listen_to_bus(can::Bus& bus, can::BusListener& listener) {
  std::optional<Time> first;
  can::BusCondition condition;
  bool wants_more = true;
  const auto started = std::chrono::steady_clock::now();
  while (interrupted == 0 && wants_more) {
    const auto elapsed = std::chrono::steady_clock::now() - started;
    if (duration_s_ > 0.0 && std::chrono::duration<double>(elapsed).count() > duration_s_) break;
    bus.wait(std::chrono::milliseconds(100));
    while (const auto received = wants_more ? bus.receive() : std::nullopt) {
      if (!first) first = received->received;
      const double time_s = to_seconds(received->received - *first);
      wants_more = show(received->frame, source_, time_s, listener);
    }
    std::cout.flush();
    if (bus.condition() == condition) continue;
    condition = bus.condition();
    fmt::print(stderr, "bevloc: {}: the bus is now {}\n", source_, can::to_string(condition));
  }
  bus_counters_ = bus.counters();
}

void ListenCommand::print_json_totals(const can::BusListener& listener) const {
  nlohmann::ordered_json json;
  auto& messages = json["messages"] = nlohmann::ordered_json::array();
  for (const auto& [name, total] : listener.totals()) {
    messages.push_back({{"message", name},
                        {"frames", total.frames},
                        {"unusable", total.unusable},
                        {"lost", total.lost}});
  }
  json["other_frames"] = listener.unknown();
  if (bus_counters_) {
    json["dropped"] = bus_counters_->receive_dropped;
    json["ignored"] = bus_counters_->receive_ignored;
  }
  std::cout << dump_json(json) << '\n';
}

void ListenCommand::print_totals(const can::BusListener& listener) const {
  if (json_) {
    if (quiet_) print_json_totals(listener);
    return;
  }
  fmt::print("\n{:<28} {:>10} {:>10} {:>8}\n", "message", "frames", "unusable", "lost");
  for (const auto& [name, total] : listener.totals()) {
    fmt::print("{:<28} {:>10} {:>10} {:>8}\n", name, total.frames, total.unusable, total.lost);
  }
  const auto print_count = [](std::string_view what, uint64_t count) {
    fmt::print("{:<28} {:>10}\n", what, count);
  };
  print_count("frames of other messages", listener.unknown());
  if (!bus_counters_) return;
  print_count("frames dropped by the socket", bus_counters_->receive_dropped);
  print_count("29-bit, remote or bad frames", bus_counters_->receive_ignored);
}

Status ListenCommand::run() {
  auto listener = make_listener();
  if (!listener) return tl::unexpected(listener.error());
  watch_for_interrupt();
  Status status;
  std::error_code error;  // such as a name that is too long for a file
  if (source_ == "-") {
    status = listen_to_log(std::cin, "standard input", *listener);
  } else if (std::filesystem::is_directory(source_, error)) {
    return fail("{}: found a folder, wanted a CAN interface, a candump log or -", source_);
  } else if (std::filesystem::exists(source_, error)) {  // also a pipe
    std::ifstream log(source_);
    if (!log) return fail("{}: found no readable file, wanted a candump log", source_);
    status = listen_to_log(log, source_, *listener);
  } else {
    status = listen_to_interface(*listener);
  }
  std::cout.flush();
  if (status) print_totals(*listener);
  return status;
}

}  // namespace bevloc::command
