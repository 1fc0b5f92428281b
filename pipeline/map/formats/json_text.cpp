#include "pipeline/map/formats/json_text.h"

#include <algorithm>
#include <charconv>

namespace bevloc {
namespace {

constexpr int kDeepest = 64;

/// Whether the brackets outside strings are nested deeper than kDeepest.
bool is_too_deep(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepest) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

/// Walks over text that is known to be JSON.
class JsonWalker {
 public:
  explicit JsonWalker(std::string_view text) : text_(text) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
  }

  size_t at() {
    skip_space();
    return at_;
  }

  /// Moves to the value of a key, or to an item of an array. Returns false if there is none.
  bool enter(std::string_view token) {
    const bool is_object = text_[at()] == '{';
    if (!is_object && text_[at_] != '[') return false;
    size_t index = 0;
    std::from_chars(token.data(), token.data() + token.size(), index);
    ++at_;
    for (size_t i = 0; text_[at()] != '}' && text_[at_] != ']'; ++i) {
      bool is_here = !is_object && i == index;
      if (is_object) {
        const size_t key = at_ + 1;
        skip_value();
        is_here = text_.substr(key, at_ - 1 - key) == token;
        skip_space();
        ++at_;  // skips the colon
      }
      if (is_here) return true;
      skip_value();
      if (text_[at()] == ',') ++at_;
    }
    return false;
  }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  void skip_space() {
    while (at_ + 1 < text_.size() && is_space(text_[at_])) ++at_;
  }

  void skip_string() {
    for (++at_; text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\') ++at_;
    }
    ++at_;
  }

  void skip_value() {
    int depth = 0;
    skip_space();
    do {
      const char c = text_[at_];
      if (c == '"') {
        skip_string();
        continue;
      }
      if (c == '{' || c == '[') ++depth;
      if (c == '}' || c == ']') --depth;
      ++at_;
    } while (depth > 0 || !is_end_of_value());
  }

  bool is_end_of_value() const {
    return at_ >= text_.size() ||
           std::string_view(",:]} \t\r\n").find(text_[at_]) != std::string_view::npos;
  }

  std::string_view text_;
  size_t at_ = 0;
};

/// What the parser found wrong, without its own name and place before the first colon.
std::string_view reason_of(const nlohmann::json::parse_error& error) {
  constexpr size_t kMostLetters = 200;
  const std::string_view text = error.what();
  const size_t colon = text.find(": ");
  return text.substr(colon == std::string_view::npos ? 0 : colon + 2, kMostLetters);
}

/// The line (from 1) of a byte of a text.
int line_of_byte(std::string_view text, size_t byte) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
  return static_cast<int>(std::count(text.begin(), end, '\n')) + 1;
}

}  // namespace

Result<JsonText> JsonText::parse(std::string_view text, const std::string& file) {
  if (is_too_deep(text)) {
    return fail("{}: found more than {} brackets within each other, wanted a map", file, kDeepest);
  }
  JsonText parsed(text, file);
  try {
    parsed.root_ = nlohmann::json::parse(text.begin(), text.end());
  } catch (const nlohmann::json::parse_error& error) {
    const size_t byte = error.byte > 0 ? error.byte - 1 : 0;
    return fail("{}:{}: byte {}: found text that is not JSON ({}), wanted a JSON map", file,
                line_of_byte(text, byte), byte, reason_of(error));
  } catch (const nlohmann::json::exception& error) {
    return fail("{}: found JSON that cannot be read ({}), wanted a JSON map", file, error.what());
  }
  return parsed;
}

std::string JsonText::place(const nlohmann::json::json_pointer& path) const {
  std::vector<std::string> tokens;
  for (auto rest = path; !rest.empty(); rest.pop_back()) tokens.push_back(rest.back());
  JsonWalker walker(text_);
  for (auto token = tokens.rbegin(); token != tokens.rend() && walker.enter(*token); ++token) {
  }
  return fmt::format("{}:{}: {}", file_, line_of_byte(text_, walker.at()), path.to_string());
}

}  // namespace bevloc
