// Features of a made-up road as six cameras with wrong extrinsics see it.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/online_calibration/online_calibration.h"
#include "pipeline/preprocessing/network_camera.h"
#include "pipeline/solver/feature_warp.h"
#include "pipeline/solver/standardise.h"
#include "tests/support/cell_places.h"

namespace bevloc {

inline Rig demo_network_rig() {
  return network_rig(*read_rig(std::string(BEVLOC_SOURCE_DIR) + "/config/rig_demo.yaml"));
}

/// Errors of one camera. All other cameras have none.
inline ExtrinsicErrors error_of(int camera, int axis, double value) {
  ExtrinsicErrors errors = ExtrinsicErrors::Zero();
  errors(camera * kErrorsPerCamera + axis) = value;
  return errors;
}

/// A sum of waves of 6 to 12 m, different for each number.
class WavyRoad {
 public:
  explicit WavyRoad(int number) {
    for (int i = 0; i < static_cast<int>(waves_.size()); ++i) {
      const double angle_rad = 1.7 * number + 0.9 * i;
      const double length_m = 6.0 + (number * 5 + i * 3) % 7;
      waves_[i] = {
          2.0 * M_PI / length_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)),
          number + 2.0 * i};
    }
  }

  double at(const Eigen::Vector2d& point) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) sum += std::sin(wave.slope.dot(point) + wave.phase_rad);
    return sum;
  }

 private:
  struct Wave {
    Eigen::Vector2d slope;  ///< radians per metre
    double phase_rad;
  };
  std::array<Wave, 4> waves_;
};

/// Smooth map features, and BEV features that show them where cameras with errors put them.
class DemoCells {
 public:
  static constexpr int kChannels = 16;

  DemoCells()
      : rig_(demo_network_rig()),
        view_(make_view_table(rig_, CameraMask().set(), kFeatureGrid)),
        bev_(kFeatureGrid, kChannels, HypothesisGrid()),
        map_(kFeatureGrid, kChannels, HypothesisGrid()),
        moved_(static_cast<size_t>(kFeatureGrid.cells()) * map_.lanes()) {
    std::vector<float> map;
    for (int channel = 0; channel < kChannels; ++channel) {
      roads_.emplace_back(channel);
      other_roads_.emplace_back(channel + 100);
      for (int cell = 0; cell < kFeatureGrid.cells(); ++cell) {
        map.push_back(static_cast<float>(roads_[channel].at(test::place_of(kFeatureGrid, cell))));
      }
    }
    map_.assign(map);
    standardise(map_);
    show(ExtrinsicErrors::Zero());
  }

  const Rig& rig() const { return rig_; }

  /// Sees the map with true extrinsics that differ from the rig's by `errors`. Features fade to
  /// half at 20 m, as those of a network do. The cells of the cameras in `blind` show another road.
  void show(const ExtrinsicErrors& errors, CameraMask blind = {}) {
    std::vector<float> bev(kChannels * static_cast<size_t>(kFeatureGrid.cells()));
    for (int cell = 0; cell < kFeatureGrid.cells(); ++cell) {
      const Eigen::Vector2d point = test::place_of(kFeatureGrid, cell);
      Eigen::Vector2d shown = point;
      bool other_road = false;
      for (size_t slot = 0; slot < kViewSlots; ++slot) {
        const size_t entry = slot * static_cast<size_t>(kFeatureGrid.cells()) + cell;
        const int camera = view_.index[entry] / kImageFeatureCells;
        if (view_.weight[entry] <= 0.0F) continue;
        shown += static_cast<double>(view_.weight[entry]) *
                 (ground_shift(rig_.cameras[camera].vehicle_from_camera, point.x(), point.y()) *
                  errors.segment<kErrorsPerCamera>(camera * kErrorsPerCamera));
        other_road |= blind[camera];
      }
      const double fade = 1.0 / (1.0 + point.squaredNorm() / 400.0);
      for (int channel = 0; channel < kChannels; ++channel) {
        const size_t i = static_cast<size_t>(channel) * kFeatureGrid.cells() + cell;
        const WavyRoad& road = (other_road ? other_roads_ : roads_)[channel];
        bev[i] = static_cast<float>(fade * road.at(shown));
      }
    }
    bev_.assign(bev);
    standardise(bev_);
    warp();
  }

  /// All features of the images are 0.
  void show_nothing() {
    bev_.assign(std::vector<float>(kChannels * static_cast<size_t>(kFeatureGrid.cells())));
    warp();
  }

  MatchedCells match() const { return {moved_, map_, view_, rig_, Se2()}; }

 private:
  void warp() { warp_all(bev_, Se2(), moved_.data(), kFeatureGrid.cols * bev_.lanes()); }

  Rig rig_;
  ViewTable view_;
  CellFeatures bev_;
  CellFeatures map_;
  LaneBuffer moved_;
  std::vector<WavyRoad> roads_;  ///< one for each channel
  std::vector<WavyRoad> other_roads_;
};

}  // namespace bevloc
