// The view transform's inner loops, once for each instruction set.
#pragma once

#include <cstddef>

#include "pipeline/network/graph.h"

namespace bevloc::nn {

class ViewEntries;

/// See gather_view() in view_transform.h.
using Gather = void (*)(const ViewEntries& entries, const std::byte* features, int channels,
                        float scale, int begin, int end, std::byte* bev);

/// The fastest that this CPU can run.
Gather gather_for(ElementType input, ElementType output);

/// By instruction set; the AVX2 one is null elsewhere.
Gather gather_plain(ElementType input, ElementType output);
Gather gather_avx2(ElementType input, ElementType output);

}  // namespace bevloc::nn
