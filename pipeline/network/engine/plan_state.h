// State of the planning for oneDNN: the plan so far, and which buffer holds each value.
#pragma once

#include <initializer_list>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <dnnl.hpp>

#include "pipeline/network/engine/execution_plan.h"
#include "pipeline/network/model/program.h"
#include "pipeline/network/plan/storage_plan.h"

namespace bevloc::nn::onednn {

class PlanState {
 public:
  /// `program` and `engine` must outlive the state.
  PlanState(const Program& program, size_t branches, const dnnl::engine& engine);

  const Program& program() const { return program_; }
  const dnnl::engine& engine() const { return engine_; }
  ExecutionPlan& plan() { return plan_; }
  StoragePlan& storages() { return storages_; }

  const Value& value(int id) const { return program_.values[static_cast<size_t>(id)]; }
  /// The layout of a value in a dense buffer.
  MemoryDesc dense(int id, dnnl::memory::format_tag tag) const;

  const MemoryDesc& desc(int buffer) const { return plan_.buffers[buffer].desc; }
  size_t storage(int buffer) const { return plan_.buffers[buffer].storage; }

  /// Adds a buffer in a storage of its own, or in the storage of another buffer.
  int new_buffer(const MemoryDesc& desc);
  int new_buffer_over(int buffer, const MemoryDesc& desc);

  /// The buffer that the producer of the value wrote.
  int buffer_of(int id) const { return buffer_of_value_[static_cast<size_t>(id)]; }
  /// Sets the buffer of the value. Returns `buffer`.
  int set_buffer_of(int id, int buffer) {
    return buffer_of_value_[static_cast<size_t>(id)] = buffer;
  }
  /// The buffer of the value in another layout. It is a copy, which is made once per branch.
  int buffer_in(int id, const MemoryDesc& wanted);
  /// A copy of the value with `offset` added to its elements, which makes them unsigned.
  int offset_copy(int id, const MemoryDesc& wanted, int offset);

  /// Adds a task to the current branch. `used` are the buffers that it reads or writes.
  void push(std::unique_ptr<Task> task, std::initializer_list<int> used);
  void push_primitive(Primitive primitive, std::vector<PrimitiveTask::BufferArgument> arguments);
  void push_copy(int from, const MemoryDesc& from_desc, int to, const MemoryDesc& to_desc,
                 Conversion conversion = {});

 private:
  const Program& program_;
  const dnnl::engine& engine_;
  std::vector<int> buffer_of_value_;
  std::map<std::pair<int, size_t>, std::vector<int>> copies_;  ///< copies by value and branch
  ExecutionPlan plan_;
  StoragePlan storages_;
};

}  // namespace bevloc::nn::onednn
