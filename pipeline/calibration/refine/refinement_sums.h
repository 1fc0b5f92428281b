// The normal equations of a refinement.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "pipeline/calibration/refine/camera_adjustment.h"

namespace bevloc {

/// What differs between framesets: roll, pitch and yaw of the body against the reference pose, then
/// its place forward, left and up.
inline constexpr int kFrameUnknowns = 6;
inline constexpr int kYawError = 2;
inline constexpr int kForwardError = 3;
using FrameVector = Eigen::Matrix<double, kFrameUnknowns, 1>;
using FrameMatrix = Eigen::Matrix<double, kFrameUnknowns, kFrameUnknowns>;

/// One linearized equation: a residual in sigmas, and its derivative by the unknowns that it
/// depends on. These are at most four groups of the shared unknowns, and at most two framesets,
/// which are the same or follow each other.
class RefinementRow {
 public:
  static constexpr int kMostShared = 4;
  static constexpr int kMostFrames = 2;
  struct SharedPart {
    Eigen::Index first = 0;
    Eigen::Index size = 0;
    Eigen::Matrix<double, kCameraParameters, 1> slope;

    auto values() const { return slope.head(size); }
  };
  struct FramePart {
    int frame = 0;
    FrameVector slope;
  };

  RefinementRow(double residual_sigmas, double row_weight)
      : residual(residual_sigmas), weight(row_weight) {}

  template <typename Vector>
  void add_shared(Eigen::Index first, const Vector& slope) {
    SharedPart& part = shared[static_cast<size_t>(shared_parts++)];
    part.first = first;
    part.size = slope.size();
    part.slope.head(part.size) = slope;
  }
  void add_frame(int frame, const FrameVector& slope) {
    frames[static_cast<size_t>(frame_parts++)] = {frame, slope};
  }

  double residual;
  double weight;
  std::array<SharedPart, kMostShared> shared;
  std::array<FramePart, kMostFrames> frames;
  int shared_parts = 0;
  int frame_parts = 0;
};

/// Sums of rows. The unknowns are those that all framesets share, and kFrameUnknowns of each
/// frameset.
struct RefinementSums {
  struct Frame {
    FrameMatrix information = FrameMatrix::Zero();
    FrameMatrix with_next = FrameMatrix::Zero();  ///< rows: this frameset, columns: the next
    FrameVector gradient = FrameVector::Zero();
    Eigen::MatrixXd shared;  ///< information with the shared unknowns, one row for each
  };

  RefinementSums(Eigen::Index shared_unknowns, size_t frame_count);

  void add(const RefinementRow& row);

  Eigen::MatrixXd information;  ///< information about the shared unknowns
  Eigen::VectorXd gradient;
  std::vector<Frame> frames;
  double cost = 0.0;  ///< cost of the residuals, which the caller adds
};

/// Eliminates the unknowns of the framesets from the sums, one frameset after the other.
class EliminatedFrames {
 public:
  explicit EliminatedFrames(const RefinementSums& sums);

  /// The normal equations that remain for the shared unknowns.
  const Eigen::MatrixXd& information() const { return information_; }
  const Eigen::VectorXd& gradient() const { return gradient_; }

  /// The changes of the framesets' unknowns that belong to a change of the shared ones.
  std::vector<FrameVector> changes(const Eigen::VectorXd& shared_change) const;

 private:
  struct Frame {
    Eigen::LLT<FrameMatrix> information;
    FrameMatrix with_next;
    FrameVector gradient;
    Eigen::MatrixXd shared;
  };

  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
  std::vector<Frame> frames_;
};

}  // namespace bevloc
