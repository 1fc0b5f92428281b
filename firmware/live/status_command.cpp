#include "firmware/live/status_command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "firmware/config/live_config.h"
#include "firmware/live/httplib_header.h"
#include "firmware/telemetry/status_json.h"

namespace bevloc::firmware {
namespace {

constexpr time_t kPatience_s = 3;

/// The status that the daemon sends, parsed, and as text.
struct Answer {
  std::string text;
  nlohmann::json status;
};

Result<Answer> ask(const std::string& address, int port) {
  httplib::Client client(address, port);
  client.set_connection_timeout(kPatience_s);
  client.set_read_timeout(kPatience_s);
  const std::string place = authority_of({address, port, false});
  const auto response = client.Get("/status.json");
  if (!response) {
    return fail(
        "{}: found no bevlocd that answers ({}), wanted one with the section live in its "
        "configuration or the option --live",
        place, httplib::to_string(response.error()));
  }
  if (response->status != 200) {
    return fail("{}: found the answer {}, wanted 200 from a bevlocd", place, response->status);
  }
  auto status = nlohmann::json::parse(response->body, nullptr, false);
  if (!status.is_object() || !status.contains("phase")) {
    return fail("{}: found an answer that is no status of a bevlocd; is another program there?",
                place);
  }
  return Answer{response->body, std::move(status)};
}

}  // namespace

void StatusCommand::declare(CLI::App& app) {
  auto* command = app.add_subcommand(
      "status",
      "Print the status of a running bevlocd. Exit code 0: the pose is valid, 1: it is not, 2: no "
      "bevlocd answers");
  command->add_option("--address", address_, "IP address of the daemon")->capture_default_str();
  command->add_option("--port", port_, "Its port")
      ->check(CLI::Range(1, 65535))
      ->capture_default_str();
  command->add_flag("--json", json_, "Print the status as JSON");
  command->footer(
      "Examples:\n"
      "  bevloc status                 the daemon of this machine\n"
      "  bevloc status --port 9000 --json");
  command->callback([this] { chosen_ = true; });
}

int StatusCommand::run() const {
  const auto answer = ask(address_, port_);
  if (!answer) {
    fmt::print(stderr, "bevloc: {}\n", answer.error().message);
    return kNotReachable;
  }
  try {  // another version may use another type for a key
    const bool valid = answer->status.value("valid", false);
    fmt::print("{}", json_ ? answer->text : status_page(answer->status));
    return valid ? kValid : kNotValid;
  } catch (const nlohmann::json::exception& error) {
    fmt::print(stderr, "bevloc: found a status of another version of bevlocd ({})\n", error.what());
    return kNotReachable;
  }
}

}  // namespace bevloc::firmware
