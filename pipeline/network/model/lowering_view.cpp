#include "pipeline/network/model/lowering_view.h"

#include <algorithm>

#include "pipeline/network/model/load_error.h"
#include "pipeline/network/view/view_table.h"

namespace bevloc::nn {
namespace {

/// Whether the gathered tensor is the table of all cameras' features: its entry for key k and
/// channel c must be channel c of feature cell k, with the cells counted over camera, row, column.
bool is_feature_table(const LayoutTrace& table, bool channels_first,
                      const std::array<int64_t, 4>& dims) {
  const auto [cameras, channels, rows, cols] = dims;
  const int64_t camera_cells = rows * cols;
  const int64_t keys = cameras * camera_cells;
  const Shape wanted = channels_first ? Shape{channels, keys} : Shape{keys, channels};
  if (table.shape() != wanted) return false;
  for (int64_t k = 0; k < keys; ++k) {
    const int64_t camera = k / camera_cells;
    const int64_t cell = k % camera_cells;
    for (int64_t c = 0; c < channels; ++c) {
      const int64_t entry = channels_first ? c * keys + k : k * channels + c;
      if (table.source(entry) != (camera * channels + c) * camera_cells + cell) return false;
    }
  }
  return true;
}

/// Number of BEV cells in the view table, whose shape is [slots, cells].
int64_t cell_count(const LoweringState& state) {
  for (const Port& port : state.graph().inputs) {
    if (port.name == kViewIndexPort && port.shape.size() == 2) return port.shape[1];
  }
  return 0;
}

/// Whether `weight`, broadcast to the shape of the gathered features, multiplies each feature by
/// the weight of its own view table entry.
bool weights_fit(const LayoutTrace& weight, const GatheredView& view) {
  Shape shape = weight.shape();
  if (shape.size() > 3) return false;
  shape.insert(shape.begin(), 3 - shape.size(), 1);
  const size_t channel_axis = view.channels_first ? 0 : 2;
  const size_t a_axis = view.channels_first ? 1 : 0;
  const int64_t a_count = view.entries.shape()[0];
  const int64_t b_count = view.entries.shape()[1];
  if (shape[channel_axis] != 1 || shape[a_axis] != a_count || shape[a_axis + 1] != b_count) {
    return false;
  }
  for (int64_t i = 0; i < a_count * b_count; ++i) {
    if (weight.source(i) != view.entries.source(i)) return false;
  }
  return true;
}

/// The axis of the gathered features that counts the slots, or -1 if the entries are in neither of
/// the orders [slots, cells] and [cells, slots].
int64_t slot_axis(const GatheredView& view, int64_t cells) {
  const Shape& shape = view.entries.shape();
  const int64_t first = view.channels_first ? 1 : 0;
  if (view.entries.is_identity() && shape == Shape{kViewSlots, cells}) return first;
  const LayoutTrace turned = LayoutTrace({kViewSlots, cells}).transposed({1, 0});
  const bool is_turned = shape == turned.shape() && view.entries.sources() == turned.sources();
  return is_turned ? first + 1 : -1;
}

}  // namespace

void lower_gather(LoweringState& state, const Node& node) {
  const Activation& features = state.real_activation(node, 0);
  const auto* index = std::get_if<ViewPort>(&state.symbol(node, 1));
  const int64_t axis = node.integer("axis", 0);
  const auto dims = state.value(features.value).dims;
  if (index == nullptr || index->is_weight || index->layout.shape().size() != 2) {
    refuse("{}: only a gather by '{}' with two axes is supported", node.label, kViewIndexPort);
  }
  if (axis < -2 || axis > 1) {
    refuse("{}: found the axis {} of the gather, wanted -2 to 1", node.label, axis);
  }
  const bool channels_first = axis == 1 || axis == -1;
  if (!is_feature_table(features.layout, channels_first, dims)) {
    refuse("{}: the features along the gathered axis {} are not in the order camera, row, column",
           node.label, axis);
  }
  GatheredView view;
  view.features = features.value;
  view.channels_first = channels_first;
  view.entries = index->layout;
  const Shape& entries = view.entries.shape();
  view.shape = channels_first ? Shape{dims[1], entries[0], entries[1]}
                              : Shape{entries[0], entries[1], dims[1]};
  state.define(node.output, std::move(view));
}

void lower_mul(LoweringState& state, const Node& node) {
  const auto* left = std::get_if<GatheredView>(&state.symbol(node, 0));
  const size_t weight_input = left != nullptr ? 1 : 0;
  const auto* view = left != nullptr ? left : std::get_if<GatheredView>(&state.symbol(node, 1));
  const auto* weight = std::get_if<ViewPort>(&state.symbol(node, weight_input));
  if (view == nullptr || view->weighted || weight == nullptr || !weight->is_weight ||
      !weights_fit(weight->layout, *view)) {
    refuse("{}: only gathered features times their '{}' are supported", node.label,
           kViewWeightPort);
  }
  GatheredView weighted = *view;
  weighted.weighted = true;
  state.define(node.output, std::move(weighted));
}

void lower_reduce_sum(LoweringState& state, const Node& node) {
  const auto* view = std::get_if<GatheredView>(&state.symbol(node, 0));
  if (view == nullptr || !view->weighted) {
    refuse("{}: only the sum of weighted gathered features is supported", node.label);
  }
  Shape axes = state.constant_input(node, 1, "list of axes").integers();
  for (int64_t& axis : axes) axis += axis < 0 ? 3 : 0;
  const int64_t cells = cell_count(state);
  const int64_t slots = slot_axis(*view, cells);
  if (slots < 0 || axes != Shape{slots}) {
    refuse("{}: sums over axes {}, wanted the {} slots", node.label, to_string(axes), kViewSlots);
  }
  const int64_t channels = state.value(view->features).dims[1];
  const int output = state.add_value({1, channels, 1, cells});
  state.program().steps.push_back(ViewStep{view->features, output});
  LayoutTrace layout({channels, cells});
  if (!view->channels_first) layout = layout.transposed({1, 0});
  if (node.integer("keepdims", 1) != 0) {
    Shape kept = view->shape;
    kept[static_cast<size_t>(axes[0])] = 1;
    layout = layout.reshaped(kept);
  }
  state.define(node.output, Activation{output, std::move(layout)});
}

}  // namespace bevloc::nn
