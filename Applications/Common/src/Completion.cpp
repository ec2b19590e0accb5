// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/Descriptors.h"
#include "Explica/Core/Text.h"
#include "Parse.h"
#include "Wording.h"

#include <algorithm>
#include <map>

namespace explica::app {
namespace {

std::string quotedShell(const std::string& text) {
  return "'" + replaced(text, "'", "'\\''") + "'";
}

/// A word and its meaning, as zsh's _describe takes them.
std::string described(const std::string& word, const std::string& meaning) {
  return quotedShell(word + ":" + replaced(meaning, ":", "\\:"));
}

/// A verb, and the kinds of one that has two words: each with its synopsis.
struct Verb {
  std::string name, synopsis;
  std::vector<std::pair<std::string, std::string>> kinds;
};

std::vector<Verb> verbs() {
  std::vector<Verb> all;
  for (const Command& command : allCommands()) {
    const std::size_t space = command.name().find(' ');
    const std::string name = command.name().substr(0, space);
    const std::string synopsis = command.begin().declaration.synopsisText;
    if (all.empty() || all.back().name != name) all.push_back({name, synopsis, {}});
    if (space == std::string::npos) continue;
    all.back().kinds.emplace_back(command.name().substr(space + 1), synopsis);
  }
  return all;
}

/// What may follow an option, as the shell function's `values`: words, or -f files, or -d folders.
std::string bashValues(const Parameter& p) {
  if (!p.option.choices.empty()) return "-W " + joined(p.option.choices, " ");
  if (p.file == FileKind::Folder || p.option.name == "out") return "-d";
  return p.file || p.option.type == "text" ? "-f" : "-W";
}

/// The case of one command: its options, those shown at first, and what may follow each.
std::string bashCase(const Declaration& d) {
  CommonOptions common;
  std::vector<std::string> first, options;
  bool takesFiles = false;
  std::map<std::string, std::vector<std::string>> followed;  // options by what may follow them
  for (const Parameter& p : allParameters(d, common)) {
    if (p.positional) {
      takesFiles = takesFiles || p.file || p.option.name == "OUT_DIR";
      continue;
    }
    options.push_back(dashed(p));
    if (shownAtFirst(d, p)) first.push_back(dashed(p));
    if (!p.option.isFlag()) followed[bashValues(p)].push_back(dashed(p));
  }
  std::string text = "    " + quotedShell(d.name) + ")\n      files='" + (takesFiles ? "1" : "") +
                     "'\n      first=" + quotedShell(joined(first, " ")) + "\n      options=" +
                     quotedShell(joined(options, " ") + " --help --help-all --version") + "\n";
  if (!followed.empty()) text += "      case $previous in\n";
  for (const auto& [values, names] : followed) {
    text += "        " + joined(names, "|") + ") values=" + quotedShell(values) + " ;;\n";
  }
  return text + (followed.empty() ? "" : "      esac\n") + "      ;;\n";
}

/// One option for zsh's _arguments.
std::string zshOption(const Parameter& p) {
  const std::string help = replaced(replaced(rightColumn(p), "[", "("), "]", ")");
  std::string entry = dashed(p) + "[" + replaced(help, ":", "\\:") + "]";
  if (p.option.isFlag()) return quotedShell(entry);
  const std::string& name = p.option.name;
  const bool takesFile = p.file || name == "out" || name == "config" || name == "log";
  const std::string action = !p.option.choices.empty() ? "(" + joined(p.option.choices, " ") + ")"
                             : takesFile               ? "_files"
                                                       : " ";
  return quotedShell(entry + ":" + name + ":" + action);
}

}  // namespace

std::string bashCompletion() {
  std::string text =
      R"(# bash completion of explica, generated from the commands' own declarations.
_explica_reply() { mapfile -t COMPREPLY < <(compgen "$@" -- "$word"); }
_explica() {
  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}
  local command=${COMP_WORDS[1]} kinds='' first='' options='' files='' values=''
  COMPREPLY=()
)";
  const std::vector<Verb> all = verbs();
  text += "  if [[ $COMP_CWORD == 1 ]]; then\n    _explica_reply -W " +
          quotedShell(joined(all, " ", [](const Verb& verb) { return verb.name; })) +
          "\n    return\n  fi\n  case $command in\n";
  for (const Verb& verb : all) {
    if (verb.kinds.empty()) continue;
    const auto kinds = joined(verb.kinds, " ", [](const auto& kind) { return kind.first; });
    text += "    " + verb.name + ") kinds=" + quotedShell(kinds) + " ;;\n";
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
  for (const Command& command : allCommands()) text += bashCase(command.begin().declaration);
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

std::string zshCompletion() {
  const std::vector<Verb> all = verbs();
  std::string text =
      "#compdef explica\n# zsh completion, generated from the commands' own declarations.\n"
      "local -a commands kinds\ncommands=(\n";
  for (const Verb& verb : all) text += "  " + described(verb.name, verb.synopsis) + "\n";
  text +=
      ")\nif (( CURRENT == 2 )); then\n  _describe command commands\n  return\nfi\n"
      "local name=${words[2]}\n";
  for (const Verb& verb : all) {
    if (verb.kinds.empty()) continue;
    const auto kinds = joined(verb.kinds, " ",
                              [](const auto& kind) { return described(kind.first, kind.second); });
    text += "if [[ $name == " + verb.name + " ]]; then\n  kinds=(" + kinds +
            ")\n  if (( CURRENT == 3 )); then\n    _describe kind kinds\n    return\n  fi\n"
            "  name=\"$name ${words[3]}\"\nfi\n";
  }
  text += "case $name in\n";
  for (const Command& command : allCommands()) {
    CommonOptions common;
    const Invocation invocation = command.begin();
    text += "  " + quotedShell(command.name()) + ")\n    _arguments \\\n";
    for (const Parameter& p : allParameters(invocation.declaration, common)) {
      if (!p.positional) text += "      " + zshOption(p) + " \\\n";
    }
    text += "      '*:file:_files'\n    ;;\n";
  }
  return text + "esac\n";
}

}  // namespace explica::app
