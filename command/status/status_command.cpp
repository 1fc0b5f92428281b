#include "command/status/status_command.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>

#include <fmt/format.h>
#include <netdb.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/socket.h>

#include "command/status/status_page.h"
#include "common/file_descriptor.h"
#include "common/result.h"
#include "firmware/config/live_config.h"
#include "firmware/live/httplib_header.h"

namespace bevloc::command {
namespace {

constexpr time_t kPatience_s = 3;
/// A status is much smaller and comes at once. An answer beyond these limits is of another program.
constexpr size_t kLargestStatus_bytes = 1'000'000;
constexpr std::chrono::seconds kLongestAnswer(5);

/// Accepts the addresses that the server answers to (is_local_host_header() in http_server.cpp).
std::string check_address(const std::string& text) {
  if (text == "localhost" || firmware::is_ip_address(text)) return "";
  return fmt::format("found '{}', wanted an IP address in numbers, such as 127.0.0.1, or localhost",
                     text);
}

/// Tries to connect, and returns why the system cannot. httplib does not say why.
std::string connection_error(const std::string& address, int port) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int unknown = getaddrinfo(address.c_str(), std::to_string(port).c_str(), &wanted, &found);
  if (unknown != 0) return gai_strerror(unknown);
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owned(found, freeaddrinfo);
  const FileDescriptor socket(
      ::socket(found->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (socket.get() < 0) return std::strerror(errno);
  int error = connect(socket.get(), found->ai_addr, found->ai_addrlen) == 0 ? 0 : errno;
  if (error == EINPROGRESS) {
    pollfd connecting{socket.get(), POLLOUT, 0};
    poll(&connecting, 1, 1000);
    socklen_t size = sizeof error;
    getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size);
  }
  return error == 0 ? "no answer" : std::strerror(error);
}

std::string reason_of(httplib::Error error, const std::string& address, int port) {
  if (error == httplib::Error::Connection) return connection_error(address, port);
  return error == httplib::Error::Read ? "no answer" : httplib::to_string(error);
}

/// The status that the daemon sends, as text and parsed.
struct Answer {
  std::string text;
  nlohmann::json status;
};

Result<Answer> ask(const std::string& address, int port) {
  httplib::Client client(address, port);
  client.set_connection_timeout(kPatience_s);
  client.set_read_timeout(kPatience_s);
  const std::string place = firmware::authority_of({address, port, false});
  std::string text;
  const auto until = std::chrono::steady_clock::now() + kLongestAnswer;
  const auto response = client.Get("/status.json", [&](const char* part, size_t size) {
    text.append(part, size);
    return text.size() <= kLargestStatus_bytes && std::chrono::steady_clock::now() < until;
  });
  const bool endless = response.error() == httplib::Error::Canceled;
  if (!response && !endless) {
    return fail(
        "{}: found no bevlocd that answers ({}), wanted one with the section live in its "
        "configuration or the option --live",
        place, reason_of(response.error(), address, port));
  }
  if (endless) {
    text.clear();
  } else if (response->status != 200) {
    return fail("{}: found the answer {}, wanted 200 from a bevlocd", place, response->status);
  }
  auto status = nlohmann::json::parse(text, nullptr, false);
  if (!status.is_object() || !status.contains("phase")) {
    return fail("{}: found an answer that is no status of a bevlocd; is another program there?",
                place);
  }
  return Answer{std::move(text), std::move(status)};
}

}  // namespace

void StatusCommand::declare(CLI::App& app) {
  auto* command = app.add_subcommand(
      "status",
      "Print the status of a running bevlocd. Exit code 0: the pose is valid, 1: it is not, 2: no "
      "bevlocd answers");
  command->add_option("--address", address_, "IP address of the daemon")
      ->check(CLI::Validator(check_address, "", ""))
      ->capture_default_str();
  command->add_option("--port", port_, "Port of the daemon")
      ->check(CLI::Range(1, 65535))
      ->capture_default_str();
  command->add_flag("--json", json_, "Print the status as JSON");
  command->footer(
      "Examples:\n"
      "  bevloc status                 the daemon of this machine\n"
      "  bevloc status --port 9000 --json");
}

int StatusCommand::run() const {
  const auto answer = ask(address_, port_);
  if (!answer) {
    fmt::print(stderr, "bevloc: {}\n", answer.error().message);
    return kNotReachable;
  }
  try {  // another version of bevlocd may use another type for a key
    const bool valid = answer->status.value("valid", false);
    fmt::print("{}", json_ ? answer->text : status_page(answer->status));
    return valid ? kValid : kNotValid;
  } catch (const nlohmann::json::exception& error) {
    fmt::print(stderr,
               "bevloc: found a status of another version of bevlocd ({}); use the bevloc of that "
               "version\n",
               error.what());
    return kNotReachable;
  }
}

}  // namespace bevloc::command
