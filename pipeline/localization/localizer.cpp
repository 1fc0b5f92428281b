#include "pipeline/localization/localizer.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "pipeline/preprocessing/network_camera.h"

namespace bevloc {
namespace {

// The view table is reused while each motion stays this close to the one that it was computed for.
constexpr double kSameMotion_m = 0.01;
constexpr double kSameMotion_rad = radians(0.02);

bool is_same(const Se2& a, const Se2& b) {
  return (a.translation() - b.translation()).norm() <= kSameMotion_m &&
         std::abs(wrap_angle(a.yaw_rad - b.yaw_rad)) <= kSameMotion_rad;
}

}  // namespace

Result<std::unique_ptr<Localizer>> Localizer::create(const Rig& rig, const MapIndex& map,
                                                     const std::string& model_path,
                                                     const LocalizerOptions& options) {
  auto network = Network::load(model_path, options.network);
  if (!network) return tl::unexpected(network.error());
  if (const Status fits = check_rig_fits((*network)->rig(), rig); !fits) {
    return fail("{}: {}", model_path, fits.error().message);
  }
  auto localizer =
      std::unique_ptr<Localizer>(new Localizer(rig, map, std::move(*network), options));
  const Network& loaded = *localizer->network_;
  for (const SearchRange range : {SearchRange::kTracking, SearchRange::kAcquiring}) {
    auto solver = make_solver(options.solver, kFeatureGrid, loaded.bev_features().channels,
                              localizer->hypotheses(range), loaded.solver_parameters());
    if (!solver) return tl::unexpected(solver.error());
    localizer->solvers_[static_cast<size_t>(range)] = std::move(*solver);
  }
  return localizer;
}

Localizer::Localizer(const Rig& rig, const MapIndex& map, std::unique_ptr<Network> network,
                     const LocalizerOptions& options)
    : network_rig_(network_rig(rig)),
      options_(options),
      network_(std::move(network)),
      rasterizer_(map) {
  for (const CameraModel& camera : rig.cameras) preprocessors_.emplace_back(camera);
}

CameraMask Localizer::localize(const CameraImages& images, const Se2& prior, SearchRange range,
                               SolverResult& result) {
  const CameraMask usable = load_images(images);
  update_view(usable, images.reference_from_exposure);
  network_->run_image_branch();
  rasterizer_.draw(prior, network_->raster_input());
  network_->run_map_branch();
  solvers_[static_cast<size_t>(range)]->solve(network_->bev_features(), network_->map_features(),
                                              result);
  return usable;
}

CameraMask Localizer::load_images(const CameraImages& images) {
  const auto planes_of = [input = network_->image_input()](int camera) {
    return input.subspan(camera * kNetworkImageSize, kNetworkImageSize);
  };
  std::array<bool, kCameraCount> readable{};
  network_->parallel_for(kCameraCount, [&](int camera) {
    readable[camera] =
        images.present[camera] &&
        preprocessors_[camera].run(images.images[camera], planes_of(camera)).has_value();
  });
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (!readable[camera]) continue;
    frozen_[camera] = frozen_detector_.is_frozen(camera, planes_of(camera), images.driving);
    view_monitor_.add(camera, planes_of(camera), images.driving);
  }
  view_monitor_.judge();
  CameraMask usable;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    usable[camera] =
        readable[camera] && !frozen_[camera] && view_monitor_.fault(camera) == ViewFault::kNone;
    if (!usable[camera]) std::ranges::fill(planes_of(camera), kNetworkBlack);
  }
  return usable;
}

void Localizer::update_view(CameraMask present, const CameraMotions& reference_from_exposure) {
  if (table_cameras_ == present &&
      std::ranges::equal(table_motions_, reference_from_exposure, is_same)) {
    return;
  }
  update_view_table(network_rig_, present, kFeatureGrid, reference_from_exposure, view_table_);
  network_->set_view_table(view_table_);
  table_cameras_ = present;
  table_motions_ = reference_from_exposure;
}

bool Localizer::map_nearby() const {
  const std::span<const uint8_t> raster = map_raster();
  return std::any_of(raster.begin(), raster.end(), [](uint8_t cell) { return cell != 0; });
}

std::span<const float> Localizer::perceived_mask() {
  network_->run_mask_head();
  return network_->mask_logits();
}

const HypothesisGrid& Localizer::hypotheses(SearchRange range) const {
  return range == SearchRange::kTracking ? options_.tracking : options_.acquiring;
}

}  // namespace bevloc
