// Parses a text that holds exactly one YAML document.
#pragma once

#include <string>

#include <yaml-cpp/yaml.h>

#include "common/result.h"

namespace bevloc {

/// Fails if the text is not YAML or holds no document or several. Messages show `name` as the file.
Result<YAML::Node> parse_document(const std::string& text, const std::string& name);

}  // namespace bevloc
