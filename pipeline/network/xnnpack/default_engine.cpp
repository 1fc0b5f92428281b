// Compiled where BEVLOC_ENGINE is xnnpack.
#include "pipeline/network/xnnpack/xnnpack_engine.h"

namespace bevloc::nn {

std::unique_ptr<Engine> make_default_engine(const Program& program,
                                            std::span<const Branch> branches, int view_cells,
                                            const EngineOptions& options) {
  return make_xnnpack_engine(program, branches, view_cells, options);
}

}  // namespace bevloc::nn
