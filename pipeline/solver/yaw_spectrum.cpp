#include "pipeline/solver/yaw_spectrum.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "common/target_clones.h"

namespace bevloc {
namespace {

constexpr double kAngleStep_rad = std::numbers::pi / YawSpectrum::kAngles;
constexpr double kRadiusStep = (YawSpectrum::kMaxFrequency - YawSpectrum::kMinFrequency) /
                               (YawSpectrum::kBands * YawSpectrum::kRadiiPerBand);
constexpr float kStdEpsilon = 1e-6F;

/// Sum of (map - bev between its own and its previous angle)^2.
BEVLOC_TARGET_CLONES float squared_difference(const float* map, const float* bev, int lane_count,
                                              float previous_weight, int count) {
  Lanes sums[2] = {};
  const float own_weight = 1.0F - previous_weight;
  for (int i = 0; i < count; i += kLanes) {
    const Lanes difference = lanes(map + i) - own_weight * lanes(bev + i) -
                             previous_weight * lanes(bev + i - lane_count);
    sums[i / kLanes % 2] += difference * difference;
  }
  return sum_of(sums[0] + sums[1]);
}

}  // namespace

bool YawSpectrum::covers(const BevGrid& grid) {
  return std::max(grid.rows, grid.cols) <= kFftSize &&
         kMaxFrequency * grid.cell_m * kFftSize < AmplitudeSpectrum::kCols - 1;
}

YawSpectrum::YawSpectrum(const BevGrid& grid, int channels, const HypothesisAxis& yaw_rad)
    : yaw_rad_(yaw_rad),
      channels_(channels),
      margin_(static_cast<int>(std::ceil(yaw_rad.range / kAngleStep_rad)) + 2),
      spectrum_(grid, channels) {
  assert(covers(grid) && margin_ < kAngles);
  make_samples(grid);
  const size_t size = static_cast<size_t>(kBands) * (kAngles + 2 * margin_) * spectrum_.lanes();
  bev_signature_.resize(size);
  map_signature_.resize(size);
}

void YawSpectrum::make_samples(const BevGrid& grid) {
  const double bins_per_frequency = grid.cell_m * kFftSize;
  const auto offset = [&](int row, int col) {
    return ((row + kFftSize) % kFftSize * AmplitudeSpectrum::kCols + col) * spectrum_.lanes();
  };
  for (int band = 0; band < kBands; ++band) {
    for (int i = 0; i < kAngles; ++i) {
      for (int j = 0; j < kRadiiPerBand; ++j) {
        const double radius = kMinFrequency + (band * kRadiiPerBand + j + 0.5) * kRadiusStep;
        const double u = radius * std::cos(i * kAngleStep_rad) * bins_per_frequency;
        const double v = radius * std::sin(i * kAngleStep_rad) * bins_per_frequency;
        const int row = static_cast<int>(std::floor(u));
        const int col = static_cast<int>(std::floor(v));
        const auto fu = static_cast<float>(u - row);
        const auto fv = static_cast<float>(v - col);
        samples_.push_back(
            {{offset(row, col), offset(row, col + 1), offset(row + 1, col),
              offset(row + 1, col + 1)},
             {(1.0F - fu) * (1.0F - fv), (1.0F - fu) * fv, fu * (1.0F - fv), fu * fv}});
      }
    }
  }
}

float* YawSpectrum::band(std::vector<float>& signature, int index) const {
  const int lanes = spectrum_.lanes();
  return signature.data() + (index * (kAngles + 2 * margin_) + margin_) * lanes;
}

void YawSpectrum::compute_signature(const CellFeatures& features, std::vector<float>& signature) {
  spectrum_.compute(features);
  const float* amplitude = spectrum_.amplitude().data();
  const int lane_count = spectrum_.lanes();
  const Sample* sample = samples_.data();
  for (int b = 0; b < kBands; ++b) {
    float* out = band(signature, b);
    for (int i = 0; i < kAngles; ++i, out += lane_count) {
      std::fill_n(out, lane_count, 0.0F);
      for (int j = 0; j < kRadiiPerBand; ++j, ++sample) {
        for (int tap = 0; tap < 4; ++tap) {
          const float weight = sample->weights[tap] / kRadiiPerBand;
          const float* in = amplitude + sample->offsets[tap];
          for (int k = 0; k < lane_count; k += kLanes) lanes(out + k) += weight * lanes(in + k);
        }
      }
    }
    standardise_band(band(signature, b));
  }
}

void YawSpectrum::standardise_band(float* band) const {
  const int lane_count = spectrum_.lanes();
  const int size = kAngles * lane_count;
  for (int k = 0; k < lane_count; k += kLanes) {
    Lanes mean = {};
    for (int i = k; i < size; i += lane_count) mean += lanes(band + i);
    mean /= static_cast<float>(kAngles);
    Lanes variance = {};
    for (int i = k; i < size; i += lane_count) {
      lanes(band + i) -= mean;
      variance += lanes(band + i) * lanes(band + i);
    }
    Lanes scale = {};
    for (int c = 0; c < kLanes; ++c) {
      scale[c] = 1.0F / (std::sqrt(variance[c] / kAngles) + kStdEpsilon);
    }
    for (int i = k; i < size; i += lane_count) lanes(band + i) *= scale;
  }
  const int margin = margin_ * lane_count;
  std::copy_n(band + size - margin, margin, band - margin);
  std::copy_n(band, margin, band + size);
}

void YawSpectrum::score(const CellFeatures& bev, const CellFeatures& map,
                        std::span<double> scores) {
  compute_signature(bev, bev_signature_);
  compute_signature(map, map_signature_);
  const int lane_count = spectrum_.lanes();
  const double count = static_cast<double>(kBands) * kAngles * channels_;
  for (int k = 0; k < yaw_rad_.count(); ++k) {
    const double shift = yaw_rad_.value(k) / kAngleStep_rad;
    const int whole = static_cast<int>(std::floor(shift));
    const auto fraction = static_cast<float>(shift - whole);
    double sum = 0.0;
    for (int b = 0; b < kBands; ++b) {
      sum +=
          squared_difference(band(map_signature_, b), band(bev_signature_, b) - whole * lane_count,
                             lane_count, fraction, kAngles * lane_count);
    }
    scores[k] = -sum / count;
  }
}

}  // namespace bevloc
