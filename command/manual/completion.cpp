#include "command/manual/completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace bevloc::command {
namespace {

/// Returns the pattern of a case that matches the command's path, with a space before each word.
std::string place_of(const CommandEntry& command) {
  return command.path.empty() ? "" : " " + command.path;
}

/// Returns the loop that finds the command that the line names so far. `words` are those before the
/// cursor.
std::string place_loop(const CommandEntry& table, const std::string& words) {
  std::string places;
  for (const CommandEntry* command : all_commands(table)) {
    if (command->path.empty()) continue;
    places += fmt::format("{}\"{}\"", places.empty() ? "" : "|", place_of(*command));
  }
  if (places.empty()) return "  local place=\"\"\n";
  return fmt::format(
      "  local place=\"\" word\n"
      "  for word in {}; do\n"
      "    case \"$place $word\" in\n"
      "      {}) place=\"$place $word\" ;;\n"
      "    esac\n"
      "  done\n",
      words, places);
}

/// Returns the cases "place:--option" of all options with a value. `words` and `files` say how the
/// shell offers words and files.
template <typename Words, typename Files>
std::string value_cases(const CommandEntry& table, Words words, Files files) {
  std::string cases;
  for (const CommandEntry* command : all_commands(table)) {
    for (const OptionEntry& option : command->options) {
      if (option.positional || option.value.empty()) continue;
      std::string patterns;
      for (const std::string& name : option.names) {
        patterns +=
            fmt::format("{}\"{}:{}\"", patterns.empty() ? "" : "|", place_of(*command), name);
      }
      cases += fmt::format(
          "    {}) {}; return ;;\n", patterns,
          option.choices.empty() ? files(option.value == "DIR") : words(option.choices));
    }
  }
  return cases;
}

/// Returns the text in single quotes of a shell.
std::string in_quotes(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::string bash_completion(const std::string& program, const CommandEntry& table) {
  const auto words = [](const std::vector<std::string>& choices) {
    return fmt::format("mapfile -t COMPREPLY < <(compgen -W \"{}\" -- \"$current\")",
                       fmt::join(choices, " "));
  };
  const auto files = [](bool folders) {
    return fmt::format(
        "compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -{} -- \"$current\")",
        folders ? "d" : "f");
  };
  std::string script = fmt::format(
      "# bash completion of {0}, written by `bevloc completion bash`\n"
      "_{0}_complete() {{\n"
      "  local current=\"${{COMP_WORDS[COMP_CWORD]}}\" before=\"${{COMP_WORDS[COMP_CWORD - "
      "1]}}\"\n",
      program);
  script += place_loop(table, "\"${COMP_WORDS[@]:1:COMP_CWORD-1}\"");
  script += "  case \"$place:$before\" in\n" + value_cases(table, words, files) + "  esac\n";
  script += "  case \"$place\" in\n";
  for (const CommandEntry* command : all_commands(table)) {
    std::vector<std::string> names;
    for (const CommandEntry& sub : command->commands) names.push_back(sub.name);
    bool takes_files = false;
    for (const OptionEntry& option : command->options) {
      if (option.positional) {
        takes_files = takes_files || option.choices.empty();
        names.insert(names.end(), option.choices.begin(), option.choices.end());
      } else {
        names.insert(names.end(), option.names.begin(), option.names.end());
      }
    }
    script += fmt::format("    \"{}\") {}", place_of(*command), words(names));
    if (takes_files) {
      script += "; [[ $current == -* || -n ${COMPREPLY[*]} ]] || { " + files(false) + "; }";
    }
    script += " ;;\n";
  }
  return script + fmt::format("  esac\n}}\ncomplete -F _{0}_complete {0}\n", program);
}

std::string zsh_completion(const std::string& program, const CommandEntry& table) {
  const auto words = [](const std::vector<std::string>& choices) {
    return fmt::format("compadd -- {}", fmt::join(choices, " "));
  };
  const auto files = [](bool folders) { return folders ? "_files -/" : "_files"; };
  std::string script = fmt::format(
      "#compdef {0}\n"
      "# zsh completion of {0}, written by `bevloc completion zsh`\n"
      "_{0}() {{\n"
      "  local before=\"${{words[CURRENT-1]}}\"\n"
      "  local -a entries\n  local -i files=0\n",
      program);
  script += place_loop(table, "\"${(@)words[2,CURRENT-1]}\"");
  script += "  case \"$place:$before\" in\n" + value_cases(table, words, files) + "  esac\n";
  script += "  case \"$place\" in\n";
  for (const CommandEntry* command : all_commands(table)) {
    std::string entries;
    bool takes_files = false;
    const auto add = [&entries](const std::string& name, const std::string& description) {
      entries += "\n      " + in_quotes(name + ":" + description);
    };
    for (const CommandEntry& sub : command->commands) add(sub.name, sub.description);
    for (const OptionEntry& option : command->options) {
      for (const std::string& name : option.positional ? option.choices : option.names) {
        add(name, option.description);
      }
      takes_files = takes_files || (option.positional && option.choices.empty());
    }
    script += fmt::format("    \"{}\") entries=({}){} ;;\n", place_of(*command), entries,
                          takes_files ? "; files=1" : "");
  }
  return script +
         fmt::format(
             "  esac\n  _describe {0} entries\n  (( files )) && _files\n}}\ncompdef _{0} {0}\n",
             program);
}

}  // namespace bevloc::command
