// The reader behind parse_dbc().
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "can/dbc/dbc.h"
#include "can/dbc/dbc_tokens.h"

namespace bevloc::can {

/// The exception that unwinds the reader. parse_dbc() catches it.
struct DbcMistake {
  Error error;
};

/// Reads one file. One thread.
class DbcReader {
 public:
  DbcReader(std::string_view text, const std::string& name) : tokens_(text) { dbc_.file = name; }

  Dbc read() {
    while (tokens_.peek().kind != DbcToken::Kind::kEnd) read_statement();
    if (!tokens_.peek().text.empty()) refuse(tokens_.peek(), "a statement");
    for (DbcMessage& message : dbc_.messages) complete(message);
    return std::move(dbc_);
  }

 private:
  std::string mistake(int line, std::string_view found, std::string_view wanted) const {
    return fmt::format("{}:{}: found {}, wanted {}", dbc_.file, line, found, wanted);
  }
  [[noreturn]] void refuse(int line, std::string_view found, std::string_view wanted) const {
    throw DbcMistake{{mistake(line, found, wanted)}};
  }
  [[noreturn]] void refuse(const DbcToken& token, std::string_view wanted) const {
    refuse(token.line, describe(token), wanted);
  }

  void read_statement();
  void read_message();
  void read_signal(DbcMessage& message);
  void read_multiplexing(DbcSignal& signal, DbcMessage& message);
  void skip_receivers();
  void leave_out(DbcMessage& message, int line, std::string_view found,
                 std::string_view wanted) const;
  void check_signal(const DbcSignal& signal, DbcMessage& message) const;
  void check_multiplexors(DbcMessage& message) const;
  void read_value_names();
  void read_value_type();
  void read_multiplexor_values();
  DbcValueRange take_range();
  void read_attribute_definition();
  void read_attribute_default();
  void read_attribute();
  void skip_statement(const std::string& keyword);
  void skip_unknown(const DbcToken& first);
  void skip_list(const std::string& keyword);
  void complete_value_names(DbcMessage& message) const;
  void complete(DbcMessage& message) const;

  std::string take_word(std::string_view wanted);
  void take_sign(char sign);
  double take_number(std::string_view wanted);
  uint64_t take_unsigned(std::string_view wanted);
  uint64_t unsigned_of(const DbcToken& token, std::string_view wanted) const;
  int64_t take_raw();
  DbcMessage* take_message();
  DbcSignal* take_signal_of(DbcMessage* message);
  bool next_is_number() const;
  std::string attribute_value(const std::string& name);

  DbcTokens tokens_;
  Dbc dbc_;
  std::map<std::string, std::vector<std::string>>
      enums_;  ///< names of the values of ENUM attributes
  std::set<std::string> message_attributes_;
  std::map<std::string, std::string> defaults_;
  std::set<uint64_t> ids_;
  std::set<std::string> names_;
};

}  // namespace bevloc::can
