// Writes the JSON Schema of a YAML file, made from the function that reads its keys.
#pragma once

#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "command/schema/reader_passes.h"

namespace bevloc::command {

/// What editors and manuals say about a file.
struct SchemaTexts {
  std::string title;
  /// The description of a key by its path; empty: none.
  std::function<std::string(const std::string& path)> describe;
};

/// JSON Schema draft 7, which editors know best. It accepts every file that the reader accepts. The
/// reader refuses more: a key that is there twice, and values that contradict each other, such as
/// wait_ms below tolerance_ms. A text may be a number in the schema, as the reader takes `line: 17`
/// for a name.
nlohmann::ordered_json schema_of(const KeyReader& reader, const SchemaTexts& texts);

}  // namespace bevloc::command
