// Defines the default engine: the one that CMake's BEVLOC_ENGINE selects.
#include "pipeline/network/engines/engine.h"
#include "pipeline/network/engines/onednn/onednn_engine.h"
#include "pipeline/network/engines/xnnpack/xnnpack_engine.h"

namespace bevloc::nn {

std::unique_ptr<Engine> make_default_engine(const Program& program,
                                            std::span<const Branch> branches, int view_cells,
                                            const EngineOptions& options) {
  return BEVLOC_MAKE_DEFAULT_ENGINE(program, branches, view_cells, options);
}

}  // namespace bevloc::nn
