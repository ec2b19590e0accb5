// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "DescriptorWords.h"

#include "Explica/Core/Text.h"

namespace explica::app {
namespace {

std::string roff(std::string text) {
  text = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  if (!text.empty() && (text[0] == '.' || text[0] == '\'')) text = "\\&" + text;
  return text;
}

/// A term and what it means; `font` is roff's request for the term.
std::string entry(const std::string& font, const std::string& term, const std::string& meaning) {
  return ".TP\n" + font + " " + term + "\n" + roff(meaning) + "\n";
}

std::string exitStatus() {
  std::string text = ".SH \"EXIT STATUS\"\n";
  for (const auto& [code, meaning] : kExitCodes) text += entry(".B", std::to_string(code), meaning);
  return text;
}

}  // namespace

std::string manPageOf(const Json& command, const std::string& version) {
  const std::string name = "explica-" + replaced(word(command["command"]), " ", "-");
  std::string text = ".TH " + roff(upper(name)) + " 1 \"\" \"Explica " + roff(version) +
                     "\" \"User Commands\"\n.ad l\n.SH NAME\n" + roff(name) + " \\- " +
                     roff(word(command["synopsis"])) + "\n.SH SYNOPSIS\n.B " +
                     roff(word(command["usage"])) + "\n";
  if (!word(command["description"]).empty()) {
    text += ".SH DESCRIPTION\n" + roff(word(command["description"])) + "\n";
  }
  for (const std::string& category : categoriesOf(command)) {
    text += ".SH \"" + roff(upper(category)) + "\"\n";
    for (const Json& p : command["parameters"]) {
      const std::string own = p["positional"] ? "Arguments" : word(p["category"]);
      if (own != category) continue;
      const std::string left =
          p["positional"]
              ? word(p["name"])
              : "--" + word(p["name"]) + (isFlag(p) ? "" : " " + word(p["placeholder"]));
      // A list of choices may break after each of them.
      text += entry(".B", replaced(roff(left), "|", "|\\:"), helpWithDefault(p));
    }
  }
  if (command["writes_folder"]) {
    text += ".SH FILES\n";
    for (const Json& slot : command["outputs"]) {
      text += entry(".I", roff(word(slot["pattern"])), word(slot["help"]));
    }
  }
  text += exitStatus();
  if (!command["examples"].empty()) {
    text += ".SH EXAMPLES\n";
    for (const Json& e : command["examples"]) {
      text += entry(".B", roff(word(e["command"])), word(e["what"]));
    }
  }
  if (!command["references"].empty()) {
    text += ".SH REFERENCES\n";
    text += joined(command["references"], ".PP\n",
                   [](const Json& reference) { return roff(word(reference)) + "\n"; });
  }
  return text;
}

std::string overviewManPageOf(const Json& commands, const std::string& version) {
  std::string text = ".TH EXPLICA 1 \"\" \"Explica " + roff(version) +
                     "\" \"User Commands\"\n.SH NAME\nexplica \\- measures layered tissue such as "
                     "cortex or the heart wall, and unfolds it\n"
                     ".SH SYNOPSIS\n.B explica\n.I COMMAND\n[arguments] [options]\n.SH COMMANDS\n";
  for (const Json& command : commands) {
    const std::string name = roff(replaced(word(command["command"]), " ", "-"));
    text += entry(".BR", "explica\\-" + name + " (1)", word(command["synopsis"]));
  }
  return text + exitStatus();
}

}  // namespace explica::app
