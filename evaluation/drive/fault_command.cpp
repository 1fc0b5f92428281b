#include "evaluation/drive/fault_command.h"

#include "evaluation/drive/fault_socket.h"

namespace bevloc::evaluation {

void FaultCommand::declare(CLI::App& app) {
  auto* fault = app.add_subcommand(
      "fault", "Set, list and clear the faults of a running bevlocd with the simulator");
  fault->require_subcommand(1);
  fault->add_option("--socket", socket_, "simulation.fault_socket of its configuration")
      ->required();
  auto* set = fault->add_subcommand("set", "Add a fault that begins now");
  set->add_option("fault", words_,
                  "The kind (docs/simulation.md), then KEY=VALUE: its amounts, camera, with, "
                  "from_s, until_s, for_s")
      ->required();
  auto* list = fault->add_subcommand("list", "Show all faults with their numbers");
  auto* clear = fault->add_subcommand("clear", "Remove all faults, or the one of a number");
  clear->add_option("number", words_, "Number of the fault, as `list` shows it")->expected(0, 1);
  fault->footer(
      "Examples:\n"
      "  bevloc fault --socket faults.sock set gnss_jump east_m=20 for_s=5\n"
      "  bevloc fault --socket faults.sock list\n"
      "  bevloc fault --socket faults.sock clear");
  for (auto* verb : {set, list, clear}) {
    verb->callback([this, verb] { verb_ = verb->get_name(); });
  }
}

Status FaultCommand::run() const {
  std::string command = verb_;
  for (const std::string& word : words_) command += ' ' + word;
  const auto answer = send_fault_command(socket_, command);
  if (!answer) return tl::unexpected(answer.error());
  fmt::print("{}", *answer);
  return {};
}

}  // namespace bevloc::evaluation
