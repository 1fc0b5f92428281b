#include "evaluation/drive/fault_socket.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "common/number_text.h"
#include "evaluation/drive/vehicle_bus_encoder.h"
#include "sim/faults/drive_clock.h"
#include "sim/faults/fault_text.h"

namespace bevloc::evaluation {
namespace {

constexpr std::string_view kError = "error: ";
constexpr int kPatience_ms = 2000;
using Buffer = std::array<char, 65536>;

Result<sockaddr_un> address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = path.string();
  if (name.empty() || name.size() >= sizeof address.sun_path) {
    return fail("fault socket: found a path of {} bytes, wanted 1 to {}: {}", name.size(),
                sizeof address.sun_path - 1, name);
  }
  std::memcpy(address.sun_path, name.c_str(), name.size() + 1);
  return address;
}

const sockaddr* as_generic(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

/// One line per fault.
std::string to_list(const sim::FaultBoard& faults) {
  std::string text;
  for (const sim::NumberedFault& listed : faults.list()) {
    text += fmt::format("{}: {}\n", listed.number, sim::to_text(listed.fault));
  }
  return text;
}

}  // namespace

Result<std::unique_ptr<FaultServer>> FaultServer::open(const std::filesystem::path& path,
                                                       std::shared_ptr<sim::FaultBoard> faults,
                                                       DriveWithSocket drive) {
  const auto address = address_of(path);
  if (!address) return tl::unexpected(address.error());
  FileDescriptor descriptor(socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  std::error_code ignored;
  if (std::filesystem::is_socket(path, ignored)) std::filesystem::remove(path, ignored);
  if (descriptor.get() < 0 || bind(descriptor.get(), as_generic(*address), sizeof *address) != 0) {
    return fail("{}: found no way to make the fault socket ({}), wanted a path to write to",
                path.string(), std::strerror(errno));
  }
  return std::unique_ptr<FaultServer>(
      new FaultServer(std::move(descriptor), path, std::move(faults), std::move(drive)));
}

FaultServer::FaultServer(FileDescriptor descriptor, std::filesystem::path path,
                         std::shared_ptr<sim::FaultBoard> faults, DriveWithSocket drive)
    : descriptor_(std::move(descriptor)),
      path_(std::move(path)),
      faults_(std::move(faults)),
      drive_(std::move(drive)) {}

FaultServer::~FaultServer() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

void FaultServer::step(double now_s) {
  Buffer buffer;
  while (true) {
    sockaddr_un sender{};
    socklen_t sender_size = sizeof sender;
    const ssize_t size = recvfrom(descriptor_.get(), buffer.data(), buffer.size(), 0,
                                  reinterpret_cast<sockaddr*>(&sender), &sender_size);
    if (size < 0) return;
    const std::string reply = answer({buffer.data(), static_cast<size_t>(size)}, now_s);
    sendto(descriptor_.get(), reply.data(), reply.size(), 0, as_generic(sender), sender_size);
  }
}

std::string FaultServer::answer(const std::string& command, double now_s) {
  const size_t space = command.find(' ');
  const std::string verb = command.substr(0, space);
  const std::string rest = space == std::string::npos ? "" : command.substr(space + 1);
  if (verb == "set") return set(rest, now_s);
  if (verb == "list") return to_list(*faults_);
  if (verb == "clear") return clear(rest, now_s);
  return fmt::format("{}found '{}', wanted set, list or clear", kError, verb);
}

std::string FaultServer::set(const std::string& text, double now_s) {
  const auto fault = sim::parse_fault(text, std::max(0.0, now_s));
  if (!fault) return fmt::format("{}{}", kError, fault.error().message);
  const Status possible = check(*fault, now_s);
  if (!possible) return fmt::format("{}{}", kError, possible.error().message);
  return fmt::format("{}: {}\n", faults_->add(*fault), sim::to_text(*fault));
}

/// Fails for a fault that this running drive cannot show.
Status FaultServer::check(const sim::Fault& fault, double now_s) const {
  const sim::FaultKindInfo& info = sim::info_of(fault.kind);
  if (info.input == sim::FaultInput::kMap) {
    return fail(
        "found {} in a running drive, wanted it in simulation.faults, because the map is read only "
        "once",
        info.name);
  }
  if (drive_.lockstep && info.input == sim::FaultInput::kThread) {
    return fail("found {} with --fast, wanted a drive without, because one thread runs everything",
                info.name);
  }
  if (fault.kind != sim::FaultKind::kClockSuspend) return check_expressible(fault, drive_.can);
  const double begins_s =
      std::max(now_s, fault.from_s) + sim::added_time_s(faults_->all(sim::FaultInput::kClock));
  const double left_s = std::max(0.0, drive_.length_s - begins_s);
  if (fault.amounts.gap_s <= left_s) return {};
  return fail(
      "gap_s: found {}, wanted at most {:.1f}, because the simulated drive ends then; a longer "
      "suspension is possible in simulation.faults",
      fault.amounts.gap_s, left_s);
}

std::string FaultServer::clear(const std::string& number, double now_s) {
  if (number.empty()) {
    faults_->clear(now_s);
    return "";
  }
  const auto wanted = parse_number<uint32_t>(number);
  if (wanted && faults_->remove(*wanted, now_s)) return "";
  return fmt::format("{}found {}, wanted the number of a fault (list shows them)", kError, number);
}

Result<std::string> send_fault_command(const std::filesystem::path& path,
                                       const std::string& command) {
  const auto address = address_of(path);
  if (!address) return tl::unexpected(address.error());
  const FileDescriptor descriptor(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const sa_family_t any_name = AF_UNIX;  // the kernel chooses a name for the answer
  const auto failure = [&path](std::string_view what) {
    return fail("{}: found no running drive with this simulation.fault_socket ({}), wanted one",
                path.string(), what);
  };
  if (descriptor.get() < 0 ||
      bind(descriptor.get(), reinterpret_cast<const sockaddr*>(&any_name), sizeof any_name) != 0 ||
      sendto(descriptor.get(), command.data(), command.size(), 0, as_generic(*address),
             sizeof *address) < 0) {
    return failure(std::strerror(errno));
  }
  pollfd readable{descriptor.get(), POLLIN, 0};
  if (poll(&readable, 1, kPatience_ms) != 1) return failure("no answer");
  Buffer buffer;
  const ssize_t size = recv(descriptor.get(), buffer.data(), buffer.size(), 0);
  if (size < 0) return failure(std::strerror(errno));
  const std::string answer(buffer.data(), static_cast<size_t>(size));
  if (answer.starts_with(kError)) return fail("{}", answer.substr(kError.size()));
  return answer;
}

}  // namespace bevloc::evaluation
