#include "pipeline/localization/localizer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "pipeline/preprocessing/network_camera.h"
#include "pipeline/solver/posterior.h"

namespace bevloc {
namespace {

// The view table is reused while each motion stays this close to the one that it was computed for.
constexpr double kSameMotion_m = 0.01;
constexpr double kSameMotion_rad = radians(0.02);

/// Largest error of the solvers on the test frame, where the known correction is a hypothesis.
constexpr double kSolverTolerance_m = 0.2;
constexpr double kSolverTolerance_rad = radians(0.5);

bool is_same(const Se2& a, const Se2& b) {
  return (a.translation() - b.translation()).norm() <= kSameMotion_m &&
         std::abs(wrap_angle(a.yaw_rad - b.yaw_rad)) <= kSameMotion_rad;
}

/// An axis whose hypotheses reach no farther than this has a narrow range.
constexpr double kNarrowRange_cells = 1.3;

/// By how many cells the test frame is moved along an axis: by about one step, because a shorter
/// movement cannot be told from none. Along an axis with a narrow range it is not moved.
int cells_to_move(const HypothesisAxis& axis, double cell_m) {
  if (axis.farthest() <= kNarrowRange_cells * cell_m) return 0;
  return std::max(1, static_cast<int>(std::lround(axis.step / cell_m)));
}

/// The distance from the correction to the nearest hypothesis, by which a solver may miss it.
double distance_to_hypotheses(const HypothesisGrid& hypotheses, const Eigen::Vector2d& correction) {
  return std::hypot(std::remainder(correction.x(), hypotheses.x_m.step),
                    std::remainder(correction.y(), hypotheses.y_m.step));
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
  if (!loaded.stored_answer().empty()) {
    const auto answer = answer_from(loaded.stored_answer());
    if (!answer) return fail("{}: {}", model_path, answer.error().message);
    localizer->stored_answer_ = *answer;
  }
  localizer->shifted_.resize(loaded.map_features().data.size());
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
    : calibrated_rig_(network_rig(rig)),
      network_rig_(calibrated_rig_),
      options_(options),
      network_(std::move(network)),
      rasterizer_(map) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    preprocessors_.emplace_back(rig.cameras[camera]);
    view_monitor_.set_shown(camera, preprocessors_.back().shown_pixels());
  }
  if (options.online_calibration.enabled) {
    online_calibration_.emplace(calibrated_rig_, kFeatureGrid, options.online_calibration);
  }
}

CameraMask Localizer::localize(const CameraImages& images, const Se2& prior, SearchRange range,
                               SolverResult& result) {
  const CameraMask usable = load_images(images);
  update_view(usable, images.reference_from_exposure);
  network_->run_image_branch();
  rasterizer_.draw(prior, network_->raster_input());
  if (map_nearby()) {
    network_->run_map_branch();
    solvers_[static_cast<size_t>(range)]->solve(network_->bev_features(), network_->map_features(),
                                                result);
  } else {
    // The features of an empty map are not constant: those near the border of the raster differ.
    set_no_evidence(hypotheses(range), result);
  }
  if (online_calibration_) learn(images, usable, range, prior, result);
  return usable;
}

void Localizer::learn(const CameraImages& images, CameraMask usable, SearchRange range,
                      const Se2& prior, const SolverResult& result) {
  const Solver& solver = *solvers_[static_cast<size_t>(range)];
  const bool changed = online_calibration_->observe({.cells = {.moved = solver.moved_cells(),
                                                               .map = solver.map_cells(),
                                                               .view = view_table_,
                                                               .rig = network_rig_,
                                                               .correction = result.correction},
                                                     .match = result,
                                                     .cameras = usable,
                                                     .time = images.time,
                                                     .tracking = range == SearchRange::kTracking,
                                                     .driving = images.driving,
                                                     .map_from_vehicle = prior * result.correction,
                                                     .driven = images.driven});
  if (changed) apply_learned();
}

Status Localizer::restore_calibration(const ExtrinsicErrors& errors,
                                      const ExtrinsicCovariance& covariance) {
  assert(online_calibration_);
  const Status restored = online_calibration_->restore(errors, covariance);
  if (restored) apply_learned();
  return restored;
}

void Localizer::apply_learned() {
  network_rig_ = calibrated_rig_;
  apply_errors(online_calibration_->used_errors(), network_rig_);
  table_cameras_.reset();
}

CameraMask Localizer::load_images(const CameraImages& images) {
  const auto planes_of = [input = network_->image_input()](int camera) {
    return input.subspan(camera * kNetworkImageSize, kNetworkImageSize);
  };
  std::array<bool, kCameraCount> readable{};  // written by several threads
  network_->parallel_for(kCameraCount, [&](int camera) {
    if (!images.present[camera]) return;
    Status read = preprocessors_[camera].run(images.images[camera], planes_of(camera));
    readable[camera] = read.has_value();
    if (!read) read_errors_[camera] = std::move(read.error().message);
  });
  for (int camera = 0; camera < kCameraCount; ++camera) {
    readable_[camera] = readable[camera];
    if (!readable[camera]) continue;
    frozen_[camera] = frozen_detector_.is_frozen(camera, planes_of(camera), images.driving);
    view_monitor_.add(camera, planes_of(camera), images.driving);
  }
  view_monitor_.judge();
  // Images without light are all equal, so that their repetition says nothing.
  frozen_ &= ~(with(ViewFault::kDark) | with(ViewFault::kBlinded));
  const CameraMask left_out = online_calibration_ ? online_calibration_->left_out() : CameraMask();
  CameraMask usable;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    usable[camera] = readable[camera] && !frozen_[camera] && !left_out[camera] &&
                     view_monitor_.fault(camera) == ViewFault::kNone;
    if (!usable[camera]) std::ranges::fill(planes_of(camera), kNetworkBlack);
  }
  return usable;
}

Status Localizer::check() {
  const NetworkAnswer answer = answer_to_test_frame(*network_);
  if (table_cameras_) network_->set_view_table(view_table_);  // the test frame has one of its own
  if (stored_answer_) {
    if (Status status = check_answer(answer, *stored_answer_); !status) return status;
  }
  if (Status status = check_solver(SearchRange::kTracking); !status) return status;
  return check_solver(SearchRange::kAcquiring);
}

Status Localizer::check_solver(SearchRange range) {
  const FeatureView map = network_->map_features();
  const BevGrid& grid = map.grid;
  // The features of the map as seen from some cells further ahead and to the left.
  const HypothesisGrid& searched = hypotheses(range);
  const int rows = cells_to_move(searched.x_m, grid.cell_m);
  const int cols = cells_to_move(searched.y_m, grid.cell_m);
  for (int channel = 0; channel < map.channels; ++channel) {
    for (int row = 0; row < grid.rows; ++row) {
      const int to = (channel * grid.rows + row) * grid.cols;
      const int from = (channel * grid.rows + std::max(row - rows, 0)) * grid.cols;
      for (int col = 0; col < grid.cols; ++col) {
        shifted_[to + col] = map.data[from + std::max(col - cols, 0)];
      }
    }
  }
  solvers_[static_cast<size_t>(range)]->solve({shifted_, map.channels, grid}, map, check_solution_);
  const Eigen::Vector2d wanted(rows * grid.cell_m, cols * grid.cell_m);
  const double tolerance_m = kSolverTolerance_m + distance_to_hypotheses(searched, wanted);
  const Se2& found = check_solution_.correction;
  if (check_solution_.evidence == Evidence::kGood &&
      (found.translation() - wanted).norm() <= tolerance_m &&
      std::abs(found.yaw_rad) <= kSolverTolerance_rad) {
    return {};
  }
  return fail(
      "solver: found a correction of {:.2f} m, {:.2f} m, {:.2f} degrees for the test frame, wanted "
      "{:.2f} m, {:.2f} m, 0 degrees: memory, processor or model file is damaged; replace the "
      "model file, and the computer if it happens again",
      found.x_m, found.y_m, degrees(found.yaw_rad), wanted.x(), wanted.y());
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
