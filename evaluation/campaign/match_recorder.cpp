#include "evaluation/campaign/match_recorder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "drivers/mock/mock_scene.h"
#include "drivers/mock/true_rig.h"
#include "evaluation/drive/configured_world.h"
#include "evaluation/drive/drive_street.h"
#include "firmware/config/localizer_options.h"
#include "firmware/runtime/appliance.h"
#include "sim/random.h"

namespace bevloc::evaluation {
namespace {

constexpr double kFramePeriod_s = 0.1;
/// How far off a tracked pose may be, one sigma.
constexpr Se2 kTrackedSigma{0.25, 0.10, radians(0.2)};
/// In search ranges: where "near the border" begins, and how far from the prior the truth may lie.
constexpr double kNearBorder = 0.6;
constexpr double kFarTracking = 3.5;
constexpr double kFarAcquiring = 2.0;
/// The truth lies within this share of the acquiring range from a prior that is not beyond it.
constexpr double kInsideAcquiring = 0.8;
/// Below this speed the curvature of the path means nothing.
constexpr double kRecordedDriving_mps = 1.0;

std::array<double, 3> reaches_of(const HypothesisGrid& grid) {
  return {grid.x_m.range, grid.y_m.range, grid.yaw_rad.range};
}

/// The true motion of one drive, and what its cameras see.
class RecordedDrive {
 public:
  RecordedDrive(const DriveConfig& config, const Rig& rig, sim::World world)
      : world_(std::make_shared<const sim::World>(std::move(world))),
        drive_(make_configured_drive(*world_, *config.simulation)),
        true_rig_(drivers::true_rig(rig, config.simulation->calibration_error,
                                    sim::seed_for(config.simulation->seed, "calibration"))),
        scene_(world_, drive_, config.simulation->conditions,
               sim::seed_for(config.simulation->seed, "pixel noise"), nullptr,
               street_of(config.simulation->street, config.simulation->seed)) {}

  const HdMap& map() const { return world_->map; }
  sim::Drive::State at(double time_s) const { return drive_->at(time_s); }

  /// The images at a time of the drive; valid until the next call.
  CameraImages images_at(double time_s) {
    CameraImages input;
    input.present.set();
    for (int camera = 0; camera < kCameraCount; ++camera) {
      scene_.draw(camera, true_rig_.cameras[camera], from_seconds(time_s), images_[camera]);
      input.images[camera] = ImageView(images_[camera].view());
    }
    return input;
  }

 private:
  std::shared_ptr<const sim::World> world_;
  std::shared_ptr<const sim::Drive> drive_;
  Rig true_rig_;
  drivers::MockScene scene_;
  std::array<RgbImage, kCameraCount> images_;
};

/// Chooses the priors and matches from them.
class MatchRecorder {
 public:
  MatchRecorder(const LocalizerOptions& options, Localizer& localizer, uint64_t seed)
      : options_(options), localizer_(localizer), random_(seed) {}

  void record(const CameraImages& images, const Se2& map_from_vehicle, MeasuredPlace& place) {
    images_ = &images;
    map_from_vehicle_ = map_from_vehicle;
    match(SearchRange::kTracking, tracked(), place);
    const int axis = place.frame % 3;
    match(SearchRange::kTracking, beyond(axis, options_.tracking, kFarTracking), place);
    if (place.frame % 2 == 0) match(SearchRange::kAcquiring, inside_acquiring(), place);
    if (place.frame % 4 == 1) {
      match(SearchRange::kAcquiring, beyond(axis, options_.acquiring, kFarAcquiring), place);
    }
  }

 private:
  Se2 tracked() {
    const auto within = [this](double sigma) {
      return std::clamp(random_.normal(0.0, sigma), -2.5 * sigma, 2.5 * sigma);
    };
    return {within(kTrackedSigma.x_m), within(kTrackedSigma.y_m), within(kTrackedSigma.yaw_rad)};
  }

  Se2 inside_acquiring() {
    const auto reach = reaches_of(options_.acquiring);
    const auto within = [this](double r) {
      return random_.uniform(-kInsideAcquiring * r, kInsideAcquiring * r);
    };
    return {within(reach[0]), within(reach[1]), within(reach[2])};
  }

  Se2 beyond(int axis, const HypothesisGrid& grid, double farthest) {
    const Se2 near = tracked();
    std::array<double, 3> values{near.x_m, near.y_m, near.yaw_rad};
    const double side = random_.chance(0.5) ? 1.0 : -1.0;
    values[axis] = side * reaches_of(grid)[axis] * random_.uniform(kNearBorder, farthest);
    return {values[0], values[1], values[2]};
  }

  void match(SearchRange range, const Se2& truth, MeasuredPlace& place) {
    localizer_.localize(*images_, map_from_vehicle_ * truth.inverse(), range, solution_);
    if (solution_.evidence != Evidence::kGood) return;
    MeasuredMatch match;
    match.range = range;
    match.truth = truth;
    match.found = solution_.correction;
    match.sigma = solution_.covariance.diagonal().cwiseSqrt();
    const Eigen::Matrix3d& covariance = solution_.covariance;
    match.correlation = {covariance(0, 1) / (match.sigma(0) * match.sigma(1)),
                         covariance(0, 2) / (match.sigma(0) * match.sigma(2)),
                         covariance(1, 2) / (match.sigma(1) * match.sigma(2))};
    match.rival_peak = solution_.rival_peak;
    match.edge_mass = solution_.edge_mass;
    match.score = solution_.score;
    match.axis_score = solution_.axis_score;
    place.matches.push_back(match);
  }

  const LocalizerOptions options_;
  Localizer& localizer_;
  sim::Random random_;
  const CameraImages* images_ = nullptr;
  Se2 map_from_vehicle_;
  SolverResult solution_;
};

}  // namespace

Result<std::vector<MeasuredPlace>> record_matches(const DriveConfig& config, const Rig& rig,
                                                  int drive,
                                                  const std::function<void(double)>& at_time_s) {
  if (!config.simulation->street.photos.empty()) {
    return fail(
        "{}: found simulation.street.photos, wanted none, because matches are measured with the "
        "simulator's own textures",
        config.file.string());
  }
  auto world = make_configured_world(config);
  if (!world) return tl::unexpected(world.error());
  RecordedDrive recorded(config, rig, std::move(*world));
  const MapIndex index(recorded.map());
  const LocalizerOptions options = firmware::localizer_options_of(config);
  auto localizer = Localizer::create(rig, index, config.model_file.string(), options);
  if (!localizer) return tl::unexpected(localizer.error());
  MatchRecorder recorder(options, **localizer,
                         sim::seed_for(config.simulation->seed, "recorded priors"));

  std::vector<MeasuredPlace> places;
  double station_m = 0.0;
  Se2 before = recorded.at(0.0).map_from_vehicle;
  const auto frames = static_cast<int>(config.simulation->duration_s / kFramePeriod_s);
  for (int frame = 0; frame < frames; ++frame) {
    const double time_s = frame * kFramePeriod_s;
    const sim::Drive::State state = recorded.at(time_s);
    station_m += (state.map_from_vehicle.translation() - before.translation()).norm();
    before = state.map_from_vehicle;
    MeasuredPlace place{.drive = drive, .frame = frame, .station_m = station_m, .matches = {}};
    if (state.speed_mps > kRecordedDriving_mps) {
      place.curvature_radpm = state.yaw_rate_radps / state.speed_mps;
    }
    recorder.record(recorded.images_at(time_s), state.map_from_vehicle, place);
    if (!place.matches.empty()) places.push_back(std::move(place));
    at_time_s(time_s);
  }
  return places;
}

}  // namespace bevloc::evaluation
