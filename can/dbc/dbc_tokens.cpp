#include "can/dbc/dbc_tokens.h"

#include <utility>

namespace bevloc::can {
namespace {

constexpr std::string_view kSigns = ":;,|@()[]";

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/// Whether a line ends with the first character: LF, CR LF, or CR alone.
bool ends_line(std::string_view text) {
  return text[0] == '\n' || (text[0] == '\r' && !text.starts_with("\r\n"));
}

}  // namespace

DbcToken DbcTokens::take() {
  DbcToken taken = std::move(next_);
  advance();
  return taken;
}

void DbcTokens::skip_space() {
  while (!rest_.empty() && is_space(rest_[0])) {
    if (ends_line(rest_)) {
      ++line_;
      starts_line_ = true;
    }
    rest_.remove_prefix(1);
  }
}

/// Returns nothing if no quote closes the text.
std::optional<std::string> DbcTokens::take_text() {
  std::string text;
  rest_.remove_prefix(1);
  while (!rest_.empty() && rest_[0] != '"') {
    const bool escaped =
        rest_[0] == '\\' && rest_.size() > 1 && (rest_[1] == '"' || rest_[1] == '\\');
    if (escaped) rest_.remove_prefix(1);
    if (ends_line(rest_)) ++line_;
    text += rest_[0];
    rest_.remove_prefix(1);
  }
  if (rest_.empty()) return std::nullopt;
  rest_.remove_prefix(1);
  return text;
}

void DbcTokens::advance() {
  skip_space();
  next_ = {.kind = DbcToken::Kind::kEnd, .text = {}, .line = line_, .starts_line = starts_line_};
  starts_line_ = false;
  if (rest_.empty()) return;
  if (rest_[0] == '"') {
    next_.kind = DbcToken::Kind::kText;
    if (auto text = take_text()) {
      next_.text = std::move(*text);
    } else {
      next_.kind = DbcToken::Kind::kEnd;
      next_.text = "\"";
    }
    return;
  }
  size_t length = 1;
  next_.kind = DbcToken::Kind::kSign;
  if (kSigns.find(rest_[0]) == std::string_view::npos) {
    next_.kind = DbcToken::Kind::kWord;
    while (length < rest_.size() && !is_space(rest_[length]) && rest_[length] != '"' &&
           kSigns.find(rest_[length]) == std::string_view::npos) {
      ++length;
    }
  }
  next_.text = std::string(rest_.substr(0, length));
  rest_.remove_prefix(length);
}

std::string describe(const DbcToken& token) {
  constexpr size_t kLongest = 40;
  if (token.kind == DbcToken::Kind::kEnd) {
    return token.text.empty() ? "the end of the file" : "a quote that nothing closes";
  }
  const std::string shown =
      token.text.size() <= kLongest ? token.text : token.text.substr(0, kLongest) + "...";
  return token.kind == DbcToken::Kind::kText ? fmt::format("\"{}\"", shown) : shown;
}

}  // namespace bevloc::can
