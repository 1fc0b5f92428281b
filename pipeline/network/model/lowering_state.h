// State of the lowering while it walks through the nodes: the program so far, and what each name of
// the graph stands for.
#pragma once

#include <map>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/network/model/layout_trace.h"
#include "pipeline/network/model/program.h"

namespace bevloc::nn {

/// A tensor that has the elements of one value of the program, possibly in another layout.
struct Activation {
  int value = 0;
  LayoutTrace layout;
  bool is_real = true;  ///< false: quantized, between QuantizeLinear and DequantizeLinear
};

/// The output of DequantizeLinear on a constant.
struct QuantizedConstant {
  Tensor elements;
  std::vector<float> scale;  ///< one for all elements, or one per output channel

  std::vector<float> real_values() const;
};

/// The index or the weight of the view table, possibly in another layout.
struct ViewPort {
  bool is_weight = false;
  LayoutTrace layout;
};

/// The output of Gather of features by view_index, or of the Mul by view_weight that follows.
struct GatheredView {
  int features = 0;     ///< the value that is gathered from
  Shape shape;          ///< [channels, a, b] or [a, b, channels]
  LayoutTrace entries;  ///< [a, b]: element of view_index
  bool channels_first = false;
  bool weighted = false;  ///< true after the Mul
};

/// What a name of the graph stands for.
using Symbol = std::variant<Activation, QuantizedConstant, ViewPort, GatheredView>;

class LoweringState {
 public:
  explicit LoweringState(const Graph& graph);

  const Graph& graph() const { return graph_; }
  Program& program() { return program_; }
  Value& value(int id) { return program_.values[static_cast<size_t>(id)]; }

  /// Counts elements that the program or its layouts keep. Throws LoadError, with `what`, if all
  /// together exceed the bounds (limits.h).
  void spend(int64_t elements, const std::string& what);

  /// Adds a value to the program and returns its index. Throws LoadError if it exceeds the bounds.
  int add_value(const std::array<int64_t, 4>& dims, ElementType type = ElementType::kFloat32,
                float scale = 1.0F);
  void define(const std::string& name, Symbol symbol) { symbols_[name] = std::move(symbol); }
  /// Adds a value, defines the node's output as its activation and returns its index.
  int define_value(const Node& node, const std::array<int64_t, 4>& dims,
                   ElementType type = ElementType::kFloat32, float scale = 1.0F);

  /// Defines the node's output as another name for the elements of its input 0. A read of the
  /// output counts as a read of the input.
  void define_alias(const Node& node, Symbol symbol);

  /// The symbol or the constant of a name, or null if there is none.
  const Symbol* find(const std::string& name) const;
  const Tensor* constant(const std::string& name) const;

  /// The node's input i. Each function throws LoadError if the input is of another kind; `what`
  /// names the input in the message.
  const Symbol& symbol(const Node& node, size_t i) const;
  const Tensor& constant_input(const Node& node, size_t i, const char* what) const;
  const Activation& real_activation(const Node& node, size_t i) const;

  /// A value [n, c, h, w] with the elements of the activation in row-major order. Adds a
  /// RearrangeStep if the layout requires one.
  int materialize(const Node& node, const Activation& activation);
  int materialized_input(const Node& node, size_t i);
  /// The value converted to float, or the value itself if it is float.
  int as_float(int value);

  /// The step that computes the activation, if another operation can be folded into it: nothing
  /// else reads the activation, it is not rounded and its layout is unchanged. Otherwise it returns
  /// null.
  Step* foldable_step(const std::string& name, const Activation& activation);
  /// The step that computes the value, or null for a model input.
  Step* producer_of(int value);
  /// Moves the step to the end of the program, so that it can read every value computed so far.
  Step* move_to_end(Step* step);

 private:
  bool is_read(int value) const;

  const Graph& graph_;
  Program program_;
  std::map<std::string, Symbol> symbols_;
  std::map<std::string, int> use_count_;  ///< how often each name of the graph is read
  int64_t elements_ = 0;                  ///< what spend() has counted
};

}  // namespace bevloc::nn
