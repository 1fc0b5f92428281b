// The lab's cameras side by side, and what is wrong with each.
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
  kFrozen,   ///< frames come on time and show the same picture for ever
  kGarbage,  ///< noise: whole frames and half ones in turn
  kSilent,   ///< plugged in and answering, but no frame comes
};

/// Cameras that expose together when they are told to. One thread.
class CameraBench {
 public:
  /// Sockets are PREFIX0, PREFIX1, ...: QEMU's ends of the cables.
  static Result<CameraBench> create(const std::filesystem::path& pictures,
                                    const std::string& socket_prefix);

  /// One line of what the control channel may say:
  ///
  ///     expose K                     all cameras show picture K of the drive
  ///     plug N | unplug N            the cable of camera N, 0 to 5; `all` for every camera
  ///     freeze N | garbage N | silence N | heal N
  ///     counts                       answers with a line of JSON
  ///
  /// The answer: "ok", JSON, or "error" and why; nothing to `expose`.
  std::string command(std::string_view line);

  /// Cameras that are plugged in and wait for their cable to QEMU.
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
