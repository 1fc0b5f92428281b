#include "pipeline/calibration/refine/tie_finder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/LU>

namespace bevloc {
namespace {

constexpr int kHalf = 6;  // pixels from the centre of a patch to its edge
constexpr int kSide = 2 * kHalf + 1;
constexpr int kPixels = kSide * kSide;
using Patch = std::array<float, kPixels>;

bool is_inside(const GreyImage& image, const Eigen::Vector2d& px, double margin_px) {
  return px.x() >= margin_px && px.y() >= margin_px && px.x() <= image.width - 1.0 - margin_px &&
         px.y() <= image.height - 1.0 - margin_px;
}

/// The patch around `centre`, whose pixels are `image_from_patch` in the image. Each is the mean of
/// a square of one pixel of the patch. Returns nothing if the patch leaves the image.
std::optional<Patch> read_patch(const GreyImage& image, const Eigen::Vector2d& centre,
                                const Eigen::Matrix2d& image_from_patch) {
  constexpr double kThird = 1.0 / 3.0;
  const double reach = kHalf + 0.5;
  for (const double x : {-reach, reach}) {
    for (const double y : {-reach, reach}) {
      const Eigen::Vector2d corner = centre + image_from_patch * Eigen::Vector2d(x, y);
      if (!image.contains(corner.x(), corner.y())) return std::nullopt;
    }
  }
  Patch patch;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      float sum = 0.0F;
      for (int b = -1; b <= 1; ++b) {
        for (int a = -1; a <= 1; ++a) {
          const Eigen::Vector2d at =
              centre +
              image_from_patch * Eigen::Vector2d(i - kHalf + kThird * a, j - kHalf + kThird * b);
          sum += image.at(at.x(), at.y());
        }
      }
      patch[static_cast<size_t>(j * kSide + i)] = sum / 9.0F;
    }
  }
  return patch;
}

/// Subtracts the mean and divides by the root of the sum of squares. Returns false if the patch
/// lacks texture along one of the axes. More than one place would agree with such a patch, so the
/// search would be in vain.
bool normalize(Patch& patch) {
  constexpr float kLeastContrast = 2.5F;  // grey levels, one sigma
  // Sum of the squared slopes along the axis of least texture, divided by the number of pixels:
  // (grey levels per pixel)^2.
  constexpr float kLeastTexture = 1.5F;
  float sum = 0.0F;
  for (const float value : patch) sum += value;
  float squares = 0.0F;
  for (float& value : patch) {
    value -= sum / kPixels;
    squares += value * value;
  }
  if (squares < kLeastContrast * kLeastContrast * kPixels) return false;
  Eigen::Matrix2f structure = Eigen::Matrix2f::Zero();
  for (int j = 1; j + 1 < kSide; ++j) {
    for (int i = 1; i + 1 < kSide; ++i) {
      const auto at = static_cast<size_t>(j * kSide + i);
      const Eigen::Vector2f slope(0.5F * (patch[at + 1] - patch[at - 1]),
                                  0.5F * (patch[at + kSide] - patch[at - kSide]));
      structure += slope * slope.transpose();
    }
  }
  const float half_trace = 0.5F * structure.trace();
  const float least =
      half_trace - std::sqrt(std::max(0.0F, half_trace * half_trace - structure.determinant()));
  if (least < kLeastTexture * kPixels) return false;
  const float scale = 1.0F / std::sqrt(squares);
  for (float& value : patch) value *= scale;
  return true;
}

/// The correlation of a normalized patch with an image at all whole displacements up to `reach`.
class Correlation {
 public:
  Correlation(const GreyImage& image, const Patch& patch, int u, int v, int reach)
      : reach_(reach), side_(2 * reach + 1), values_(static_cast<size_t>(side_ * side_)) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) at(x, y) = correlate(image, patch, u + x, v + y);
    }
  }

  /// The displacement of the best agreement, or nothing if it is poor, at the border, or if another
  /// place agrees nearly as well.
  std::optional<Eigen::Vector2d> peak() const {
    constexpr float kLeast = 0.8F;
    constexpr float kOther = 0.85F;
    constexpr int kNear = 3;
    int px = 0;
    int py = 0;
    for (int y = -reach_; y <= reach_; ++y) {
      for (int x = -reach_; x <= reach_; ++x) {
        if (at(x, y) > at(px, py)) {
          px = x;
          py = y;
        }
      }
    }
    const float best = at(px, py);
    if (best < kLeast || std::abs(px) == reach_ || std::abs(py) == reach_) return std::nullopt;
    for (int y = -reach_; y <= reach_; ++y) {
      for (int x = -reach_; x <= reach_; ++x) {
        const bool near = std::abs(x - px) < kNear && std::abs(y - py) < kNear;
        if (!near && at(x, y) > kOther * best) return std::nullopt;
      }
    }
    const auto vertex = [best](float before, float after) {
      return 0.5 * (before - after) / (before - 2.0F * best + after);
    };
    return Eigen::Vector2d(px + vertex(at(px - 1, py), at(px + 1, py)),
                           py + vertex(at(px, py - 1), at(px, py + 1)));
  }

 private:
  static float correlate(const GreyImage& image, const Patch& patch, int u, int v) {
    float sum = 0.0F;
    float squares = 0.0F;
    float product = 0.0F;
    for (int j = 0; j < kSide; ++j) {
      const uint8_t* row =
          image.pixels.data() + static_cast<size_t>(v + j - kHalf) * image.width + u - kHalf;
      const float* of_patch = patch.data() + static_cast<size_t>(j * kSide);
      for (int i = 0; i < kSide; ++i) {
        const auto value = static_cast<float>(row[i]);
        sum += value;
        squares += value * value;
        product += value * of_patch[i];
      }
    }
    const float variance = squares - sum * sum / kPixels;
    return variance > 1.0F ? product / std::sqrt(variance) : 0.0F;
  }

  float& at(int x, int y) {
    return values_[static_cast<size_t>((y + reach_) * side_ + x + reach_)];
  }
  float at(int x, int y) const {
    return values_[static_cast<size_t>((y + reach_) * side_ + x + reach_)];
  }

  int reach_;
  int side_;
  std::vector<float> values_;
};

/// A place that both views have, and how pixels change between them.
struct Candidate {
  Eigen::Vector2d first_px;
  Eigen::Vector2d second_px;
  Eigen::Matrix2d second_from_first;
};

std::optional<Candidate> candidate_at(const Eigen::Vector2d& first_px, const MomentView& first,
                                      const MomentView& second, double farthest_m) {
  Candidate candidate;
  candidate.first_px = first_px;
  const auto ground = first.ground_at(first_px);
  if (!ground || (*ground - first.eye()).norm() > farthest_m ||
      (*ground - second.eye()).norm() > farthest_m) {
    return std::nullopt;
  }
  const auto there = second.project(*ground);
  if (!there) return std::nullopt;
  candidate.second_px = *there;
  for (int axis = 0; axis < 2; ++axis) {
    const auto beside = first.ground_at(first_px + Eigen::Vector2d::Unit(axis));
    const auto beside_px = beside ? second.project(*beside) : std::nullopt;
    if (!beside_px) return std::nullopt;
    candidate.second_from_first.col(axis) = *beside_px - *there;
  }
  return candidate;
}

/// Searches the picture that shows the place in less detail for what the other picture shows.
std::optional<GroundTie> tie_at(const Candidate& candidate, const GreyImage& first,
                                const GreyImage& second, int reach_px) {
  constexpr double kMostScale = 4.0;
  const bool second_is_coarser = std::abs(candidate.second_from_first.determinant()) < 1.0;
  const GreyImage& coarse = second_is_coarser ? second : first;
  const GreyImage& fine = second_is_coarser ? first : second;
  const Eigen::Vector2d& coarse_px = second_is_coarser ? candidate.second_px : candidate.first_px;
  const Eigen::Vector2d& fine_px = second_is_coarser ? candidate.first_px : candidate.second_px;
  Eigen::Matrix2d fine_from_coarse = candidate.second_from_first;
  if (second_is_coarser) fine_from_coarse = fine_from_coarse.inverse().eval();
  if (!(fine_from_coarse.norm() < kMostScale)) return std::nullopt;
  if (!is_inside(coarse, coarse_px, kHalf + reach_px + 1.0)) return std::nullopt;
  auto patch = read_patch(fine, fine_px, fine_from_coarse);
  if (!patch || !normalize(*patch)) return std::nullopt;
  const Eigen::Vector2d whole_px = coarse_px.array().round();
  const Correlation correlation(coarse, *patch, static_cast<int>(whole_px.x()),
                                static_cast<int>(whole_px.y()), reach_px);
  const auto peak = correlation.peak();
  if (!peak) return std::nullopt;
  const Eigen::Vector2d found_px = whole_px + *peak;
  return second_is_coarser ? GroundTie{fine_px, found_px} : GroundTie{found_px, fine_px};
}

}  // namespace

std::vector<GroundTie> find_ties(const GreyImage& first, const MomentView& first_view,
                                 const GreyImage& second, const MomentView& second_view,
                                 const TieSearch& search) {
  std::vector<GroundTie> ties;
  const int reach_px = static_cast<int>(std::ceil(search.reach_px));
  const double border_px = 0.5 * search.spacing_px;
  for (double v = border_px; v < first.height; v += search.spacing_px) {
    for (double u = border_px; u < first.width; u += search.spacing_px) {
      const Eigen::Vector2d at(u, v);
      const auto candidate = candidate_at(at, first_view, second_view, search.farthest_m);
      if (!candidate || first_view.camera().shows_own_body(at) ||
          second_view.camera().shows_own_body(candidate->second_px)) {
        continue;
      }
      if (const auto tie = tie_at(*candidate, first, second, reach_px)) ties.push_back(*tie);
    }
  }
  return ties;
}

}  // namespace bevloc
