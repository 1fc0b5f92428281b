// Takes the text of a DBC file apart into words, texts in quotes, and signs.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/result.h"

namespace bevloc::can {

struct DbcToken {
  enum class Kind { kWord, kText, kSign, kEnd };
  Kind kind = Kind::kEnd;
  /// The text without its quotes. For kEnd it is empty, or a quote if the file ends in a text that
  /// begins here.
  std::string text;
  int line = 1;
  bool starts_line = false;

  bool is_word(std::string_view word) const { return kind == Kind::kWord && text == word; }
  bool is_sign(char sign) const { return kind == Kind::kSign && text[0] == sign; }
};

/// Reads one token after the other. Never fails, because a text that no quote closes counts as the
/// end of the file. One thread.
class DbcTokens {
 public:
  /// `text` must outlive this.
  explicit DbcTokens(std::string_view text) : rest_(text) { advance(); }

  /// Returns the next token without taking it.
  const DbcToken& peek() const { return next_; }
  DbcToken take();

 private:
  void advance();
  void skip_space();
  std::optional<std::string> take_text();

  std::string_view rest_;
  int line_ = 1;
  bool starts_line_ = true;
  DbcToken next_;
};

/// The token as an error message shows it.
std::string describe(const DbcToken& token);

}  // namespace bevloc::can
