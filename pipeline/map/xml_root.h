// Parses XML files that have a known outermost element.
#pragma once

#include <string>
#include <string_view>

#include <pugixml.hpp>

#include "common/result.h"

namespace bevloc {

/// A format of XML files.
struct XmlFormat {
  const char* name;
  const char* root;  ///< the name of the outermost element
};

/// Parses `text` into `document`, and returns the outermost element. Fails with file and line on
/// text that is not XML and on another outermost element.
Result<pugi::xml_node> parse_xml(std::string_view text, const std::string& file,
                                 const XmlFormat& format, pugi::xml_document& document);

}  // namespace bevloc
