// What lowering knows about the names of the graph while it walks through the nodes.
#pragma once

#include <map>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/network/layout_trace.h"
#include "pipeline/network/program.h"

namespace bevloc::nn {

/// A tensor made of one activation of the program.
struct Activation {
  int value = 0;
  LayoutTrace layout;
  bool is_real = true;  ///< false between QuantizeLinear and DequantizeLinear: bare elements
};

/// DequantizeLinear of a constant.
struct QuantizedConstant {
  Tensor elements;
  std::vector<float> scale;  ///< one, or one per output channel

  std::vector<float> real_values() const;
};

/// The view table's index or weight: which of its elements, in which order.
struct ViewPort {
  bool is_weight = false;
  LayoutTrace layout;
};

/// Gather of features by view_index, before (and, `weighted`, after) Mul by view_weight.
struct GatheredView {
  int features = 0;
  Shape shape;          ///< [channels, a, b] or [a, b, channels]
  LayoutTrace entries;  ///< [a, b]: element of view_index
  bool channels_first = false;
  bool weighted = false;
};

using Symbol = std::variant<Activation, QuantizedConstant, ViewPort, GatheredView>;

/// The program under construction and the meaning of the names seen so far.
class LoweringState {
 public:
  explicit LoweringState(const Graph& graph);

  const Graph& graph() const { return graph_; }
  Program& program() { return program_; }
  Value& value(int id) { return program_.values[static_cast<size_t>(id)]; }

  int add_value(const std::array<int64_t, 4>& dims, ElementType type = ElementType::kFloat32,
                float scale = 1.0F);
  void define(const std::string& name, Symbol symbol) { symbols_[name] = std::move(symbol); }

  /// Another name for (the elements of) the node's input 0: who reads one reads both.
  void define_alias(const Node& node, Symbol symbol);

  const Symbol* find(const std::string& name) const;
  const Tensor* constant(const std::string& name) const;
  /// The node's input i, of a wanted kind. Throws LoadError.
  const Symbol& symbol(const Node& node, size_t i) const;
  const Tensor& constant_input(const Node& node, size_t i, const char* what) const;
  const Activation& real_activation(const Node& node, size_t i) const;

  /// The activation as a value [n, c, h, w] in its own order: copies if data movement is pending.
  int materialize(const Node& node, const Activation& activation);
  int materialized_input(const Node& node, size_t i);
  /// The value as float, converted if need be.
  int as_float(int value);

  /// The step that made `value`, if it may still be changed: nobody else reads it and its output is
  /// not rounded yet. Null otherwise.
  Step* open_step(const std::string& name, const Activation& activation);
  Step* producer_of(int value);
  /// Moves the step to the end, so that it may read whatever is computed by now.
  Step* move_to_end(Step* step);

 private:
  bool is_read(int value) const;

  const Graph& graph_;
  Program program_;
  std::map<std::string, Symbol> symbols_;
  std::map<std::string, int> use_count_;
};

}  // namespace bevloc::nn
