#include "pipeline/network/test_frame.h"

#include <charconv>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "common/mix.h"
#include "pipeline/preprocessing/network_camera.h"

namespace bevloc {
namespace {

constexpr double kTolerance = 0.03;

/// Draws stripes of several widths and directions, with other ones in each plane.
void draw_images(std::span<int8_t> images) {
  size_t i = 0;
  for (int plane = 0; plane < 3 * kCameraCount; ++plane) {
    for (int v = 0; v < kNetworkHeightPx; ++v) {
      for (int u = 0; u < kNetworkWidthPx; ++u, ++i) {
        const int coarse = ((u + 2 * v) >> 4) * (29 + plane);
        const int fine = ((3 * u - v) >> 2) * 11;
        images[i] = static_cast<int8_t>((coarse + fine + 53 * plane) % 256 - 128);
      }
    }
  }
}

/// Draws lines along and across the vehicle and one oblique line in every class.
void draw_raster(std::span<uint8_t> raster) {
  size_t i = 0;
  for (int channel = 0; channel < kRasterChannels; ++channel) {
    for (int row = 0; row < kRasterGrid.rows; ++row) {
      for (int col = 0; col < kRasterGrid.cols; ++col, ++i) {
        const bool along = (col + 17 * channel) % 61 < 2 && (channel > 0 || row % 50 < 25);
        const bool across = (row + 90 * channel) % 157 < 3 && col > 30 && col < 150;
        const int oblique = row - 2 * col + 40 * channel;
        raster[i] = along || across || (oblique >= 0 && oblique < 4) ? 255 : 0;
      }
    }
  }
}

ViewTable make_table() {
  const int cells = kFeatureGrid.cells();
  ViewTable table;
  table.index.resize(static_cast<size_t>(kViewSlots) * cells);
  table.weight.assign(table.index.size(), 1.0F / kViewSlots);
  for (int slot = 0; slot < kViewSlots; ++slot) {
    for (int cell = 0; cell < cells; ++cell) {
      table.index[static_cast<size_t>(slot) * cells + cell] =
          (7 * cell + 361 * slot) % (kCameraCount * kImageFeatureCells);
    }
  }
  return table;
}

FeatureAnswer condense(std::span<const float> features) {
  FeatureAnswer answer;
  double squares = 0.0;
  for (size_t i = 0; i < features.size(); ++i) {
    const auto value = static_cast<double>(features[i]);
    const uint64_t bits = mix_bits(i + 1);
    squares += value * value;
    for (int k = 0; k < FeatureAnswer::kSums; ++k) {
      answer.sums[k] += ((bits >> k) & 1U) != 0 ? value : -value;
    }
  }
  answer.norm = std::sqrt(squares);
  return answer;
}

Status check_side(std::string_view side, const FeatureAnswer& found, const FeatureAnswer& wanted) {
  double squares = 0.0;
  for (int k = 0; k < FeatureAnswer::kSums; ++k) {
    squares += std::pow(found.sums[k] - wanted.sums[k], 2);
  }
  const double difference = std::sqrt(squares / FeatureAnswer::kSums) / wanted.norm;
  const double growth = std::abs(found.norm / wanted.norm - 1.0);
  if (difference <= kTolerance && growth <= kTolerance) return {};  // this is false for NaN
  return fail(
      "network: found {} features of the test frame that differ from the model's stored answer by "
      "{:.1f} %, wanted at most {:.0f} %: memory, processor or model file is damaged; replace the "
      "model file, and the computer if it happens again",
      side, 100.0 * std::max(difference, growth), 100.0 * kTolerance);
}

std::array<double*, 2 * (1 + FeatureAnswer::kSums)> numbers_of(NetworkAnswer& answer) {
  std::array<double*, 2 * (1 + FeatureAnswer::kSums)> numbers{};
  size_t i = 0;
  for (FeatureAnswer* side : {&answer.bev, &answer.map}) {
    numbers[i++] = &side->norm;
    for (double& sum : side->sums) numbers[i++] = &sum;
  }
  return numbers;
}

}  // namespace

NetworkAnswer answer_to_test_frame(Network& network) {
  static const ViewTable table = make_table();
  draw_images(network.image_input());
  draw_raster(network.raster_input());
  network.set_view_table(table);
  network.run_image_branch();
  network.run_map_branch();
  return {condense(network.bev_features().data), condense(network.map_features().data)};
}

Status check_answer(const NetworkAnswer& found, const NetworkAnswer& wanted) {
  if (Status status = check_side("BEV", found.bev, wanted.bev); !status) return status;
  return check_side("map", found.map, wanted.map);
}

std::string to_text(const NetworkAnswer& answer) {
  NetworkAnswer copy = answer;
  std::string text;
  for (const double* number : numbers_of(copy)) {
    text += fmt::format("{}{:.6g}", text.empty() ? "" : " ", *number);
  }
  return text;
}

Result<NetworkAnswer> answer_from(std::string_view text) {
  const auto refuse = [text] {
    return fail("metadata '{}': found '{}', wanted {} numbers that bevloc store-answer writes",
                kAnswerKey, text, 2 * (1 + FeatureAnswer::kSums));
  };
  NetworkAnswer answer;
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (double* number : numbers_of(answer)) {
    if (at != text.data()) {
      if (at == end || *at != ' ') return refuse();
      ++at;
    }
    const auto [next, error] = std::from_chars(at, end, *number);
    if (error != std::errc() || !std::isfinite(*number)) return refuse();
    at = next;
  }
  if (at != end || answer.bev.norm <= 0.0 || answer.map.norm <= 0.0) return refuse();
  return answer;
}

}  // namespace bevloc
