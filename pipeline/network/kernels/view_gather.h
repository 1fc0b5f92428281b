// The inner loops of the view transform, one implementation per instruction set.
#pragma once

#include <cstddef>

#include "pipeline/network/model/graph.h"

namespace bevloc::nn {

class ViewEntries;

/// Computes what gather_view() in view_transform.h describes.
using Gather = void (*)(const ViewEntries& entries, const std::byte* features, int channels,
                        float scale, int begin, int end, std::byte* bev);

/// The fastest function that this CPU supports.
Gather gather_for(ElementType input, ElementType output);

/// The function in plain C++, and the one with vector instructions (AVX2 or NEON). The latter is
/// null on a CPU without them.
Gather gather_plain(ElementType input, ElementType output);
Gather gather_vector(ElementType input, ElementType output);

}  // namespace bevloc::nn
