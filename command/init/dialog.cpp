#include "command/init/dialog.h"

#include <istream>
#include <ostream>

#include <fmt/format.h>

namespace bevloc::command {

void Dialog::say(const std::string& text) {
  if (asks_) out_ << text << '\n';
}

Result<std::string> Dialog::ask(const std::string& question, const std::string& proposal,
                                const AnswerCheck& check) {
  if (!asks_) {
    if (const Status good = check(proposal); !good) return tl::unexpected(good.error());
    return proposal;
  }
  for (;;) {
    out_ << question;
    if (!proposal.empty()) out_ << " [" << proposal << "]";
    out_ << ": " << std::flush;
    std::string answer;
    if (!std::getline(in_, answer)) {
      return fail("{}: found the end of the input, wanted an answer", question);
    }
    if (answer.empty()) answer = proposal;
    const Status good = check(answer);
    if (good) return answer;
    out_ << "  " << good.error().message << '\n';
  }
}

}  // namespace bevloc::command
