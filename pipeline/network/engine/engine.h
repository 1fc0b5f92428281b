// Executes a program with oneDNN and our own kernels. oneDNN compiles its kernels for the CPU at
// load.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pipeline/network/engine/loop_body.h"
#include "pipeline/network/kernels/cpu_isa.h"
#include "pipeline/network/kernels/view_transform.h"
#include "pipeline/network/model/program.h"
#include "pipeline/network/plan/branch.h"
#include "pipeline/network/plan/memory_plan.h"
#include "pipeline/network/view/view_table.h"

namespace bevloc::nn {

namespace onednn {
struct ExecutionPlan;
}

struct EngineOptions {
  int threads = 1;
  /// Applies to the whole process; a request for another cap throws LoadError.
  IsaCap isa = IsaCap::kBest;
  /// Whether our own kernels run where they are faster than oneDNN.
  bool own_kernels = true;
};

/// Chooses all memory, layouts and kernels when it is constructed. Our code does not allocate in
/// run(), but oneDNN 2.6 allocates a small table of arguments for each primitive that it executes.
/// One thread, although a branch runs on `threads` OpenMP threads. Two engines share no memory.
class Engine {
 public:
  /// `view_cells` is the number of BEV cells in the view table, or 0 if the program has no view
  /// transform. Each output of the program must be in exactly one branch. Throws LoadError.
  Engine(const Program& program, std::span<const Branch> branches, int view_cells,
         const EngineOptions& options);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// The memory of an input. It is dense and has the shape and element type that the model
  /// declares. The engine keeps the content until the caller overwrites it.
  std::span<std::byte> input(const std::string& name);
  /// The real values of an output, dense. They are valid until the branch of the output runs again.
  std::span<const float> output(const std::string& name) const;

  /// Copies the table; does not allocate. Before the first call, all BEV features are 0.
  void set_view_table(const ViewTable& table) { view_entries_.set(table); }

  /// Runs one branch, given by its index at construction. Branches that it reads must run before.
  void run(size_t branch);

  /// Calls body(i) for each i in [0, count), in any order, on the threads of run(). `body` must not
  /// throw.
  void parallel_for(int count, LoopBody body);

  /// Bytes of all activations, and what they would take if no memory were reused.
  size_t arena_bytes() const { return arena_bytes_; }
  size_t bytes_without_reuse() const { return bytes_without_reuse_; }

 private:
  struct Port {
    std::string name;
    std::span<std::byte> memory;
  };
  struct AlignedFree {
    void operator()(std::byte* memory) const;
  };
  struct Execution;  ///< the objects of oneDNN

  /// Allocates the arena, filled with zeros, and returns the address of each storage in it.
  std::vector<std::byte*> allocate(std::span<const Lifetime> storages);
  /// Gives every task and port its memory.
  void bind(const Program& program, onednn::ExecutionPlan& plan);

  int threads_;
  ViewEntries view_entries_;
  std::unique_ptr<std::byte[], AlignedFree> arena_;
  std::vector<Port> inputs_;
  std::vector<Port> outputs_;
  size_t arena_bytes_ = 0;
  size_t bytes_without_reuse_ = 0;
  std::unique_ptr<Execution> execution_;
};

}  // namespace bevloc::nn
