// Plans the execution of a program by oneDNN: chooses memory layouts, primitives and kernels, and
// determines the lifetime of each buffer.
#pragma once

#include <span>

#include "pipeline/network/engine/engine.h"
#include "pipeline/network/engine/execution_plan.h"
#include "pipeline/network/kernels/strip_kernels.h"
#include "pipeline/network/model/program.h"

namespace bevloc::nn::onednn {

/// Every output must be in exactly one branch. `entries` must outlive the plan. `kernels` compute
/// the int8 convolutions that they support; if null, oneDNN computes all of them.
/// Throws LoadError or dnnl::error.
ExecutionPlan build_plan(const Program& program, std::span<const Branch> branches,
                         const dnnl::engine& engine, const ViewEntries& entries,
                         const KernelSet* kernels);

}  // namespace bevloc::nn::onednn
