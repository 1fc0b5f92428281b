// Interface of the engines, which execute a program. An engine chooses all memory, layouts and
// kernels when it is constructed.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pipeline/network/engines/cpu_isa.h"
#include "pipeline/network/engines/parallel_for.h"
#include "pipeline/network/model/program.h"
#include "pipeline/network/plan/memory_plan.h"
#include "pipeline/network/view/view_table.h"
#include "pipeline/network/view/view_transform.h"

namespace bevloc::nn {

/// Names of the outputs that one branch computes. A branch may read results of earlier branches.
using Branch = std::vector<std::string>;

struct EngineOptions {
  int threads = 1;
  IsaCap isa = IsaCap::kBest;
  /// Whether the engine may use our own kernels where they are faster than its library.
  bool own_kernels = true;
};

/// Not thread safe. Two engines share no memory.
class Engine {
 public:
  virtual ~Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Memory of an input: dense, with the shape and element type that the model declares. The engine
  /// keeps the content until the caller overwrites it.
  std::span<std::byte> input(const std::string& name);
  /// Real values of an output, dense. Valid until the branch of the output runs again.
  std::span<const float> output(const std::string& name) const;

  /// Copies the table; does not allocate. Before the first call, all BEV features are 0.
  void set_view_table(const ViewTable& table) { view_entries_.set(table); }

  /// Runs one branch, given by its index at construction. Branches that it reads must run before.
  virtual void run(size_t branch) = 0;

  /// Calls body(i) for each i in [0, count), in any order, on the threads of run(). `body` must not
  /// throw.
  virtual void parallel_for(int count, LoopBody body) = 0;

  /// Bytes of all activations, and what they would take if no memory were reused.
  size_t arena_bytes() const { return arena_bytes_; }
  size_t bytes_without_reuse() const { return bytes_without_reuse_; }

 protected:
  explicit Engine(int view_cells) : view_entries_(view_cells) {}

  const ViewEntries& view_entries() const { return view_entries_; }

  /// Allocates the arena, filled with zeros, and returns the address of each storage in it. Call
  /// once.
  std::vector<std::byte*> allocate(std::span<const Lifetime> storages);
  void add_input(const std::string& name, std::span<std::byte> memory);
  void add_output(const std::string& name, std::span<std::byte> memory);

 private:
  struct Port {
    std::string name;
    std::span<std::byte> memory;
  };
  struct AlignedFree {
    void operator()(std::byte* memory) const;
  };

  ViewEntries view_entries_;
  std::unique_ptr<std::byte[], AlignedFree> arena_;
  std::vector<Port> inputs_;
  std::vector<Port> outputs_;
  size_t arena_bytes_ = 0;
  size_t bytes_without_reuse_ = 0;
};

/// Type of the functions that make an engine. `view_cells`: number of BEV cells in the view table,
/// 0 if the program has no view transform. Each output of the program must be in exactly one
/// branch. Throws LoadError.
using MakeEngine = std::unique_ptr<Engine>(const Program& program, std::span<const Branch> branches,
                                           int view_cells, const EngineOptions& options);

/// Makes the engine that CMake's BEVLOC_ENGINE selects.
MakeEngine make_default_engine;

}  // namespace bevloc::nn
