// What runs a program: all memory, layouts and kernels are settled when it is made.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pipeline/network/cpu_isa.h"
#include "pipeline/network/memory_plan.h"
#include "pipeline/network/program.h"
#include "pipeline/network/turn.h"
#include "pipeline/network/view_table.h"
#include "pipeline/network/view_transform.h"

namespace bevloc::nn {

/// Output names that are computed together. A branch may read what earlier branches computed.
using Branch = std::vector<std::string>;

struct EngineOptions {
  int threads = 1;
  IsaCap isa = IsaCap::kBest;
  /// Whether our own kernels may do what they do faster than the engine's library.
  bool own_kernels = true;
};

/// Not thread safe. Two engines do not share memory.
class Engine {
 public:
  virtual ~Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// The input's elements as the model declares them, dense. Kept until overwritten.
  std::span<std::byte> input(const std::string& name);
  /// Dense real values, valid until their branch runs again.
  std::span<const float> output(const std::string& name) const;

  /// Until the first call no camera sees anything. Copies the table, allocates nothing.
  void set_view_table(const ViewTable& table) { view_entries_.set(table); }

  /// Runs one of the branches that the engine was made for, after those that it reads from.
  virtual void run(size_t branch) = 0;

  /// Other work on the threads of run(): turn(i) for i from 0 up to `count`, in any order. It must
  /// not throw.
  virtual void for_each_turn(int count, Turn turn) = 0;

  /// Bytes of all activations together, and the same without reuse.
  size_t arena_bytes() const { return arena_bytes_; }
  size_t bytes_without_reuse() const { return bytes_without_reuse_; }

 protected:
  explicit Engine(int view_cells) : view_entries_(view_cells) {}

  const ViewEntries& view_entries() const { return view_entries_; }

  /// Gives each storage its place, filled with zeros. Called once.
  std::vector<std::byte*> place(std::span<const Lifetime> storages);
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

/// How an engine is made. `view_cells`: BEV cells of the view table, 0 if the program has no view
/// transform. Each output of the program must be in one branch. Throws LoadError.
using MakeEngine = std::unique_ptr<Engine>(const Program& program, std::span<const Branch> branches,
                                           int view_cells, const EngineOptions& options);

/// The engine that this build was configured for (CMake's BEVLOC_ENGINE).
MakeEngine make_default_engine;

}  // namespace bevloc::nn
