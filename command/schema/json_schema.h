// Writes the JSON Schema of a YAML file, made from the function that reads its keys.
#pragma once

#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "command/schema/reader_passes.h"

namespace bevloc::command {

/// The texts that editors and manuals show about a file.
struct SchemaTexts {
  std::string title;
  /// Returns the description of a key by its path, or an empty text if there is none.
  std::function<std::string(const std::string& path)> describe;
};

/// Returns a JSON Schema of draft 7, which editors know best. It accepts every file that the reader
/// accepts. The reader refuses more, such as a key that occurs twice, or values that contradict
/// each other, such as wait_ms below tolerance_ms. In the schema a text may be a number, because
/// the reader takes `line: 17` as a name.
nlohmann::ordered_json schema_of(const KeyReader& reader, const SchemaTexts& texts);

}  // namespace bevloc::command
