#include "firmware/live/live_server.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "common/json_dump.h"
#include "common/kernel_time.h"
#include "firmware/live/event_queue.h"
#include "firmware/live/http_server.h"
#include "firmware/live/httplib_header.h"
#include "firmware/live/live_events.h"
#include "firmware/live/page_files.h"
#include "firmware/live/viewer_needs.h"
#include "firmware/status/metrics.h"
#include "firmware/threads/realtime.h"

namespace bevloc::firmware {
namespace {

constexpr Duration kDrawPeriod = std::chrono::milliseconds(40);
constexpr Duration kStatusPeriod = std::chrono::milliseconds(200);
/// A viewer that gets no event for this long gets a comment, so that a closed connection is
/// noticed.
constexpr Duration kEventSilence = std::chrono::seconds(1);
constexpr double kMapReach_m = 150.0;
constexpr double kTrailStep_m = 0.5;
constexpr size_t kTrailPoints = 2000;

/// The content type of a file of the page, from its name.
const char* type_of(std::string_view path) {
  if (path.ends_with(".html")) return "text/html; charset=utf-8";
  return path.ends_with(".css") ? "text/css; charset=utf-8" : "text/javascript; charset=utf-8";
}

}  // namespace

class LiveServer::Impl {
 public:
  explicit Impl(std::unique_ptr<HttpServer> http) : http_(std::move(http)) {
    add_routes();
    http_->start();
    drawing_ = std::jthread([this](const std::stop_token& stop) { draw_until(stop); });
  }

  ~Impl() {
    events_.close();
    drawing_.request_stop();
    wake_.notify_all();
    http_->stop();
  }

  void attach(Appliance& appliance, const Rig& rig) {
    const HypothesisGrid& acquiring = appliance.localizer().hypotheses(SearchRange::kAcquiring);
    const HypothesisGrid& tracking = appliance.localizer().hypotheses(SearchRange::kTracking);
    int most = 0;
    for (const HypothesisGrid* grid : {&acquiring, &tracking}) {
      most = std::max({most, grid->x_m.count(), grid->y_m.count(), grid->yaw_rad.count()});
    }
    auto feed = std::make_shared<LiveFeed>(rig, most);
    appliance.vision().observe([feed](const VisionSnapshot& snapshot) { feed->offer(snapshot); });
    const std::lock_guard lock(scene_mutex_);
    feed_ = std::move(feed);
    feed_->set_viewers(viewers_);
    rig_ = rig;
    map_ = &appliance.map_index();
    needs_.forget_place();
  }

  void detach() {
    const std::lock_guard lock(scene_mutex_);
    map_ = nullptr;
    feed_.reset();
  }

  void publish(const Telemetry& telemetry) {
    const std::lock_guard lock(telemetry_mutex_);
    telemetry_ = telemetry;
    published_ = std::chrono::steady_clock::now();
    const PoseSnapshot& pose = telemetry.snapshot.estimation.pose;
    if (!pose.known) {
      trail_interrupted_ = true;
      return;
    }
    const Eigen::Vector2d place = pose.map_from_vehicle.translation();
    if (!trail_.empty()) {
      const TrailPoint& last = trail_.back();
      if ((place - Eigen::Vector2d(last.x_m, last.y_m)).norm() < kTrailStep_m) return;
    }
    trail_.push_back({place.x(), place.y(), pose.valid, std::exchange(trail_interrupted_, false)});
    if (trail_.size() > kTrailPoints) trail_.pop_front();
  }

  int port() const { return http_->port(); }

 private:
  void add_routes();
  void stream_events(const httplib::Request& request, httplib::Response& response);
  /// Adds a viewer. Returns false and adds none if there are kViewers already.
  bool add_viewer();
  void remove_viewer();
  void tell_feed();

  /// The latest telemetry, and the time since it was published.
  std::pair<Telemetry, Duration> telemetry() const {
    const std::lock_guard lock(telemetry_mutex_);
    return {telemetry_, std::chrono::steady_clock::now() - published_};
  }

  void draw_until(const std::stop_token& stop);
  void draw();
  /// Sends trail and map to all viewers if one of them needs them.
  void send_scene(const MapIndex& map, const PoseSnapshot& pose);

  EventQueue events_;
  std::atomic<int> viewers_{0};
  ViewerNeeds needs_;

  mutable std::mutex telemetry_mutex_;  ///< guards the next four
  Telemetry telemetry_;
  std::chrono::steady_clock::time_point published_{};
  std::deque<TrailPoint> trail_;
  bool trail_interrupted_ = false;  ///< whether there was no pose since the last point

  /// Guards the next three, and needs_ except needs_.set(). draw() holds it.
  std::mutex scene_mutex_;
  std::shared_ptr<LiveFeed> feed_;
  Rig rig_;
  const MapIndex* map_ = nullptr;

  // Only the drawing thread uses the next two.
  PictureMaker pictures_;
  std::chrono::steady_clock::time_point status_due_{};

  std::mutex wake_mutex_;
  std::condition_variable wake_;
  std::unique_ptr<HttpServer> http_;
  std::jthread drawing_;
};

void LiveServer::Impl::add_routes() {
  http_->set_headers(
      {{"Content-Security-Policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
       {"X-Content-Type-Options", "nosniff"},
       {"Cross-Origin-Resource-Policy", "same-origin"},
       {"Referrer-Policy", "no-referrer"},
       {"Cache-Control", "no-store"}});
  for (const PageFile& file : page_files()) {
    const std::string path(file.path == "/page.html" ? "/" : file.path);
    http_->get(path, [file](const httplib::Request&, httplib::Response& response) {
      response.set_content(file.text.data(), file.text.size(), type_of(file.path));
    });
  }
  http_->get("/metrics", [this](const httplib::Request&, httplib::Response& response) {
    const auto [latest, age] = telemetry();
    response.set_content(metrics_text(latest, use_of_this_process(), age),
                         "text/plain; version=0.0.4; charset=utf-8");
  });
  http_->get("/status.json", [this](const httplib::Request&, httplib::Response& response) {
    const auto [latest, age] = telemetry();
    response.set_content(json_document(status_json(latest, use_of_this_process(), age)),
                         "application/json");
  });
  http_->get("/healthz", [this](const httplib::Request&, httplib::Response& response) {
    const auto [latest, age] = telemetry();
    const HealthCheck health = check_health(latest, age);
    response.status = health.good ? 200 : 503;
    response.set_content(health.reason + "\n", "text/plain; charset=utf-8");
  });
  http_->get("/events", [this](const httplib::Request& request, httplib::Response& response) {
    stream_events(request, response);
  });
}

bool LiveServer::Impl::add_viewer() {
  if (++viewers_ > kViewers) {
    --viewers_;
    return false;
  }
  tell_feed();
  return true;
}

void LiveServer::Impl::remove_viewer() {
  --viewers_;
  tell_feed();
}

void LiveServer::Impl::tell_feed() {
  const std::lock_guard lock(scene_mutex_);
  if (feed_) feed_->set_viewers(viewers_);
}

/// Answers /events. A browser does not tell a page why its request for events was refused. So the
/// page asks for the reason with HEAD.
void LiveServer::Impl::stream_events(const httplib::Request& request, httplib::Response& response) {
  const bool asks = request.method == "HEAD";
  if (asks && viewers_ < kViewers) return;
  if (asks || !add_viewer()) {
    response.status = 503;
    response.set_content(
        fmt::format("found {} viewers, which is the most that bevlocd serves: close one\n",
                    kViewers),
        "text/plain");
    return;
  }
  const uint64_t first = events_.end();
  {
    const std::lock_guard lock(wake_mutex_);
    needs_.set();
  }
  wake_.notify_all();
  const auto write = [this, next = first](size_t, httplib::DataSink& sink) mutable {
    const uint64_t wanted = next;
    const auto event = events_.wait_for(next, kEventSilence);
    if (next > wanted + 1) needs_.set();  // it has missed events
    if (events_.closed()) {
      sink.done();
      return true;
    }
    const std::string_view text = event ? std::string_view(*event) : std::string_view(": idle\n\n");
    return sink.write(text.data(), text.size());
  };
  response.set_chunked_content_provider("text/event-stream", write,
                                        [this](bool) { remove_viewer(); });
}

void LiveServer::Impl::draw_until(const std::stop_token& stop) {
  begin_low_thread("live-draw");
  while (!stop.stop_requested()) {
    {
      std::unique_lock lock(wake_mutex_);
      const auto wanted = [&] { return stop.stop_requested() || viewers_ > 0; };
      wake_.wait_for(lock, std::chrono::seconds(1), wanted);
    }
    if (viewers_ == 0 || stop.stop_requested()) continue;
    draw();
    std::this_thread::sleep_for(kDrawPeriod);
  }
}

void LiveServer::Impl::send_scene(const MapIndex& map, const PoseSnapshot& pose) {
  if (needs_.take_trail()) {
    std::deque<TrailPoint> trail;
    {
      const std::lock_guard lock(telemetry_mutex_);
      trail = trail_;
    }
    events_.push(trail_event(trail));
  }
  if (const auto centre_m = needs_.take_map(pose)) {
    events_.push(map_event(map, *centre_m, kMapReach_m));
  }
}

void LiveServer::Impl::draw() {
  const auto [latest, age] = telemetry();
  const auto time = std::chrono::steady_clock::now();
  const std::lock_guard lock(scene_mutex_);
  if (time >= status_due_) {
    status_due_ = time + kStatusPeriod;
    const Duration sent = read_clock(CLOCK_BOOTTIME);
    events_.push(status_event(latest, use_of_this_process(), age, sent));
    if (map_ != nullptr) send_scene(*map_, latest.snapshot.estimation.pose);
  }
  if (map_ == nullptr) return;
  feed_->take([this](const LiveSample& sample) {
    if (sample.has_image) {
      std::string event = camera_event(*map_, rig_, sample, pictures_);
      if (!event.empty()) events_.push(std::move(event));
    }
    if (sample.has_mask) events_.push(match_event(*map_, sample));
  });
}

Result<std::unique_ptr<LiveServer>> LiveServer::start(const LiveConfig& config) {
  auto http = HttpServer::open(config.address, config.port);
  if (!http) return tl::unexpected(http.error());
  std::unique_ptr<LiveServer> server(new LiveServer(std::make_unique<Impl>(std::move(*http))));
  spdlog::info("live page: http://{}/", authority_of(config));
  if (config.open_to_network) {
    spdlog::warn("live page: whoever reaches {} sees the cameras, because there is no password",
                 config.address);
  }
  return server;
}

LiveServer::LiveServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LiveServer::~LiveServer() = default;

void LiveServer::attach(Appliance& appliance, const Rig& rig) {
  impl_->attach(appliance, rig);
}

void LiveServer::detach() {
  impl_->detach();
}

void LiveServer::publish(const Telemetry& telemetry) {
  impl_->publish(telemetry);
}

int LiveServer::port() const {
  return impl_->port();
}

}  // namespace bevloc::firmware
