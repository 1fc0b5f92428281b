// Parses a text that holds one YAML document.
#pragma once

#include <string>

#include <yaml-cpp/yaml.h>

#include "common/result.h"

namespace bevloc {

/// Fails if the text is not YAML, holds no document, or holds several. Empty documents may follow
/// the first: `rostopic echo` ends a file with `---`. Messages show `name` as the file. A JSON text
/// is YAML, too.
Result<YAML::Node> parse_document(const std::string& text, const std::string& name);

}  // namespace bevloc
