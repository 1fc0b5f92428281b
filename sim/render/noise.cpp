#include "sim/render/noise.h"

#include <array>
#include <cmath>
#include <utility>

#include "sim/random.h"

namespace bevloc::sim {
namespace {

constexpr int kNoisePeriod = 512;

/// One octave of smooth value noise with `cells` lattice cells per period.
void add_octave(std::vector<float>& field, int cells, float amplitude, uint64_t seed) {
  Random random(seed);
  std::vector<float> lattice(static_cast<size_t>(cells) * cells);
  for (float& value : lattice) value = static_cast<float>(random.uniform(-1.0, 1.0));
  const auto lattice_at = [&](int x, int y) {
    return lattice[static_cast<size_t>(y % cells) * cells + x % cells];
  };
  for (int y = 0; y < kNoisePeriod; ++y) {
    const int scaled_y = y * cells;
    const int cell_y = scaled_y / kNoisePeriod;
    const float fy = static_cast<float>(scaled_y % kNoisePeriod) / kNoisePeriod;
    const float wy = fy * fy * (3.0F - 2.0F * fy);
    for (int x = 0; x < kNoisePeriod; ++x) {
      const int scaled_x = x * cells;
      const int cell_x = scaled_x / kNoisePeriod;
      const float fx = static_cast<float>(scaled_x % kNoisePeriod) / kNoisePeriod;
      const float wx = fx * fx * (3.0F - 2.0F * fx);
      const float low = std::lerp(lattice_at(cell_x, cell_y), lattice_at(cell_x + 1, cell_y), wx);
      const float high =
          std::lerp(lattice_at(cell_x, cell_y + 1), lattice_at(cell_x + 1, cell_y + 1), wx);
      field[static_cast<size_t>(y) * kNoisePeriod + x] += amplitude * std::lerp(low, high, wy);
    }
  }
}

void normalise(std::vector<float>& field) {
  double sum = 0.0;
  double squares = 0.0;
  for (const float value : field) {
    sum += value;
    squares += static_cast<double>(value) * value;
  }
  const double mean = sum / static_cast<double>(field.size());
  const double deviation = std::sqrt(squares / static_cast<double>(field.size()) - mean * mean);
  for (float& value : field) value = static_cast<float>((value - mean) / deviation);
}

struct Octave {
  int cells;
  float amplitude;
};

template <size_t N>
std::vector<float> make_field(const std::array<Octave, N>& octaves, uint64_t seed) {
  std::vector<float> field(static_cast<size_t>(kNoisePeriod) * kNoisePeriod, 0.0F);
  for (const auto& [cells, amplitude] : octaves) {
    add_octave(field, cells, amplitude, mix_seed(seed + static_cast<uint64_t>(cells)));
  }
  normalise(field);
  return field;
}

std::vector<float> halved(const std::vector<float>& field, int period) {
  const int half = period / 2;
  std::vector<float> result(static_cast<size_t>(half) * half);
  for (int y = 0; y < half; ++y) {
    for (int x = 0; x < half; ++x) {
      const size_t at = static_cast<size_t>(2 * y) * period + 2 * x;
      result[static_cast<size_t>(y) * half + x] =
          0.25F * (field[at] + field[at + 1] + field[at + period] + field[at + period + 1]);
    }
  }
  return result;
}

}  // namespace

NoiseField::NoiseField(int period, std::vector<float> values)
    : period_(period), pitch_(period + kRowLength) {
  values_.resize(static_cast<size_t>(period_) * pitch_);
  for (int y = 0; y < period_; ++y) {
    for (int x = 0; x < pitch_; ++x) {
      values_[static_cast<size_t>(y) * pitch_ + x] =
          values[static_cast<size_t>(y) * period_ + x % period_];
    }
  }
}

const float* NoiseField::row(int64_t ix, int64_t iy) const {
  const int64_t mask = period_ - 1;
  return &values_[static_cast<size_t>(iy & mask) * pitch_ + static_cast<size_t>(ix & mask)];
}

GroundNoise::GroundNoise()
    : patches_(
          kNoisePeriod,
          make_field(
              std::array<Octave, 5>{{{8, 0.6F}, {16, 0.7F}, {32, 0.8F}, {64, 0.8F}, {128, 0.7F}}},
              0x9A7C)) {
  std::vector<float> field = make_field(
      std::array<Octave, 6>{
          {{16, 0.35F}, {32, 0.4F}, {64, 0.6F}, {128, 0.8F}, {256, 1.0F}, {512, 0.9F}}},
      0x6EA1);
  int period = kNoisePeriod;
  for (int level = 0; level < kGroundLevels; ++level) {
    grain_.emplace_back(period, field);
    field = halved(field, period);
    period /= 2;
  }
}

const GroundNoise& GroundNoise::shared() {
  static const GroundNoise noise;
  return noise;
}

GaussianTable::GaussianTable() : values_(kSize + 4096) {
  Random random(0x5EED);
  for (int i = 0; i < kSize; ++i)
    values_[static_cast<size_t>(i)] = static_cast<float>(random.normal());
  for (size_t i = 0; i < 4096; ++i) values_[kSize + i] = values_[i];
}

const GaussianTable& GaussianTable::shared() {
  static const GaussianTable table;
  return table;
}

}  // namespace bevloc::sim
