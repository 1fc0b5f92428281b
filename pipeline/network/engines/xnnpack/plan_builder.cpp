#include "pipeline/network/engines/xnnpack/plan_builder.h"

#include <algorithm>
#include <map>

#include "pipeline/network/engines/xnnpack/convolution.h"
#include "pipeline/network/engines/xnnpack/movement.h"
#include "pipeline/network/engines/xnnpack/sampling.h"
#include "pipeline/network/engines/xnnpack/sum.h"
#include "pipeline/network/plan/schedule.h"
#include "pipeline/network/plan/storage_plan.h"

namespace bevloc::nn::xnnpack {
namespace {

bool is_float(const Value& value) {
  return value.type == ElementType::kFloat32;
}

size_t channels(const Value& value) {
  return static_cast<size_t>(value.dims[1]);
}

/// Adds the tasks of each step to the plan.
class PlanBuilder {
 public:
  PlanBuilder(const Program& program, std::span<const Branch> branches, const ViewEntries& entries)
      : program_(program),
        entries_(entries),
        schedule_(make_schedule(program, branches)),
        storage_of_value_(program.values.size()) {
    plan_.branches.resize(branches.size());
  }
  ExecutionPlan build();

 private:
  void add(const ConvStep& step);
  void add(const MaxPoolStep& step);
  void add(const UpsampleStep& step);
  void add(const AddStep& step);
  void add(const ReluStep& step);
  void add(const ConvertStep& step);
  void add(const RearrangeStep& step);
  void add(const ConcatStep& step);
  void add(const ViewStep& step);
  void add_output(size_t output);

  const Value& value(int id) const { return program_.values[static_cast<size_t>(id)]; }
  size_t& storage_of(int id) { return storage_of_value_[static_cast<size_t>(id)]; }
  /// The storage that holds the value as an activation. Imports a model input once per branch.
  size_t source(int id);
  /// Adds a storage for the value, which the current task computes.
  size_t destination(int id);
  /// The elements of the value as floats with zero point 0.
  size_t widened(int id);
  /// A sum without an output storage.
  Sum sum_of(const Term& left, int output) const;
  /// The value as a term of a sum.
  Term term(int id) { return {source(id), value(id).type, {value(id).scale}}; }

  void push(std::unique_ptr<Task> task, std::initializer_list<size_t> used);
  void push(const Sum& sum);

  const Program& program_;
  const ViewEntries& entries_;
  const Schedule schedule_;
  std::vector<size_t> storage_of_value_;               ///< a model input has the declared layout
  std::map<std::pair<int, size_t>, size_t> imported_;  ///< inputs as activations, by branch
  ExecutionPlan plan_;
  StoragePlan storages_;
};

ExecutionPlan PlanBuilder::build() {
  for (const ProgramPort& input : program_.inputs) {
    const size_t storage = destination(input.value);
    storages_.keep(storage);
    plan_.input_storages.push_back(storage);
  }
  plan_.output_storages.resize(program_.outputs.size());
  walk(
      program_, schedule_, plan_.branches.size(), storages_,
      [this](const Step& step, size_t) {
        std::visit([this](const auto& known) { add(known); }, step);
      },
      [this](size_t output) { add_output(output); });
  plan_.storages = storages_.lifetimes();
  return std::move(plan_);
}

void PlanBuilder::push(std::unique_ptr<Task> task, std::initializer_list<size_t> used) {
  for (const size_t storage : used) storages_.use(storage);
  plan_.branches[storages_.branch()].push_back(std::move(task));
  storages_.next_task();
}

void PlanBuilder::push(const Sum& sum) {
  push(make_sum(sum),
       {sum.left.storage, sum.right ? sum.right->storage : sum.left.storage, sum.output});
}

size_t PlanBuilder::source(int id) {
  const bool is_input =
      std::ranges::find(program_.inputs, id, &ProgramPort::value) != program_.inputs.end();
  if (!is_input) return storage_of(id);
  const std::pair key(id, storages_.branch());
  if (const auto known = imported_.find(key); known != imported_.end()) return known->second;
  const size_t storage = storages_.add(size_in_bytes(value(id)));
  push(import_input(value(id), storage_of(id), storage), {storage_of(id), storage});
  return imported_[key] = storage;
}

size_t PlanBuilder::destination(int id) {
  return storage_of(id) = storages_.add(size_in_bytes(value(id)));
}

size_t PlanBuilder::widened(int id) {
  Term elements_only = term(id);
  elements_only.scale = {1.0F};
  Sum sum = sum_of(elements_only, id);
  sum.output = storages_.add(element_count(value(id)) * sizeof(float));
  sum.output_type = ElementType::kFloat32;
  sum.output_scale = 1.0F;
  push(sum);
  return sum.output;
}

Sum PlanBuilder::sum_of(const Term& left, int output) const {
  const Value& to = value(output);
  Sum sum;
  sum.left = left;
  sum.output_type = to.type;
  sum.output_scale = to.scale;
  sum.channels = channels(to);
  sum.pixels = element_count(to) / sum.channels;
  return sum;
}

void PlanBuilder::add(const ConvStep& step) {
  const Value& input = value(step.input);
  const Value& output = value(step.output);
  const bool is_int8 = step.weights.type == ElementType::kInt8;
  if (is_int8 && !is_float(output) && step.residual < 0) {
    const size_t from = source(step.input);
    const size_t to = destination(step.output);
    return push(quantized_convolution(step, input, output, from, to), {from, to});
  }
  // XNNPACK's int8 operators round immediately and cannot add a residual. A convolution with a
  // residual or with a float output computes its sums of products in float.
  const size_t from = is_int8 ? widened(step.input) : source(step.input);
  const size_t sums = storages_.add(element_count(output) * sizeof(float));
  const bool is_final = !is_int8 && step.residual < 0;
  push(float_convolution(step, input, is_final && step.relu, from, sums), {from, sums});
  storage_of(step.output) = sums;
  if (is_final) return;
  Sum sum = sum_of({sums, ElementType::kFloat32, sum_scale(step, input)}, step.output);
  if (step.residual >= 0) sum.right = term(step.residual);
  sum.relu = step.relu;
  sum.output = is_float(output) ? sums : destination(step.output);
  push(sum);
}

void PlanBuilder::add(const MaxPoolStep& step) {
  const size_t from = source(step.input);
  const size_t to = destination(step.output);
  push(max_pool(step, value(step.input), value(step.output), from, to), {from, to});
}

void PlanBuilder::add(const UpsampleStep& step) {
  const size_t from = source(step.input);
  const size_t to = destination(step.output);
  push(upsampling(step.linear, value(step.input), from, to), {from, to});
}

void PlanBuilder::add(const AddStep& step) {
  Sum sum = sum_of(term(step.left), step.output);
  sum.right = term(step.right);
  sum.relu = step.relu;
  sum.output = destination(step.output);
  push(sum);
}

void PlanBuilder::add(const ReluStep& step) {
  Sum sum = sum_of(term(step.input), step.output);
  sum.relu = true;
  sum.output = destination(step.output);
  push(sum);
}

void PlanBuilder::add(const ConvertStep& step) {
  Sum sum = sum_of(term(step.input), step.output);
  sum.output = destination(step.output);
  push(sum);
}

void PlanBuilder::add(const RearrangeStep& step) {
  const size_t from = source(step.input);
  const size_t to = destination(step.output);
  push(rearrangement(step, value(step.input), value(step.output), from, to), {from, to});
}

void PlanBuilder::add(const ConcatStep& step) {
  const Value& output = value(step.output);
  const size_t to_bytes = channels(output) * size_in_bytes(output.type);
  const size_t pixels = element_count(output) / channels(output);
  std::vector<size_t> parts;
  for (const int id : step.inputs) parts.push_back(source(id));
  const size_t to = destination(step.output);
  size_t place = 0;
  for (size_t i = 0; i < parts.size(); ++i) {
    const size_t bytes = channels(value(step.inputs[i])) * size_in_bytes(output.type);
    push(channel_copy(pixels, parts[i], bytes, to, to_bytes, place), {parts[i], to});
    place += bytes;
  }
}

void PlanBuilder::add(const ViewStep& step) {
  const Value& features = value(step.input);
  size_t from = source(step.input);
  if (features.type == ElementType::kUint8) {
    const size_t as_uint8 = storages_.add(element_count(features));
    push(shift_by_128(from, as_uint8, element_count(features)), {from, as_uint8});
    from = as_uint8;
  }
  const size_t to = destination(step.output);
  push(view_gather(features, value(step.output), entries_, from, to), {from, to});
}

/// Copies an output to dense floats, which stay until its branch runs again.
void PlanBuilder::add_output(size_t output) {
  const int id = program_.outputs[output].value;
  const size_t from = source(id);
  const size_t to = storages_.add(element_count(value(id)) * sizeof(float));
  push(export_output(value(id), from, to), {from, to});
  storages_.keep(to);
  plan_.output_storages[output] = to;
}

}  // namespace

ExecutionPlan build_plan(const Program& program, std::span<const Branch> branches,
                         const ViewEntries& entries) {
  return PlanBuilder(program, branches, entries).build();
}

}  // namespace bevloc::nn::xnnpack
