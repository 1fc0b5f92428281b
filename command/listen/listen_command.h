// The command `bevloc listen`: decodes a CAN bus, live or from a log.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "can/bus/bus.h"
#include "can/listen/bus_listener.h"
#include "common/result.h"

namespace bevloc::command {

/// The command. Call declare(), parse the command line, then call run() if it names the command.
class ListenCommand {
 public:
  void declare(CLI::App& app);

  /// Prints each decoded frame. Ends with the log, after --duration, --count frames, or on SIGINT.
  /// Fails if a file cannot be read or the interface cannot be opened.
  Status run();

  /// Does what run() does with an interface. Each change of the bus condition is a line on standard
  /// error.
  void listen_to_bus(can::Bus& bus, can::BusListener& listener);
  /// Prints the totals in the form that the command line asks for.
  void print_totals(const can::BusListener& listener) const;

 private:
  Result<can::BusListener> make_listener() const;
  Status listen_to_log(std::istream& log, const std::string& name, can::BusListener& listener);
  Status listen_to_interface(can::BusListener& listener);
  /// Prints a frame. Returns false when enough was printed.
  bool show(const can::Frame& frame, std::string_view interface, double time_s,
            can::BusListener& listener);
  bool is_wanted(const can::DecodedFrame& frame) const;
  void print_json_totals(const can::BusListener& listener) const;

  std::string source_;
  std::vector<std::string> dbc_files_;
  std::vector<std::string> messages_;
  bool json_ = false;
  bool only_bad_ = false;
  bool quiet_ = false;
  uint64_t count_ = 0;  ///< 0 for no limit
  double duration_s_ = 0.0;
  can::BaseIds base_;
  uint64_t printed_ = 0;
  std::optional<can::BusCounters> bus_counters_;  ///< nothing for a log
};

}  // namespace bevloc::command
