// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "DescriptorWords.h"

#include "Explica/Core/Text.h"

#include <algorithm>
#include <map>

namespace explica::app {
namespace {

std::string quotedShell(const std::string& text) {
  return "'" + replaced(text, "'", "'\\''") + "'";
}

/// Verbs in order, and the kinds of those that have two words.
struct Verbs {
  std::vector<std::string> names;
  std::map<std::string, std::string> kinds;
};

Verbs verbsOf(const Json& commands) {
  Verbs verbs;
  for (const Json& command : commands) {
    const std::string name = word(command["command"]);
    const std::size_t space = name.find(' ');
    const std::string verb = name.substr(0, space);
    if (verbs.names.empty() || verbs.names.back() != verb) verbs.names.push_back(verb);
    if (space != std::string::npos) verbs.kinds[verb] += " " + name.substr(space + 1);
  }
  return verbs;
}

/// What may follow an option, as the shell function's `values`: words, or -f files, or -d folders.
std::string bashValues(const Json& p) {
  if (!p["choices"].empty()) {
    std::string words;
    for (const Json& choice : p["choices"]) words += " " + word(choice);
    return "-W" + words;
  }
  if (takesFolder(p) || p["name"] == "out") return "-d";
  const bool textOrFile = takesFile(p) || (p["type"] == "text" && p["placeholder"] != "N");
  return textOrFile ? "-f" : "-W";
}

/// The case of one command: its options, those shown at first, and what may follow each.
std::string bashCase(const Json& command) {
  std::string first, options, files = "";
  std::map<std::string, std::vector<std::string>> followed;  // options by what may follow them
  for (const Json& p : command["parameters"]) {
    if (p["positional"]) {
      if (!p["file"].is_null() || p["name"] == "OUT_DIR") files = "1";
      continue;
    }
    const std::string option = "--" + word(p["name"]);
    options += " " + option;
    if (p["first"]) first += " " + option;
    if (!isFlag(p)) followed[bashValues(p)].push_back(option);
  }
  std::string text =
      "    " + quotedShell(word(command["command"])) + ")\n      files=" + quotedShell(files) +
      "\n      first=" + quotedShell(first.substr(first.empty() ? 0 : 1)) +
      "\n      options=" + quotedShell(options.substr(1) + " --help --help-all --version") + "\n";
  if (!followed.empty()) {
    text += "      case $previous in\n";
    for (const auto& [values, names] : followed) {
      text += "        " + joined(names, "|") + ") values=" + quotedShell(values) + " ;;\n";
    }
    text += "      esac\n";
  }
  return text + "      ;;\n";
}

}  // namespace

std::string bashCompletionOf(const Json& commands) {
  const Verbs verbs = verbsOf(commands);
  std::string text =
      R"(# bash completion of explica, generated from the commands' own declarations.
_explica_reply() { mapfile -t COMPREPLY < <(compgen "$@" -- "$word"); }
_explica() {
  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}
  local command=${COMP_WORDS[1]} kinds='' first='' options='' files='' values=''
  COMPREPLY=()
)";
  text += "  if [[ $COMP_CWORD == 1 ]]; then\n    _explica_reply -W " +
          quotedShell(joined(verbs.names, " ")) + "\n    return\n  fi\n  case $command in\n";
  for (const auto& [verb, kinds] : verbs.kinds) {
    text += "    " + verb + ") kinds=" + quotedShell(kinds.substr(1)) + " ;;\n";
  }
  text += R"(  esac
  if [[ -n $kinds ]]; then
    if [[ $COMP_CWORD == 2 ]]; then
      _explica_reply -W "$kinds"
      return
    fi
    command="$command ${COMP_WORDS[2]}"
  fi
  case $command in
)";
  for (const Json& command : commands) text += bashCase(command);
  return text + R"(  esac
  case $values in
    -W*) _explica_reply -W "${values#-W}"; return ;;
    -?) compopt -o filenames 2>/dev/null; _explica_reply "$values"; return ;;
  esac
  case $word in
    -*) _explica_reply -W "$options" ;;
    '')
      # What most people need comes before the folder's files.
      compopt -o nosort -o filenames 2>/dev/null
      _explica_reply -W "$first"
      local -a chosen=("${COMPREPLY[@]}")
      if [[ -n $files ]]; then _explica_reply -f; else COMPREPLY=(); fi
      COMPREPLY=("${chosen[@]}" "${COMPREPLY[@]}")
      ;;
    *)
      compopt -o filenames 2>/dev/null
      _explica_reply -f
      ;;
  esac
}
complete -F _explica explica
)";
}

std::string zshCompletionOf(const Json& commands) {
  std::vector<std::string> verbs;
  std::map<std::string, std::string> kindsOf;  // of a verb of two words: entries for _describe
  std::string described;
  for (const Json& command : commands) {
    const std::string name = word(command["command"]);
    const std::size_t space = name.find(' ');
    const std::string verb = name.substr(0, space);
    const std::string synopsis = replaced(word(command["synopsis"]), ":", "\\:");
    if (space != std::string::npos) {
      kindsOf[verb] += " " + quotedShell(name.substr(space + 1) + ":" + synopsis);
    }
    if (std::find(verbs.begin(), verbs.end(), verb) != verbs.end()) continue;
    verbs.push_back(verb);
    described += "  " + quotedShell(verb + ":" + synopsis) + "\n";
  }
  std::string text =
      "#compdef explica\n# zsh completion, generated from the commands' own declarations.\n"
      "local -a commands kinds\ncommands=(\n" +
      described +
      ")\nif (( CURRENT == 2 )); then\n  _describe command commands\n  return\nfi\n"
      "local name=${words[2]}\n";
  for (const auto& [verb, kinds] : kindsOf) {
    text += "if [[ $name == " + verb + " ]]; then\n  kinds=(" + kinds.substr(1) +
            ")\n  if (( CURRENT == 3 )); then\n    _describe kind kinds\n    return\n  fi\n"
            "  name=\"$name ${words[3]}\"\nfi\n";
  }
  text += "case $name in\n";
  for (const Json& command : commands) {
    text += "  " + quotedShell(word(command["command"])) + ")\n    _arguments \\\n";
    for (const Json& p : command["parameters"]) {
      if (p["positional"]) continue;
      std::string help = replaced(replaced(replaced(helpOf(p), "[", "("), "]", ")"), ":", "\\:");
      std::string entry = "--" + word(p["name"]) + "[" + help + "]";
      if (!isFlag(p)) {
        std::string action = "_files";
        if (!p["choices"].empty()) {
          action = "(";
          for (const Json& choice : p["choices"])
            action += (action.size() > 1 ? " " : "") + word(choice);
          action += ")";
        } else if (p["file"].is_null() && p["name"] != "out" && p["name"] != "config" &&
                   p["name"] != "log") {
          action = " ";
        }
        entry += ":" + word(p["name"]) + ":" + action;
      }
      text += "      " + quotedShell(entry) + " \\\n";
    }
    text += "      '*:file:_files'\n    ;;\n";
  }
  return text + "esac\n";
}

}  // namespace explica::app
