// Localizer: computes the correction of a prior pose from the images of the six cameras and the
// map.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/image_view.h"
#include "common/result.h"
#include "common/se2.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/localization/frozen_camera_detector.h"
#include "pipeline/localization/view_monitor.h"
#include "pipeline/map/map_index.h"
#include "pipeline/map/rasterizer.h"
#include "pipeline/network/network.h"
#include "pipeline/network/test_frame.h"
#include "pipeline/network/view/view_table.h"
#include "pipeline/online_calibration/online_calibration.h"
#include "pipeline/preprocessing/image_remap.h"
#include "pipeline/solver/solver_factory.h"

namespace bevloc {

struct LocalizerOptions {
  SolverKind solver = SolverKind::kBandedRefined;
  /// Hypotheses for SearchRange::kTracking, where the prior comes from the tracker.
  HypothesisGrid tracking;
  /// Hypotheses for SearchRange::kAcquiring, where the prior comes from GNSS and odometry alone.
  HypothesisGrid acquiring{{4.0, 0.2}, {3.0, 0.2}, {radians(4.0), radians(0.2)}};
  NetworkOptions network;
  OnlineCalibrationOptions online_calibration;
};

/// The images of one frameset.
struct CameraImages {
  std::array<ImageView, kCameraCount> images;  ///< only those in `present` are read
  CameraMask present;
  /// The vehicle's pose at each exposure, in the vehicle frame at the time of the prior.
  CameraMotions reference_from_exposure{};
  /// If true, a camera that repeats its image counts as frozen, and one with parts that do not
  /// move as dirty.
  bool driving = false;
  // The online calibration needs these:
  Time time{};                         ///< time of the frameset
  std::optional<DrivenStep> driven{};  ///< motion until `time` from odometry, if known
};

enum class SearchRange : uint8_t { kTracking, kAcquiring };

/// The network and its solvers for one rig and one map (paper, Fig. 2). Owns all buffers: after a
/// warm-up localize() allocates nothing, for any set of cameras and exposure times. One thread. The
/// map index must outlive it.
class Localizer {
 public:
  /// Fails if the model cannot be loaded, its stored answer is damaged, the rig differs too much
  /// from that of the training (check_rig_fits()), or the solver does not support the hypotheses.
  static Result<std::unique_ptr<Localizer>> create(const Rig& rig, const MapIndex& map,
                                                   const std::string& model_path,
                                                   const LocalizerOptions& options);

  /// `prior` is T0, the predicted map_from_vehicle at the reference time; `result` corrects it.
  /// Returns the cameras that were used. A camera counts as missing if the size of its image
  /// differs from the calibration, if its JPEG is damaged, if it is frozen, if its view is dark,
  /// blinded or dirty, or if the online calibration leaves it out (OnlineCalibration::left_out()).
  ///
  /// Computes the view table again when the set of cameras changes, or when a camera's motion
  /// differs by more than 1 cm or 0.02 degrees (1 cm at 30 m) from the one that the table was
  /// computed for.
  CameraMask localize(const CameraImages& images, const Se2& prior, SearchRange range,
                      SolverResult& result);

  /// Checks that network and solvers still compute what they should: the network's answer to a test
  /// frame is the one that its model stores, and the solvers find a known correction. Takes as long
  /// as a few matches. Fails with the reason. map_raster(), map_nearby() and perceived_mask() show
  /// the test frame until the next localize().
  Status check();

  /// Whether the model stores an answer to the test frame. Without one, check() cannot judge the
  /// network.
  bool model_has_answer() const { return stored_answer_.has_value(); }

  /// The cameras whose image could be read in the latest localize().
  CameraMask readable() const { return readable_; }

  /// Why the camera's image could not be read, at the latest localize() where it was present and
  /// not readable().
  const std::string& read_error(int camera) const { return read_errors_[camera]; }

  /// The cameras that were frozen at their latest readable image, without those that are dark or
  /// blinded.
  CameraMask frozen() const { return frozen_; }

  /// The cameras whose view has this fault at their latest readable image.
  CameraMask with(ViewFault fault) const { return view_monitor_.with(fault); }

  /// Starts the online calibration, which must be switched on, with what an earlier drive learned.
  /// Fails as OnlineCalibration::restore() does.
  Status restore_calibration(const ExtrinsicErrors& errors, const ExtrinsicCovariance& covariance);

  /// What was learned about the calibration; null if the online calibration is switched off.
  const OnlineCalibration* online_calibration() const {
    return online_calibration_ ? &*online_calibration_ : nullptr;
  }

  /// The raster of the latest localize(), kRasterSize bytes.
  std::span<const uint8_t> map_raster() const { return network_->raster_input(); }

  /// Whether that raster contains any part of the map.
  bool map_nearby() const;

  /// The mask of the latest localize() as logits, [3, 400, 200]. Runs the mask branch, which
  /// localize() does not.
  std::span<const float> perceived_mask();

  const HypothesisGrid& hypotheses(SearchRange range) const;
  const std::string& model_name() const { return network_->name(); }

 private:
  Localizer(const Rig& rig, const MapIndex& map, std::unique_ptr<Network> network,
            const LocalizerOptions& options);
  /// Fills the image input of the network, black for unusable cameras. Returns the usable cameras.
  CameraMask load_images(const CameraImages& images);
  /// Checks the solver of a range with the map features of the test frame.
  Status check_solver(SearchRange range);
  /// Updates the view table for the cameras and motions.
  void update_view(CameraMask present, const CameraMotions& reference_from_exposure);
  /// Learns the errors of the calibration, and applies them from the next frameset on.
  void learn(const CameraImages& images, CameraMask usable, SearchRange range, const Se2& prior,
             const SolverResult& result);
  void apply_learned();

  Rig calibrated_rig_;  ///< the network rig of the calibration
  Rig network_rig_;     ///< the same with the learned errors
  LocalizerOptions options_;
  std::unique_ptr<Network> network_;
  std::optional<NetworkAnswer> stored_answer_;
  std::vector<float> shifted_;  ///< map features of the test frame, moved by a known correction
  SolverResult check_solution_;
  std::vector<ImagePreprocessor> preprocessors_;
  FrozenCameraDetector frozen_detector_;
  CameraMask readable_;
  std::array<std::string, kCameraCount> read_errors_;
  CameraMask frozen_;
  ViewMonitor view_monitor_;
  MapRasterizer rasterizer_;
  std::array<std::unique_ptr<Solver>, 2> solvers_;  ///< solvers by SearchRange
  ViewTable view_table_;                            ///< computed for the next two members
  std::optional<CameraMask> table_cameras_;
  CameraMotions table_motions_{};
  std::optional<OnlineCalibration> online_calibration_;
};

}  // namespace bevloc
