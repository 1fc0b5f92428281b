// usb_cameras: six emulated USB cameras for a QEMU guest, which show the images of a drive.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <list>

#include <CLI/CLI.hpp>
#include <poll.h>

#include "tests/hil/usb_cameras/camera_bench.h"
#include "tests/hil/usb_cameras/line_channel.h"

namespace {

using namespace bevloc;
using namespace bevloc::hil;

constexpr int kReconnectPeriod_ms = 100;

std::atomic<bool> g_stop_requested{false};

/// Polls the connections to QEMU and the control channels, and serves those that are ready.
class Loop {
 public:
  Loop(CameraBench& bench, int listener) : bench_(bench), listener_(listener) {}

  void run() {
    while (!g_stop_requested) {
      bench_.connect_plugged();
      wait();
      serve_cameras();
      serve_channels();
    }
  }

 private:
  void wait() {
    polled_ = {{listener_, POLLIN, 0}};
    for (UvcCamera& camera : bench_.cameras()) {
      if (!camera.link()) continue;
      const bool writes = camera.link()->has_data_to_write();
      polled_.push_back(
          {camera.link()->fd(), static_cast<short>(writes ? POLLIN | POLLOUT : POLLIN), 0});
    }
    for (const LineChannel& channel : channels_) polled_.push_back({channel.fd(), POLLIN, 0});
    poll(polled_.data(), polled_.size(), kReconnectPeriod_ms);
  }

  void serve_cameras() {
    for (UvcCamera& camera : bench_.cameras()) {
      UsbLink* link = camera.link();
      if (!link) continue;
      // A connection that QEMU has closed counts as unplugged.
      const bool alive = !is_ready(link->fd()) || link->read();
      if (!alive || (link->has_data_to_write() && !link->write())) camera.unplug();
    }
  }

  void serve_channels() {
    if (is_ready(listener_)) {
      const int fd = accept_connection(listener_);
      if (fd >= 0) channels_.emplace_back(fd);
    }
    std::erase_if(channels_, [this](LineChannel& channel) {
      return is_ready(channel.fd()) &&
             !channel.serve([this](std::string_view line) { return bench_.command(line); });
    });
    // Send what the commands have queued before the next wait.
    for (UvcCamera& camera : bench_.cameras()) {
      if (camera.link() && camera.link()->has_data_to_write() && !camera.link()->write()) {
        camera.unplug();
      }
    }
  }

  bool is_ready(int fd) const {
    for (const pollfd& entry : polled_) {
      if (entry.fd == fd) return (entry.revents & (POLLIN | POLLHUP | POLLERR)) != 0;
    }
    return false;
  }

  CameraBench& bench_;
  int listener_;
  std::list<LineChannel> channels_;
  std::vector<pollfd> polled_;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Six emulated USB cameras for a QEMU guest, which show the images of a drive");
  std::string pictures;
  std::string sockets;
  std::string control;
  app.add_option("--pictures", pictures, "Folder made by drive_pictures")->required();
  app.add_option("--sockets", sockets, "Prefix of QEMU's sockets, followed by 0 to 5")->required();
  app.add_option("--control", control, "Socket to create for commands (camera_bench.h)")
      ->required();
  CLI11_PARSE(app, argc, argv);
  const auto stop = [](int) { g_stop_requested = true; };
  std::signal(SIGTERM, stop);
  std::signal(SIGINT, stop);

  auto bench = CameraBench::create(pictures, sockets);
  if (!bench) {
    std::fprintf(stderr, "usb_cameras: %s\n", bench.error().message.c_str());
    return 2;
  }
  const int listener = listen_unix(control);
  if (listener < 0) {
    std::fprintf(stderr, "usb_cameras: %s: cannot listen, wanted a writable folder\n",
                 control.c_str());
    return 2;
  }
  Loop(*bench, listener).run();
  std::printf("%s\n", bench->counts_json().c_str());
  return 0;
}
