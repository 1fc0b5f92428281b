// Asks on a terminal for what the command line does not give.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "common/result.h"

namespace bevloc::command {

/// A function that says whether an answer is good. Its error says what is wrong.
using AnswerCheck = std::function<Status(const std::string& answer)>;

/// Asks one question after the other. If `asks` is false, every answer is the proposal. One thread.
class Dialog {
 public:
  Dialog(std::istream& in, std::ostream& out, bool asks) : in_(in), out_(out), asks_(asks) {}

  bool asks() const { return asks_; }
  void say(const std::string& text);

  /// Repeats the question until the check accepts the answer. An empty answer is the proposal.
  /// Fails if the check refuses the proposal and nobody can be asked, or when the input ends.
  Result<std::string> ask(const std::string& question, const std::string& proposal,
                          const AnswerCheck& check);

 private:
  std::istream& in_;
  std::ostream& out_;
  bool asks_;
};

}  // namespace bevloc::command
