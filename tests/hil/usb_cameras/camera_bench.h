// The lab's six cameras with their faults, controlled by text commands.
#pragma once

#include <filesystem>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "tests/hil/usb_cameras/pictures.h"
#include "tests/hil/usb_cameras/uvc_camera.h"

namespace bevloc::hil {

enum class Fault : uint8_t {
  kNone,
  kFrozen,   ///< frames come on time but all show the same image
  kGarbage,  ///< noise, alternately as whole and half frames
  kSilent,   ///< plugged in and answering, but sending no frames
};

/// Cameras that expose together on command. One thread.
class CameraBench {
 public:
  /// Reads the images of the drive from `pictures`. QEMU listens for the cameras at the sockets
  /// PREFIX0, PREFIX1, and so on. Fails if a camera has no images.
  static Result<CameraBench> create(const std::filesystem::path& pictures,
                                    const std::string& socket_prefix);

  /// Executes one command:
  ///
  ///     expose K                     all cameras show image K of the drive
  ///     plug N | unplug N            connects or disconnects camera N (0 to 5, or `all`)
  ///     freeze N | garbage N | silence N    starts a fault of camera N
  ///     heal N                       ends the fault of camera N
  ///     counts                       answers with a line of JSON
  ///
  /// Returns "ok", JSON, or "error" with the reason; for `expose` an empty string.
  std::string command(std::string_view line);

  /// Connects every camera that is plugged in but not yet connected to QEMU.
  void connect_plugged();
  std::vector<UvcCamera>& cameras() { return cameras_; }
  std::string counts_json() const;

 private:
  struct Socket {
    std::string path;
    bool plugged = true;
  };

  CameraBench() = default;
  void expose(uint64_t index);
  void send(size_t camera, uint64_t index);
  Bytes noise(uint64_t index);
  bool apply(std::string_view verb, size_t camera);

  std::vector<UvcCamera> cameras_;
  std::vector<Pictures> pictures_;
  std::vector<Socket> sockets_;
  std::vector<Fault> faults_;
  std::vector<uint64_t> frozen_at_;
  uint64_t latest_ = 0;
  uint64_t exposed_ = 0;
  std::mt19937 random_{1};
};

}  // namespace bevloc::hil
