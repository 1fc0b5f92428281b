// One localization: six images and a rough pose in, the correction of that pose out.
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
#include "pipeline/localization/frozen_pictures.h"
#include "pipeline/map/map_index.h"
#include "pipeline/map/rasterizer.h"
#include "pipeline/network/network.h"
#include "pipeline/network/view_table.h"
#include "pipeline/preprocessing/image_remap.h"
#include "pipeline/solver/solver_factory.h"

namespace bevloc {

struct LocalizerOptions {
  SolverKind solver = SolverKind::kBandedRefined;
  /// Hypotheses while tracking: the prior is good.
  HypothesisGrid tracking;
  /// Hypotheses while acquiring: the prior is GNSS alone.
  HypothesisGrid acquiring{{6.0, 0.2}, {4.0, 0.2}, {radians(4.0), radians(0.2)}};
  NetworkOptions network;
};

/// What the cameras saw.
struct CameraImages {
  std::array<ImageView, kCameraCount> images;  ///< read where `present`
  CameraMask present;
  CameraMotions reference_from_exposure{};  ///< against the time of the prior
  bool driving = false;                     ///< then every picture is another one (FrozenPictures)
};

enum class SearchRange : uint8_t { kTracking, kAcquiring };

/// The paper's whole network with its solver (Fig. 2), for one rig and one map. Owns all buffers:
/// localize() allocates nothing once warm, whichever cameras there are and whenever they exposed.
/// Not thread safe. The map index must outlive it.
class Localizer {
 public:
  static Result<std::unique_ptr<Localizer>> create(const Rig& rig, const MapIndex& map,
                                                   const std::string& model_path,
                                                   const LocalizerOptions& options);

  /// `prior` is T0, the predicted map_from_vehicle at the reference time, for which the correction
  /// holds. Returns the cameras that were seen: one whose image is not of the calibration's size,
  /// or is a damaged JPEG, or is frozen, counts as missing.
  ///
  /// The view table is made anew when the set of cameras changes, or when a camera's motion differs
  /// by more than 1 cm or 0.02 degrees (1 cm at 30 m) from the one that the table was made for.
  CameraMask localize(const CameraImages& seen, const Se2& prior, SearchRange range,
                      SolverResult& result);

  /// The cameras whose latest readable image was frozen.
  CameraMask frozen() const { return frozen_; }

  /// The map as drawn in the latest localize(), kRasterSize bytes.
  std::span<const uint8_t> map_raster() const { return network_->raster_input(); }

  /// Whether it shows anything to match.
  bool map_nearby() const;

  /// The perceived mask of the latest localize(), [3, 400, 200] logits. Runs the head, which
  /// localize() does not.
  std::span<const float> perceived_mask();

  const HypothesisGrid& hypotheses(SearchRange range) const;
  const std::string& model_name() const { return network_->name(); }

 private:
  Localizer(const Rig& rig, const MapIndex& map, std::unique_ptr<Network> network,
            const LocalizerOptions& options);
  /// Fills the network's image input; returns the cameras whose images can be used.
  CameraMask take_in(const CameraImages& seen);
  void look_from(CameraMask present, const CameraMotions& reference_from_exposure);

  Rig network_rig_;
  LocalizerOptions options_;
  std::unique_ptr<Network> network_;
  std::vector<ImagePreprocessor> preprocessors_;
  FrozenPictures frozen_pictures_;
  CameraMask frozen_;
  MapRasterizer rasterizer_;
  std::array<std::unique_ptr<Solver>, 2> solvers_;  ///< by SearchRange
  ViewTable view_table_;                            ///< for the two below
  std::optional<CameraMask> table_cameras_;
  CameraMotions table_motions_{};
};

}  // namespace bevloc
