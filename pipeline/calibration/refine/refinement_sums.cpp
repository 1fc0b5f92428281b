#include "pipeline/calibration/refine/refinement_sums.h"

#include <cassert>
#include <span>

namespace bevloc {

RefinementSums::RefinementSums(Eigen::Index shared_unknowns, size_t frame_count)
    : information(Eigen::MatrixXd::Zero(shared_unknowns, shared_unknowns)),
      gradient(Eigen::VectorXd::Zero(shared_unknowns)),
      frames(frame_count) {
  for (Frame& frame : frames) frame.shared = Eigen::MatrixXd::Zero(shared_unknowns, kFrameUnknowns);
}

void RefinementSums::add(const RefinementRow& row) {
  const std::span shared(row.shared.data(), static_cast<size_t>(row.shared_parts));
  const std::span of_frames(row.frames.data(), static_cast<size_t>(row.frame_parts));
  for (const auto& part : shared) {
    const auto weighted = (row.weight * part.values()).eval();
    gradient.segment(part.first, part.size) += row.residual * weighted;
    for (const auto& other : shared) {
      information.block(part.first, other.first, part.size, other.size) +=
          weighted * other.values().transpose();
    }
    for (const auto& of : of_frames) {
      frames[static_cast<size_t>(of.frame)].shared.middleRows(part.first, part.size) +=
          weighted * of.slope.transpose();
    }
  }
  for (const auto& of : of_frames) {
    Frame& frame = frames[static_cast<size_t>(of.frame)];
    const FrameVector weighted = row.weight * of.slope;
    frame.gradient += row.residual * weighted;
    for (const auto& other : of_frames) {
      if (other.frame == of.frame) frame.information += weighted * other.slope.transpose();
      if (other.frame > of.frame) {
        assert(other.frame == of.frame + 1);
        frame.with_next += weighted * other.slope.transpose();
      }
    }
  }
}

EliminatedFrames::EliminatedFrames(const RefinementSums& sums)
    : information_(sums.information), gradient_(sums.gradient) {
  frames_.reserve(sums.frames.size());
  for (const RefinementSums::Frame& of : sums.frames) {
    FrameMatrix information = of.information;
    FrameVector gradient = of.gradient;
    Eigen::MatrixXd shared = of.shared;
    if (!frames_.empty()) {
      const Frame& before = frames_.back();
      const FrameMatrix gain = before.information.solve(before.with_next);
      information -= before.with_next.transpose() * gain;
      gradient -= gain.transpose() * before.gradient;
      shared -= before.shared * gain;
    }
    const Frame& frame =
        frames_.emplace_back(Frame{information.llt(), of.with_next, gradient, std::move(shared)});
    const Eigen::MatrixXd solved = frame.information.solve(frame.shared.transpose());
    information_ -= frame.shared * solved;
    gradient_ -= solved.transpose() * frame.gradient;
  }
  information_ = 0.5 * (information_ + information_.transpose()).eval();
}

std::vector<FrameVector> EliminatedFrames::changes(const Eigen::VectorXd& shared_change) const {
  std::vector<FrameVector> result(frames_.size());
  FrameVector next = FrameVector::Zero();
  for (size_t i = frames_.size(); i-- > 0;) {
    const Frame& frame = frames_[i];
    next = -frame.information.solve(frame.gradient + frame.shared.transpose() * shared_change +
                                    frame.with_next * next);
    result[i] = next;
  }
  return result;
}

}  // namespace bevloc
