#include "common/yaml_text.h"

#include <optional>
#include <sstream>

#include <yaml-cpp/eventhandler.h>

namespace bevloc {
namespace {

/// Notes where a document and its content begin, and keeps nothing else of it.
class PlaceHandler : public YAML::EventHandler {
 public:
  /// Position of the document in the text, in characters.
  int start() const { return start_; }
  /// The line of the content, counted from 1, or nothing for an empty document.
  std::optional<int> content_line() const { return content_line_; }

 private:
  using Mark = YAML::Mark;
  using Text = std::string;
  using Style = YAML::EmitterStyle::value;
  void OnDocumentStart(const Mark& mark) override {
    start_ = mark.pos;
    content_line_.reset();
  }
  void OnDocumentEnd() override {}
  void OnNull(const Mark&, YAML::anchor_t) override {}
  void OnAlias(const Mark& mark, YAML::anchor_t) override { note(mark); }
  void OnScalar(const Mark& mark, const Text&, YAML::anchor_t, const Text&) override { note(mark); }
  void OnSequenceStart(const Mark& mark, const Text&, YAML::anchor_t, Style) override {
    note(mark);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const Mark& mark, const Text&, YAML::anchor_t, Style) override { note(mark); }
  void OnMapEnd() override {}

  void note(const Mark& mark) {
    if (!content_line_) content_line_ = mark.line + 1;
  }

  int start_ = 0;
  std::optional<int> content_line_;
};

/// Fails unless the text holds one document. Empty documents may follow.
Status check_documents(const std::string& text, const std::string& name) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  PlaceHandler place;
  if (!parser.HandleNextDocument(place)) {
    return fail("{}: found 0 YAML documents, wanted one", name);
  }
  for (int last = place.start(); parser.HandleNextDocument(place); last = place.start()) {
    if (place.content_line()) {
      return fail(
          "{}:{}: found a second document, wanted one in each file; split the file at its "
          "`---`",
          name, *place.content_line());
    }
    // From some texts, such as a single comma, the parser reads the same empty document forever.
    if (place.start() == last) {
      return fail("{}: found text that is not YAML, wanted YAML or JSON", name);
    }
  }
  return {};
}

}  // namespace

Result<YAML::Node> parse_document(const std::string& text, const std::string& name) {
  try {
    if (Status checked = check_documents(text, name); !checked) {
      return tl::unexpected(checked.error());
    }
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    return fail("{}:{}: found text that is not YAML ({}), wanted YAML or JSON", name,
                error.mark.line + 1, error.msg);
  }
}

}  // namespace bevloc
