#include "pipeline/map/xml_root.h"

#include <cstring>

#include "pipeline/map/text_lines.h"

namespace bevloc {

Result<pugi::xml_node> parse_xml(std::string_view text, const std::string& file,
                                 const XmlFormat& format, pugi::xml_document& document) {
  const pugi::xml_parse_result parsed =
      document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!parsed) {
    return fail("{}:{}: found text that is not XML ({}), wanted {} XML", file,
                LineFinder(text).line_at(parsed.offset), parsed.description(), format.name);
  }
  const pugi::xml_node root = document.document_element();
  if (std::strcmp(root.name(), format.root) != 0) {
    return fail("{}:{}: found <{}> as the outermost element, wanted <{}>", file,
                LineFinder(text).line_at(root.offset_debug()), root.name(), format.root);
  }
  return root;
}

}  // namespace bevloc
