// Parses a text that holds one YAML document.
#pragma once

#include <string>

#include <yaml-cpp/yaml.h>

#include "common/result.h"

namespace bevloc {

/// Fails if the text is not YAML, holds no document or several. Messages show `name` as the file.
/// A `---` at the end of a file, as `rostopic echo` writes it, begins no other document.
Result<YAML::Node> parse_document(const std::string& text, const std::string& name);

}  // namespace bevloc
