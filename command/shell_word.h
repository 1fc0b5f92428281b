// Writes words of a command so that the shell reads them as they are meant.
#pragma once

#include <string>

namespace bevloc::command {

/// Returns one word for the shell, whatever it contains, in quotes if it needs them.
std::string shell_word(const std::string& word);

}  // namespace bevloc::command
