#include "pipeline/solver/reference/yaw_spectrum.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "common/target_clones.h"
#include "pipeline/solver/grid_limits.h"
#include "pipeline/solver/lane_sums.h"
#include "pipeline/solver/shift_range.h"

namespace bevloc {
namespace {

/// Size of the Fourier transform, for every grid.
constexpr int kSpectrumSize = 128;
constexpr double kAngleStep_rad = std::numbers::pi / YawSpectrum::kAngles;
constexpr double kRadiusStep = (YawSpectrum::kMaxFrequency - YawSpectrum::kMinFrequency) /
                               (YawSpectrum::kBands * YawSpectrum::kRadiiPerBand);
constexpr int kTapsPerAngle = 4 * YawSpectrum::kRadiiPerBand;
/// Far below the amplitudes of any channel with structure, and far above those of a constant
/// channel. The latter are rounding errors of the channel with which it shares a complex transform.
constexpr float kSignatureStdEpsilon = 1e-3F;

/// The grid whose spectrum is computed: `grid`, or cells of about kCell_m if `grid` is finer.
BevGrid grid_of(const BevGrid& grid) {
  const int factor =
      std::max(1, static_cast<int>(YawSpectrum::kCell_m / grid.cell_m + kWholeShiftTolerance));
  return {grid.rows / factor, grid.cols / factor, grid.cell_m * factor};
}

/// The highest frequency bin that is read, including interpolation.
double farthest_bin(const BevGrid& grid) {
  return YawSpectrum::kMaxFrequency * grid.cell_m * kSpectrumSize + 2.0;
}

/// Number of shifts that dot_group() computes at once.
constexpr int kAngleGroup = 4;

/// out[k] += sum of a[i] * b[i - k * step], for k = 0 ... kAngleGroup - 1.
BEVLOC_TARGET_CLONES void dot_group(const float* a, const float* b, std::ptrdiff_t step, int count,
                                    double* out) {
  Lanes sums[kAngleGroup] = {};
  for (int i = 0; i < count; i += kLanes) {
    const Lanes& value = lanes(a + i);
    for (int k = 0; k < kAngleGroup; ++k) sums[k] += value * lanes(b + i - k * step);
  }
  for (int k = 0; k < kAngleGroup; ++k) out[k] += sum_of(sums[k]);
}

/// Writes `outputs` weighted sums of `taps` amplitudes each, for all lanes.
BEVLOC_TARGET_CLONES void gather(const float* amplitude, const YawTap* tap, int taps, int outputs,
                                 int lane_count, float* out) {
  for (int i = 0; i < outputs; ++i, tap += taps, out += lane_count) {
    for (int k = 0; k < lane_count; k += kLanes) {
      Lanes sums[2] = {};
      for (int j = 0; j < taps; j += 2) {
        sums[0] += tap[j].weight * lanes(amplitude + tap[j].offset + k);
        sums[1] += tap[j + 1].weight * lanes(amplitude + tap[j + 1].offset + k);
      }
      lanes(out + k) = sums[0] + sums[1];
    }
  }
}

}  // namespace

Status YawSpectrum::check_grid(const BevGrid& grid) {
  const BevGrid read = grid_of(grid);
  if (std::min(read.rows, read.cols) >= kLeastSide &&
      std::max(read.rows, read.cols) <= kSpectrumSize &&
      kMaxFrequency * read.cell_m * kSpectrumSize < 0.5 * kSpectrumSize) {
    return {};
  }
  return refuse_grid(
      grid, fmt::format("{} to {} rows and columns of cells of {} to {:.2f} m, or of finer cells "
                        "that average to as many",
                        kLeastSide, kSpectrumSize, kCell_m, 0.5 / kMaxFrequency));
}

YawSpectrum::YawSpectrum(const BevGrid& grid, int channels, const HypothesisAxis& yaw_rad)
    : yaw_rad_(yaw_rad),
      channels_(channels),
      reach_(
          static_cast<int>(std::ceil(yaw_rad.farthest() / kAngleStep_rad - kWholeShiftTolerance)) +
          1),
      margin_(reach_ + kAngleGroup),
      spectrum_(grid_of(grid), channels, kSpectrumSize, kSpectrumSize, Window::kHann,
                farthest_bin(grid_of(grid))),
      correlations_(2 * reach_ + 1 + kAngleGroup) {
  assert(check_grid(grid) && margin_ < kAngles);
  if (grid_of(grid).rows != grid.rows) {
    pooled_.emplace(Pooled{{grid_of(grid), channels}, {grid_of(grid), channels}});
  }
  make_taps(grid_of(grid));
  const size_t size = static_cast<size_t>(kBands) * (kAngles + 2 * margin_) * spectrum_.lanes();
  bev_signature_.resize(size);
  map_signature_.resize(size);
}

void YawSpectrum::make_taps(const BevGrid& grid) {
  const double bins_per_frequency = grid.cell_m * kSpectrumSize;
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
        constexpr float kShare = 1.0F / kRadiiPerBand;
        taps_.push_back({spectrum_.offset(row, col), kShare * (1.0F - fu) * (1.0F - fv)});
        taps_.push_back({spectrum_.offset(row, col + 1), kShare * (1.0F - fu) * fv});
        taps_.push_back({spectrum_.offset(row + 1, col), kShare * fu * (1.0F - fv)});
        taps_.push_back({spectrum_.offset(row + 1, col + 1), kShare * fu * fv});
      }
    }
  }
}

size_t YawSpectrum::band_begin(int index) const {
  return static_cast<size_t>(index * (kAngles + 2 * margin_) + margin_) * lanes();
}

float* YawSpectrum::band(LaneBuffer& signature, int index) const {
  return signature.data() + band_begin(index);
}

std::span<const float> YawSpectrum::angles(const LaneBuffer& signature, int band) const {
  return std::span(signature).subspan(band_begin(band), static_cast<size_t>(kAngles) * lanes());
}

void YawSpectrum::compute_signatures(const CellFeatures& bev, const CellFeatures& map) {
  if (pooled_) {
    pooled_->bev.assign_average_of(bev);
    pooled_->map.assign_average_of(map);
    spectrum_.compute(pooled_->bev, pooled_->map);
  } else {
    spectrum_.compute(bev, map);
  }
  read_signature(spectrum_.amplitude(0), bev_signature_);
  read_signature(spectrum_.amplitude(1), map_signature_);
}

void YawSpectrum::read_signature(std::span<const float> amplitude, LaneBuffer& signature) const {
  const int lane_count = spectrum_.lanes();
  const int size = kAngles * lane_count;
  const int margin = margin_ * lane_count;
  for (int b = 0; b < kBands; ++b) {
    float* begin = band(signature, b);
    gather(amplitude.data(), taps_.data() + b * kAngles * kTapsPerAngle, kTapsPerAngle, kAngles,
           lane_count, begin);
    standardise_runs(begin, 1, 0, kAngles, lane_count, kSignatureStdEpsilon);
    std::copy_n(begin + size - margin, margin, begin - margin);
    std::copy_n(begin, margin, begin + size);
  }
}

/// Computes the sums of Y_map[i] * Y_bev[i - shift] for all shifts that hypotheses read.
void YawSpectrum::correlate() {
  const int lane_count = spectrum_.lanes();
  std::ranges::fill(correlations_, 0.0);
  for (int first = 0; first < 2 * reach_ + 1; first += kAngleGroup) {
    for (int b = 0; b < kBands; ++b) {
      dot_group(band(map_signature_, b), band(bev_signature_, b) - (first - reach_) * lane_count,
                lane_count, kAngles * lane_count, correlations_.data() + first);
    }
  }
}

/// Expands |M - (1 - w) B_n - w B_(n + 1)|^2, so that correlations at whole shifts suffice.
void YawSpectrum::score(const CellFeatures& bev, const CellFeatures& map,
                        std::span<double> scores) {
  compute_signatures(bev, map);
  correlate();
  double map_square = 0.0;
  double bev_square = 0.0;
  double bev_neighbours = 0.0;
  const int size = kAngles * spectrum_.lanes();
  for (int b = 0; b < kBands; ++b) {
    const float* bev_band = band(bev_signature_, b);
    map_square += dot(band(map_signature_, b), band(map_signature_, b), size);
    bev_square += dot(bev_band, bev_band, size);
    bev_neighbours += dot(bev_band, bev_band - spectrum_.lanes(), size);
  }
  const double count = static_cast<double>(kBands) * kAngles * channels_;
  for (int k = 0; k < yaw_rad_.count(); ++k) {
    const SplitShift shift = split_shift(yaw_rad_.value(k) / kAngleStep_rad);
    const int whole = shift.whole;
    const double w = shift.fraction;
    const double product =
        (1.0 - w) * correlations_[whole + reach_] + w * correlations_[whole + 1 + reach_];
    const double square =
        ((1.0 - w) * (1.0 - w) + w * w) * bev_square + 2.0 * w * (1.0 - w) * bev_neighbours;
    scores[k] = (2.0 * product - map_square - square) / count;
  }
}

}  // namespace bevloc
