#include "common/yaml_text.h"

#include <sstream>

#include <yaml-cpp/eventhandler.h>

namespace bevloc {
namespace {

/// Takes a document apart and keeps nothing of it.
class IgnoringHandler : public YAML::EventHandler {
  using Mark = YAML::Mark;
  using Text = std::string;
  using Style = YAML::EmitterStyle::value;
  void OnDocumentStart(const Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const Mark&, YAML::anchor_t) override {}
  void OnAlias(const Mark&, YAML::anchor_t) override {}
  void OnScalar(const Mark&, const Text&, YAML::anchor_t, const Text&) override {}
  void OnSequenceStart(const Mark&, const Text&, YAML::anchor_t, Style) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const Mark&, const Text&, YAML::anchor_t, Style) override {}
  void OnMapEnd() override {}
};

/// The number of documents in a text, up to 2. YAML::LoadAll() reads documents without end from
/// some texts, such as a single comma.
int count_documents(const std::string& text) {
  constexpr int kEnough = 2;
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  IgnoringHandler handler;
  int count = 0;
  while (count < kEnough && parser.HandleNextDocument(handler)) ++count;
  return count;
}

}  // namespace

Result<YAML::Node> parse_document(const std::string& text, const std::string& name) {
  try {
    const int documents = count_documents(text);
    if (documents > 1) return fail("{}: found 2 YAML documents or more, wanted one", name);
    if (documents < 1) return fail("{}: found 0 YAML documents, wanted one", name);
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    return fail("{}:{}: found text that is not YAML ({}), wanted YAML", name, error.mark.line + 1,
                error.msg);
  }
}

}  // namespace bevloc
