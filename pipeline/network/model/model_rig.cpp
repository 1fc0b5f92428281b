#include "pipeline/network/model/model_rig.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/number_text.h"
#include "pipeline/network/model/load_error.h"
#include "pipeline/preprocessing/network_camera.h"

namespace bevloc {
namespace {

constexpr double kMostRatio = 1.5;

void check_statement(const nn::Graph& graph, const std::string& key, const std::string& wanted) {
  const auto found = graph.metadata.find(key);
  if (found == graph.metadata.end() || found->second == wanted) return;
  nn::refuse("metadata '{}' is '{}', wanted '{}'", key, found->second, wanted);
}

std::optional<double> positive_number(std::string_view word) {
  const auto number = parse_number<double>(word);
  return number && std::isfinite(*number) && *number > 0.0 ? number : std::nullopt;
}

template <size_t kCount>
std::optional<std::array<double, kCount>> numbers_in(const nn::Graph& graph,
                                                     const std::string& key) {
  const auto found = graph.metadata.find(key);
  if (found == graph.metadata.end()) return std::nullopt;
  std::array<double, kCount> numbers{};
  std::string_view rest = found->second;
  for (size_t i = 0; i < numbers.size(); ++i) {
    const bool is_last = i + 1 == numbers.size();
    const size_t end = is_last ? rest.size() : rest.find(' ');
    const auto number = end == rest.npos ? std::nullopt : positive_number(rest.substr(0, end));
    if (!number) {
      nn::refuse("metadata '{}' is '{}', wanted {} positive numbers", key, found->second,
                 numbers.size());
    }
    numbers[i] = *number;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return numbers;
}

std::optional<TrainedRange> range_in(const nn::Graph& graph, const std::string& key) {
  const auto numbers = numbers_in<2>(graph, key);
  if (!numbers) return std::nullopt;
  const auto [least, most] = *numbers;
  if (least > most) {
    nn::refuse("metadata '{}' is '{}', wanted the least value first", key, graph.metadata.at(key));
  }
  return TrainedRange{least, most};
}

Status check_camera(std::string_view camera, std::string_view what, double found, double trained,
                    const std::optional<TrainedRange>& range) {
  const double least = std::min(trained / kMostRatio, range ? range->least : trained);
  const double most = std::max(trained * kMostRatio, range ? range->most : trained);
  if (found >= least && found <= most) return {};
  return fail(
      "camera {}: found a {} of {:.3g} in the rig, wanted {:.3g} to {:.3g}, because the model was "
      "trained with {:.3g}; take the model for this rig, or train one",
      camera, what, found, least, most, trained);
}

}  // namespace

ModelRig read_model_rig(const nn::Graph& graph) {
  check_statement(graph, "bevloc.rig.cameras", fmt::format("{}", fmt::join(kCameraNames, " ")));
  check_statement(graph, "bevloc.rig.image_size_px",
                  fmt::format("{} {}", kNetworkWidthPx, kNetworkHeightPx));
  return {numbers_in<kCameraCount>(graph, "bevloc.rig.focal_px"),
          numbers_in<kCameraCount>(graph, "bevloc.rig.height_m"),
          range_in(graph, "bevloc.rig.focal_range_px"),
          range_in(graph, "bevloc.rig.height_range_m")};
}

Status check_rig_fits(const ModelRig& model, const Rig& rig) {
  for (size_t i = 0; i < kCameraCount; ++i) {
    const CameraModel camera = network_camera(rig.cameras[i]);
    if (model.focal_px) {
      const Status status = check_camera(
          kCameraNames[i], fmt::format("focal length in pixels of {} columns", kNetworkWidthPx),
          camera.intrinsics.fx_px, (*model.focal_px)[i], model.focal_range_px);
      if (!status) return status;
    }
    if (model.height_m) {
      const Status status = check_camera(kCameraNames[i], "height in metres",
                                         camera.vehicle_from_camera.translation_m.z(),
                                         (*model.height_m)[i], model.height_range_m);
      if (!status) return status;
    }
  }
  return {};
}

}  // namespace bevloc
