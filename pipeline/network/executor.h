// Runs a program with oneDNN on a static plan: all memory, layouts and kernels are settled at load.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include <dnnl.hpp>

#include "pipeline/network/plan_builder.h"
#include "pipeline/network/view_table.h"

namespace bevloc::nn {

/// run() allocates nothing of its own; oneDNN 2.6 makes a small table of arguments for each
/// primitive it executes. Not thread safe; a branch uses `threads` OpenMP threads.
class Executor {
 public:
  /// `view_cells`: BEV cells of the view table, 0 if the program has no view transform. Each output
  /// must be in one branch. Throws LoadError or dnnl::error.
  Executor(const Program& program, std::span<const Branch> branches, int view_cells, int threads);

  /// The input's elements as the model declares them, dense. Kept until overwritten.
  std::span<std::byte> input(const std::string& name);
  /// Dense real values, valid until their branch runs again.
  std::span<const float> output(const std::string& name) const;

  /// Until the first call no camera sees anything.
  void set_view_table(const ViewTable& table) { view_entries_.set(table); }

  /// Branches run in the order in which they read from one another.
  void run(size_t branch);

  /// Bytes of all activations together, and the same without reuse.
  size_t arena_bytes() const { return arena_bytes_; }
  size_t bytes_without_reuse() const { return bytes_without_reuse_; }

 private:
  struct Port {
    std::string name;
    std::byte* data = nullptr;
    size_t bytes = 0;
  };
  struct AlignedFree {
    void operator()(std::byte* memory) const;
  };

  void place_buffers(ExecutionPlan& plan);

  int threads_;
  dnnl::engine engine_;
  dnnl::stream stream_;
  ViewEntries view_entries_;
  std::vector<std::vector<std::unique_ptr<Task>>> branches_;
  std::unique_ptr<std::byte[], AlignedFree> arena_;
  std::vector<Port> inputs_;
  std::vector<Port> outputs_;
  size_t arena_bytes_ = 0;
  size_t bytes_without_reuse_ = 0;
};

}  // namespace bevloc::nn
