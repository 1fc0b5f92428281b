#include "common/version.h"

namespace bevloc {

std::string_view version() {
  return BEVLOC_VERSION;
}

}  // namespace bevloc
