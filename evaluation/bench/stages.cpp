#include "evaluation/bench/stages.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <map>
#include <optional>

#include "can/bus/mock_bus.h"
#include "can/publisher/pose_publisher.h"
#include "drivers/frameset/synchronizer.h"
#include "evaluation/bench/camera_formats.h"
#include "evaluation/bench/stage_work.h"
#include "evaluation/bench/standing_vehicle.h"
#include "firmware/runtime/appliance.h"
#include "pipeline/map/rasterizer.h"
#include "pipeline/preprocessing/image_remap.h"
#include "pipeline/preprocessing/mjpeg_decoder.h"

namespace bevloc::bench {

struct Stages::Parts {
  Parts(const firmware::Config& config_given, const Scene& scene_given, const MapIndex& index_given,
        std::unique_ptr<Network> loaded);

  void take_images(PixelFormat format);
  void take_frameset();
  void draw_map() { rasterizer.draw(prior, network->raster_input()); }
  void crop_map();
  void look_at_raster();
  void make_table();
  void decode();
  void solve(SearchRange range);
  void track();
  void publish();

  void feed_until(Time time);

  const firmware::Config& config;
  const Scene& scene;
  const MapIndex& index;
  Rig network_cameras;
  std::unique_ptr<Network> network;
  std::vector<ImagePreprocessor> preprocessors;
  std::vector<MjpegDecoder> decoders;
  MapRasterizer rasterizer;
  std::array<std::unique_ptr<Solver>, 2> solvers;  ///< by SearchRange
  std::map<PixelFormat, ConvertedImages> converted;
  ViewTable table;
  std::vector<MapIndex::Segment> found;
  firmware::FrameQueue frames{firmware::StageQueues::kFrames};
  std::optional<drivers::FramesetSynchronizer> synchronizer;
  std::optional<Tracker> tracker;
  can::MockWire wire;
  std::unique_ptr<can::Bus> bus = wire.connect();
  can::PosePublisher publisher;

  const FramesetImages* images = nullptr;
  StandingVehicle vehicle;
  Time now;
  Time exposure;
  Se2 prior;
  std::array<SolverResult, 2> solutions;  ///< by SearchRange
  const SolverResult& solution = solutions[0];
  bool map_nearby = false;
  std::optional<TrackedPose> pose;
};

Stages::Parts::Parts(const firmware::Config& config_given, const Scene& scene_given,
                     const MapIndex& index_given, std::unique_ptr<Network> loaded)
    : config(config_given),
      scene(scene_given),
      index(index_given),
      network_cameras(network_rig(scene.rig)),
      network(std::move(loaded)),
      rasterizer(index),
      publisher(*bus, firmware::publisher_config(config, scene.map)) {
  for (const CameraModel& camera : scene.rig.cameras) {
    preprocessors.emplace_back(camera);
    decoders.emplace_back(camera.intrinsics.width_px, camera.intrinsics.height_px);
  }
  make_table();
}

void Stages::Parts::take_images(PixelFormat format) {
  const std::span<int8_t> input = network->image_input();
  const ConvertedImages* const others =
      format == PixelFormat::kRgb24 ? nullptr : &converted.at(format);
  network->parallel_for(kCameraCount, [&](int camera) {
    const ImageView view =
        others != nullptr ? (*others)[camera].view : ImageView((*images)[camera].view());
    // This cannot fail, because the images have the rig's size.
    (void)preprocessors[camera].run(view,
                                    input.subspan(camera * kNetworkImageSize, kNetworkImageSize));
  });
}

void Stages::Parts::take_frameset() {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    drivers::Frame frame;
    frame.camera = camera;
    frame.time = exposure;
    frames.push(std::move(frame));
  }
  while (auto frame = frames.pop(Duration::zero())) synchronizer->add(std::move(*frame), now);
  while (synchronizer->poll(now)) {
  }
}

void Stages::Parts::crop_map() {
  const Surroundings around = surroundings_of(prior);
  index.query(around.min_corner, around.max_corner, found);
}

void Stages::Parts::look_at_raster() {
  const std::span<const uint8_t> raster = network->raster_input();
  map_nearby = std::ranges::any_of(raster, [](uint8_t cell) { return cell != 0; });
}

void Stages::Parts::make_table() {
  update_view_table(network_cameras, CameraMask().set(), kFeatureGrid, {}, table);
  network->set_view_table(table);
}

void Stages::Parts::decode() {
  const ConvertedImages& files = converted.at(PixelFormat::kMjpeg);
  for (size_t camera = 0; camera < files.size(); ++camera) {
    (void)decoders[camera].decode(files[camera].view);
  }
}

void Stages::Parts::solve(SearchRange range) {
  const auto which = static_cast<size_t>(range);
  solvers[which]->solve(network->bev_features(), network->map_features(), solutions[which]);
}

void Stages::Parts::track() {
  tracker->add_correction(exposure, prior, solution);
  pose = tracker->pose_at(now);
}

void Stages::Parts::publish() {
  can::PoseReport report;
  report.status.state = HealthState::kTracking;
  report.capture_time = exposure;
  report.pose_time = now;
  if (pose) {
    report.map_from_vehicle = pose->map_from_vehicle;
    report.covariance = pose->covariance;
    report.forward_speed_mps = pose->speed_mps;
    report.yaw_rate_radps = pose->yaw_rate_radps;
  }
  report.correction = solution.correction;
  publisher.publish(report, now);
}

void Stages::Parts::feed_until(Time time) {
  while (now < time) {
    now += kBusCycle;
    tracker->add_odometry(vehicle.odometry(now));
    if ((now - Time{}) % kFramePeriod == Duration::zero()) tracker->add_gnss(vehicle.gnss(now));
  }
}

Result<std::unique_ptr<Stages>> Stages::create(const firmware::Config& config, const Scene& scene,
                                               const MapIndex& index, int threads) {
  const std::string model = config.model_file.string();
  auto network = Network::load(model, {.threads = threads});
  if (!network) return tl::unexpected(network.error());
  const auto cost = network_cost(model);
  if (!cost) return tl::unexpected(cost.error());
  auto parts = std::make_unique<Parts>(config, scene, index, std::move(*network));
  for (const SearchRange range : {SearchRange::kTracking, SearchRange::kAcquiring}) {
    const bool tracking = range == SearchRange::kTracking;
    auto solver = make_solver(config.solver.kind, kFeatureGrid, kFeatureChannels,
                              tracking ? config.solver.tracking : config.solver.acquiring,
                              parts->network->solver_parameters());
    if (!solver) return tl::unexpected(solver.error());
    parts->solvers[static_cast<size_t>(range)] = std::move(*solver);
  }
  for (const PixelFormat format : kBenchFormats) {
    auto images = convert(scene.places[0].framesets[0], format);
    if (!images) return tl::unexpected(images.error());
    parts->converted.emplace(format, std::move(*images));
  }
  auto stages = std::unique_ptr<Stages>(new Stages(std::move(parts)));
  stages->add_stages_of_the_frame(*cost);
  stages->add_other_stages(*cost);
  assert(std::ranges::equal(stages->all(), kStageNames, {}, &Stage::name));
  return stages;
}

Stages::Stages(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Stages::~Stages() = default;

void Stages::add(std::string name, bool in_frame, const Work& work,
                 std::function<void(Parts&)> run) {
  stages_.push_back({std::move(name), in_frame, work,
                     [run = std::move(run), parts = parts_.get()] { run(*parts); }});
}

void Stages::add_stages_of_the_frame(const NetworkCost& cost) {
  const Scene& scene = parts_->scene;
  add("frameset", true, {}, &Parts::take_frameset);
  add("images-rgb24", true, image_path_work(scene.rig, PixelFormat::kRgb24),
      [](Parts& parts) { parts.take_images(PixelFormat::kRgb24); });
  add("network-images", true, network_work(cost.images),
      [](Parts& parts) { parts.network->run_image_branch(); });
  add("map-raster", true, map_raster_work(scene, parts_->index), &Parts::draw_map);
  add("network-map", true, network_work(cost.map),
      [](Parts& parts) { parts.network->run_map_branch(); });
  add("solver", true, solver_work(), [](Parts& parts) { parts.solve(SearchRange::kTracking); });
  add("map-check", true, {}, &Parts::look_at_raster);
  add("tracker", true, {}, &Parts::track);
  add("can", true, {}, &Parts::publish);
}

void Stages::add_other_stages(const NetworkCost& cost) {
  const Scene& scene = parts_->scene;
  const Work decoding = decode_work(scene.rig, parts_->converted.at(PixelFormat::kMjpeg));
  add("mjpeg-decode", false, decoding, &Parts::decode);
  for (const PixelFormat format : kBenchFormats) {
    Work work = image_path_work(scene.rig, format);
    if (format == PixelFormat::kMjpeg) work.bytes += decoding.bytes;
    add("images-" + std::string(to_string(format)), false, work,
        [format](Parts& parts) { parts.take_images(format); });
  }
  add("view-table", false, view_table_work(), &Parts::make_table);
  add("map-crop", false, map_crop_work(scene, parts_->index), &Parts::crop_map);
  add("network-mask", false, network_work(cost.mask),
      [](Parts& parts) { parts.network->run_mask_head(); });
  add("solver-acquiring", false, solver_work(),
      [](Parts& parts) { parts.solve(SearchRange::kAcquiring); });
}

void Stages::go_to(const Place& place) {
  Parts& parts = *parts_;
  parts.vehicle.map_from_vehicle = place.map_from_vehicle;
  parts.now = Time{};
  parts.tracker.emplace(parts.config.tracker);
  parts.synchronizer.emplace(parts.config.cameras.synchronizer);
  parts.feed_until(parts.now + kImageDelay);
}

void Stages::begin_frame(const FramesetImages& images) {
  Parts& parts = *parts_;
  parts.images = &images;
  parts.exposure = parts.now + (kFramePeriod - kImageDelay);
  parts.feed_until(parts.exposure);
  const auto predicted = parts.tracker->pose_at(parts.exposure);
  parts.prior = predicted ? predicted->map_from_vehicle : parts.vehicle.map_from_vehicle;
  parts.feed_until(parts.exposure + kImageDelay);
}

}  // namespace bevloc::bench
