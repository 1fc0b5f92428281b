// Sets, lists and clears the faults of a running simulated drive over a local socket.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/file_descriptor.h"
#include "common/result.h"
#include "firmware/config/config.h"
#include "sim/faults/fault_board.h"

namespace bevloc::evaluation {

/// What the server has to know of the drive in order to refuse faults that it cannot show.
struct DriveWithSocket {
  double length_s = 0.0;  ///< of the planned drive; suspensions beyond its end are refused
  bool lockstep = false;  ///< it has one thread, so faults that let a thread hang are refused
  firmware::CanConfig can{};
};

/// A unix datagram socket. Each datagram is one command, and its answer one datagram: `set FAULT`
/// (fault_text.h), `list`, `clear` or `clear NUMBER`. An answer begins with "error: " if the
/// command was refused. One thread.
class FaultServer {
 public:
  /// Fails if the socket cannot be made. A socket that an earlier run left is replaced.
  static Result<std::unique_ptr<FaultServer>> open(const std::filesystem::path& path,
                                                   std::shared_ptr<sim::FaultBoard> faults,
                                                   DriveWithSocket drive);
  ~FaultServer();

  /// Answers all waiting commands, without waiting for more. Faults begin at `now_s` of the drive.
  void step(double now_s);

 private:
  FaultServer(FileDescriptor descriptor, std::filesystem::path path,
              std::shared_ptr<sim::FaultBoard> faults, DriveWithSocket drive);
  std::string answer(const std::string& command, double now_s);
  std::string set(const std::string& text, double now_s);
  Status check(const sim::Fault& fault, double now_s) const;
  std::string clear(const std::string& number, double now_s);

  const FileDescriptor descriptor_;
  const std::filesystem::path path_;
  const std::shared_ptr<sim::FaultBoard> faults_;
  const DriveWithSocket drive_;
};

/// Sends one command to the server at `path` and returns its answer. Fails if nobody answers within
/// two seconds, or if the command was refused.
Result<std::string> send_fault_command(const std::filesystem::path& path,
                                       const std::string& command);

}  // namespace bevloc::evaluation
