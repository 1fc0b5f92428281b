// The engines of this build: one for each engine library that is installed.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "pipeline/network/engines/engine.h"
#include "pipeline/network/engines/onednn/onednn_engine.h"
#include "pipeline/network/engines/xnnpack/xnnpack_engine.h"

namespace bevloc::test {

struct NamedEngine {
  std::string name;
  nn::MakeEngine* make = nullptr;
};

inline std::vector<NamedEngine> engines() {
  std::vector<NamedEngine> engines;
#ifdef BEVLOC_HAS_ONEDNN
  engines.push_back({"onednn", nn::make_onednn_engine});
#endif
#ifdef BEVLOC_HAS_XNNPACK
  engines.push_back({"xnnpack", nn::make_xnnpack_engine});
#endif
  return engines;
}

}  // namespace bevloc::test
