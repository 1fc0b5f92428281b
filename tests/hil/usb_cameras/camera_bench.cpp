#include "tests/hil/usb_cameras/camera_bench.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "pipeline/calibration/rig.h"

namespace bevloc::hil {
namespace {

/// A connected, non-blocking socket, or -1.
int connect_unix(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return -1;
  std::memcpy(address.sun_path, path.c_str(), path.size());
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return -1;
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    close(fd);
    return -1;
  }
  fcntl(fd, F_SETFL, O_NONBLOCK);
  return fd;
}

std::optional<uint64_t> number(std::string_view text) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

Result<CameraBench> CameraBench::create(const std::filesystem::path& pictures,
                                        const std::string& socket_prefix) {
  CameraBench bench;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const std::string name(kCameraNames[camera]);
    auto opened = Pictures::open(pictures, name);
    if (!opened) return tl::unexpected(opened.error());
    bench.pictures_.push_back(std::move(*opened));
    bench.cameras_.emplace_back(name);
    bench.sockets_.push_back({fmt::format("{}{}", socket_prefix, camera)});
    bench.faults_.push_back(Fault::kNone);
    bench.frozen_at_.push_back(0);
  }
  return bench;
}

void CameraBench::connect_plugged() {
  for (size_t camera = 0; camera < cameras_.size(); ++camera) {
    if (!sockets_[camera].plugged || cameras_[camera].link() != nullptr) continue;
    const int fd = connect_unix(sockets_[camera].path);
    if (fd >= 0) cameras_[camera].plug_in(fd);
  }
}

std::string CameraBench::command(std::string_view line) {
  const size_t space = line.find(' ');
  const std::string_view verb = line.substr(0, space);
  const std::string_view argument =
      space == std::string_view::npos ? std::string_view() : line.substr(space + 1);
  if (verb == "counts") return counts_json();
  const auto value = number(argument);
  if (verb == "expose" && value) {
    expose(*value);
    return {};
  }
  if (argument != "all" && (!value || *value >= cameras_.size())) {
    return fmt::format("error: found '{}', wanted a verb and a camera, 0 to {}", line,
                       cameras_.size() - 1);
  }
  const size_t first = value.value_or(0);
  const size_t last = value.value_or(cameras_.size() - 1);
  for (size_t camera = first; camera <= last; ++camera) {
    if (!apply(verb, camera)) {
      return fmt::format("error: found '{}', wanted a verb of camera_bench.h", verb);
    }
  }
  return "ok";
}

bool CameraBench::apply(std::string_view verb, size_t camera) {
  if (verb == "plug" || verb == "unplug") {
    sockets_[camera].plugged = verb == "plug";
    if (verb == "unplug") cameras_[camera].unplug();
    connect_plugged();
    return true;
  }
  frozen_at_[camera] = latest_;
  if (verb == "freeze") {
    faults_[camera] = Fault::kFrozen;
  } else if (verb == "garbage") {
    faults_[camera] = Fault::kGarbage;
  } else if (verb == "silence") {
    faults_[camera] = Fault::kSilent;
  } else if (verb == "heal") {
    faults_[camera] = Fault::kNone;
  } else {
    return false;
  }
  return true;
}

void CameraBench::expose(uint64_t index) {
  latest_ = index;
  ++exposed_;
  for (size_t camera = 0; camera < cameras_.size(); ++camera) send(camera, index);
}

void CameraBench::send(size_t camera, uint64_t index) {
  const Fault fault = faults_[camera];
  if (fault == Fault::kSilent) return;
  if (fault == Fault::kGarbage) {
    cameras_[camera].send(noise(index));
    return;
  }
  const uint64_t shown = fault == Fault::kFrozen ? frozen_at_[camera] : index;
  const auto image = pictures_[camera].read(shown, cameras_[camera].format());
  if (!image) {
    std::fprintf(stderr, "usb_cameras: %s\n", image.error().message.c_str());
    return;
  }
  cameras_[camera].send(*image);
}

Bytes CameraBench::noise(uint64_t index) {
  Bytes bytes(index % 2 == 0 ? kYuyvBytes : kYuyvBytes / 2);
  std::generate(bytes.begin(), bytes.end(), [this] { return static_cast<uint8_t>(random_()); });
  return bytes;
}

std::string CameraBench::counts_json() const {
  nlohmann::json json{{"exposed", exposed_}};
  for (const UvcCamera& camera : cameras_) {
    const FrameCounts& counts = camera.counts();
    json["cameras"][camera.name()] = {{"plugged", camera.link() != nullptr},
                                      {"sent", counts.sent},
                                      {"not_streaming", counts.not_streaming},
                                      {"skipped", counts.skipped},
                                      {"cut_off", counts.cut_off}};
  }
  return json.dump();
}

}  // namespace bevloc::hil
