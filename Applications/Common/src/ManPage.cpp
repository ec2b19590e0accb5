// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "DescriptorWords.h"

#include <algorithm>
#include <cctype>

namespace explica::app {
namespace {

std::string roff(std::string text) {
  text = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  if (!text.empty() && (text[0] == '.' || text[0] == '\'')) text = "\\&" + text;
  return text;
}

}  // namespace

std::string manPageOf(const Json& command, const std::string& version) {
  const std::string name = "explica-" + replaced(word(command["command"]), " ", "-");
  std::string title = name;
  std::transform(title.begin(), title.end(), title.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::string text = ".TH " + roff(title) + " 1 \"\" \"Explica " + roff(version) +
                     "\" \"User Commands\"\n.ad l\n.SH NAME\n" + roff(name) + " \\- " +
                     roff(word(command["synopsis"])) + "\n.SH SYNOPSIS\n.B " +
                     roff(word(command["usage"])) + "\n";
  if (!word(command["description"]).empty()) {
    text += ".SH DESCRIPTION\n" + roff(word(command["description"])) + "\n";
  }
  for (const std::string& category : categoriesOf(command)) {
    std::string heading = category;
    std::transform(heading.begin(), heading.end(), heading.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    text += ".SH \"" + roff(heading) + "\"\n";
    for (const Json& p : command["parameters"]) {
      const std::string own = p["positional"] ? "Arguments" : word(p["category"]);
      if (own != category) continue;
      const std::string left =
          p["positional"]
              ? word(p["name"])
              : "--" + word(p["name"]) + (isFlag(p) ? "" : " " + word(p["placeholder"]));
      // A list of choices may break after each of them.
      text +=
          ".TP\n.B " + replaced(roff(left), "|", "|\\:") + "\n" + roff(helpWithDefault(p)) + "\n";
    }
  }
  if (command["writes_folder"]) {
    text += ".SH FILES\n";
    for (const Json& slot : command["outputs"]) {
      text += ".TP\n.I " + roff(word(slot["pattern"])) + "\n" + roff(word(slot["help"])) + "\n";
    }
  }
  text += ".SH \"EXIT STATUS\"\n";
  for (const auto& [code, meaning] : kExitCodes) {
    text += ".TP\n.B " + std::to_string(code) + "\n" + roff(meaning) + "\n";
  }
  if (!command["examples"].empty()) {
    text += ".SH EXAMPLES\n";
    for (const Json& e : command["examples"]) {
      text += ".TP\n.B " + roff(word(e["command"])) + "\n" + roff(word(e["what"])) + "\n";
    }
  }
  if (!command["references"].empty()) {
    text += ".SH REFERENCES\n";
    std::string between;
    for (const Json& reference : command["references"]) {
      text += between + roff(word(reference)) + "\n";
      between = ".PP\n";
    }
  }
  return text;
}

std::string overviewManPageOf(const Json& commands, const std::string& version) {
  std::string text = ".TH EXPLICA 1 \"\" \"Explica " + roff(version) +
                     "\" \"User Commands\"\n.SH NAME\nexplica \\- measures layered tissue such as "
                     "cortex or the heart wall, and unfolds it\n"
                     ".SH SYNOPSIS\n.B explica\n.I COMMAND\n[arguments] [options]\n.SH COMMANDS\n";
  for (const Json& command : commands) {
    text += ".TP\n.BR explica\\-" + roff(replaced(word(command["command"]), " ", "-")) + " (1)\n" +
            roff(word(command["synopsis"])) + "\n";
  }
  text += ".SH \"EXIT STATUS\"\n";
  for (const auto& [code, meaning] : kExitCodes) {
    text += ".TP\n.B " + std::to_string(code) + "\n" + roff(meaning) + "\n";
  }
  return text;
}

}  // namespace explica::app
