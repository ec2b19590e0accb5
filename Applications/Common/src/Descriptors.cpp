// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Descriptors.h"

#include "Parse.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <utility>

namespace explica::app {
namespace {

constexpr std::array<std::pair<int, const char*>, 5> kExitCodes = {
    {{0, "done"},
     {1, "usage"},
     {2, "bad input"},
     {3, "stopped before its goal (outputs written and marked)"},
     {4, "environment"}}};

/// Letters and digits of a name, words joined by one `joint`: "frames/frame-*.gii" becomes
/// "frames_frame_gii".
std::string identifier(const std::string& name, char joint = '_') {
  std::string id;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c))) {
      id += c;
    } else if (!id.empty() && id.back() != joint) {
      id += joint;
    }
  }
  return id;
}

std::string camelCase(const std::string& name) {
  std::string camel;
  bool start = true;
  for (const char c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c))) {
      start = true;
    } else {
      camel += start ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
      start = false;
    }
  }
  return camel;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

bool isFile(const Json& p) {
  return !p["file"].is_null() && p["file"] != "folder";
}
bool isFolder(const Json& p) {
  return p["file"] == "folder";
}
bool isFlag(const Json& p) {
  return p["type"] == "flag";
}
bool isPoint(const Json& p) {
  return p["type"] == "point2" || p["type"] == "point3";
}
bool isNumber(const Json& p) {
  return p["type"] == "number" || p["type"] == "integer";
}
/// A list whose values are joined by commas on the command line.
bool isJoined(const Json& p) {
  return p["list"] && p["file"].is_null() && p["type"] != "text" && !isPoint(p);
}

std::string word(const Json& value) {
  return value.get<std::string>();
}

std::string valueText(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return word(value);
  if (value.is_array()) {
    std::string joined;
    for (const Json& item : value) joined += (joined.empty() ? "" : ",") + valueText(item);
    return joined;
  }
  return value.dump();
}

/// Help with unit, as one sentence.
std::string helpOf(const Json& p) {
  const std::string unit = word(p["unit"]);
  const std::string range = word(p["range"]);
  const std::string aside = unit + (unit.empty() || range.empty() ? "" : "; ") + range;
  return word(p["help"]) + (aside.empty() ? "" : " [" + aside + "]");
}

/// The same with the default.
std::string helpWithDefault(const Json& p) {
  const std::string value = isFlag(p) ? "" : valueText(p["default"]);
  return helpOf(p) + (value.empty() ? "" : " (default " + value + ")");
}

bool needed(const Json& p) {
  return p["required"].get<bool>() || p["name"] == "out";
}

// Boutiques -------------------------------------------------------------------------------------

Json boutiquesInput(const Json& p) {
  Json input = Json::object();
  const std::string id = identifier(word(p["name"]));
  input["id"] = id;
  input["name"] = word(p["name"]);
  // Not as "default-value": platforms would then pass every default as if the user had asked for
  // it.
  input["description"] = helpWithDefault(p);
  input["type"] = isFlag(p) ? "Flag" : isFile(p) ? "File" : isNumber(p) ? "Number" : "String";
  input["optional"] = isFlag(p) || !needed(p);
  std::string key;
  for (const char c : id) key += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  input["value-key"] = "[" + key + "]";
  if (!p["positional"]) input["command-line-flag"] = "--" + word(p["name"]);
  if (p["type"] == "integer") input["integer"] = true;
  if (!p["least"].is_null()) input["minimum"] = p["least"];
  if (!p["above"].is_null()) {
    input["minimum"] = p["above"];
    input["exclusive-minimum"] = true;
  }
  if (!p["most"].is_null()) input["maximum"] = p["most"];
  if (!p["choices"].empty()) input["value-choices"] = p["choices"];
  if (p["list"]) {
    input["list"] = true;
    if (isJoined(p)) input["list-separator"] = ",";
    if (!isJoined(p) && !p["positional"]) input["command-line-flag-separator"] = " ";
  }
  return input;
}

// Slicer ----------------------------------------------------------------------------------------

std::string escapedXml(const std::string& text) {
  return replaced(replaced(replaced(replaced(text, "&", "&amp;"), "<", "&lt;"), ">", "&gt;"), "\"",
                  "&quot;");
}

/// What Slicer must not pass unless the user sets it: it passes every number and choice, but a text
/// only if there is one.  Numbers without default, and options of a step, which would win over what
/// the run itself settles.
bool passedOnlyIfSet(const Json& p) {
  const bool ofStep = word(p["name"]).find('.') != std::string::npos;
  return !isFlag(p) && p["file"].is_null() && p["name"] != "out" &&
         (ofStep || p["default"].is_null() || valueText(p["default"]).empty());
}

std::string slicerTag(const Json& p) {
  const std::string kind = p["file"].is_null() ? "" : word(p["file"]);
  if (kind == "volume" || kind == "label volume" || kind == "point volume") return "image";
  if (kind == "surface") return "geometry";
  if (kind == "folder" || p["name"] == "out") return "directory";
  if (!kind.empty()) return "file";
  if (passedOnlyIfSet(p) && !p["positional"]) return "string";
  const std::string type = word(p["type"]);
  if (type == "flag") return "boolean";
  if (type == "integer") return p["list"] ? "integer-vector" : "integer";
  if (type == "number") return p["list"] ? "double-vector" : "double";
  if (isPoint(p)) return "double-vector";
  if (type == "choice") return p["list"] ? "string-vector" : "string-enumeration";
  return p["list"] ? "string-vector" : "string";
}

std::string slicerParameter(const Json& p, int index) {
  const std::string tag = slicerTag(p);
  std::string open = "    <" + tag;
  if (tag == "image" && p["file"] == "label volume") open += " type=\"label\"";
  if (isFile(p) && p["list"]) open += " multiple=\"true\"";
  std::string xml = open + ">\n";
  xml += "      <name>" + identifier(word(p["name"])) + "</name>\n";
  xml += "      <label>" + escapedXml(word(p["name"])) + "</label>\n";
  const std::string help = tag == "string" ? helpWithDefault(p) : helpOf(p);
  xml += "      <description>" + escapedXml(help) + "</description>\n";
  if (p["positional"]) {
    xml += "      <index>" + std::to_string(index) + "</index>\n";
  } else {
    xml += "      <longflag>--" + word(p["name"]) + "</longflag>\n";
  }
  if (isFile(p) || isFolder(p)) xml += "      <channel>input</channel>\n";
  if (p["name"] == "out") xml += "      <channel>output</channel>\n";
  std::string value = valueText(p["default"]);
  if (value.empty() && tag == "string-enumeration") value = word(p["choices"].front());
  if (!value.empty() && tag != "string") {
    xml += "      <default>" + escapedXml(value) + "</default>\n";
  }
  if (tag == "string-enumeration") {
    for (const Json& choice : p["choices"]) {
      xml += "      <element>" + escapedXml(word(choice)) + "</element>\n";
    }
  }
  return xml + "    </" + tag + ">\n";
}

std::vector<std::string> categoriesOf(const Json& command) {
  std::vector<std::string> categories;
  for (const Json& p : command["parameters"]) {
    const std::string category = p["positional"] ? "Arguments" : word(p["category"]);
    if (std::find(categories.begin(), categories.end(), category) == categories.end()) {
      categories.push_back(category);
    }
  }
  return categories;
}

// nipype ----------------------------------------------------------------------------------------

std::string pythonText(const std::string& text) {
  return "\"" + replaced(replaced(text, "\\", "\\\\"), "\"", "\\\"") + "\"";
}

std::string nipypeName(const Json& p) {
  std::string name = identifier(word(p["name"]));
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name == "lambda" ? "lambda_" : name;  // the one option that is a word of Python's own
}

std::string nipypeTrait(const Json& p) {
  const std::string type = word(p["type"]);
  std::string inner;
  if (isFile(p)) {
    inner = "File(exists=True)";
  } else if (isFolder(p)) {
    inner = "Directory(exists=True)";
  } else if (type == "integer") {
    inner = "traits.Int()";
  } else if (isPoint(p)) {
    inner = type == "point2" ? "traits.Tuple(traits.Float(), traits.Float())"
                             : "traits.Tuple(traits.Float(), traits.Float(), traits.Float())";
  } else if (type == "number") {
    inner = "traits.Float()";
  } else if (type == "choice") {
    for (const Json& choice : p["choices"]) {
      inner += (inner.empty() ? "" : ", ") + pythonText(word(choice));
    }
    inner = "traits.Enum(" + inner + ")";
  } else {
    inner = "traits.Str()";
  }
  return inner;
}

/// Where the value goes on the command line: "--radius %s".
std::string nipypeArgument(const Json& p) {
  std::string name = p["positional"] ? "" : "--" + word(p["name"]);
  if (isFlag(p)) return name;
  // A tuple fills one place a coordinate.
  const std::string format = p["type"] == "point2"   ? "%s,%s"
                             : p["type"] == "point3" ? "%s,%s,%s"
                                                     : "%s";
  const std::string argument = name + (name.empty() ? "" : " ") + format;
  return p["list"] && !isJoined(p) && !p["positional"] ? argument + "..." : argument;
}

std::string nipypeInput(const Json& p, int position) {
  std::string line = "    " + nipypeName(p) + " = ";
  const std::string metadata = "desc=" + pythonText(helpOf(p)) +
                               ", argstr=" + pythonText(nipypeArgument(p)) +
                               (p["positional"] ? ", position=" + std::to_string(position) : "") +
                               (needed(p) ? ", mandatory=True" : "");
  if (p["name"] == "out") return line + "traits.Str(" + metadata + ")\n";
  if (isFlag(p)) return line + "traits.Bool(" + metadata + ")\n";
  const std::string trait = nipypeTrait(p);
  if (p["list"]) {
    const std::string separator = isJoined(p) ? ", sep=\",\"" : "";
    return line + "traits.List(" + trait + ", " + metadata + separator + ")\n";
  }
  const std::string start = trait.substr(0, trait.size() - 1);
  const std::string comma = start.back() == '(' ? "" : ", ";
  return line + start + comma + metadata + ")\n";
}

// Completion ------------------------------------------------------------------------------------

std::string quotedShell(const std::string& text) {
  return "'" + replaced(text, "'", "'\\''") + "'";
}

// Manual page -----------------------------------------------------------------------------------

std::string roff(std::string text) {
  text = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  if (!text.empty() && (text[0] == '.' || text[0] == '\'')) text = "\\&" + text;
  return text;
}

}  // namespace

Json boutiquesOf(const Json& command, const std::string& version) {
  const std::string name = word(command["command"]);
  Json descriptor = Json::object();
  descriptor["name"] = "explica " + name;
  const std::string description = word(command["description"]);
  descriptor["description"] = description.empty() ? word(command["synopsis"]) : description;
  descriptor["tool-version"] = version;
  descriptor["schema-version"] = "0.5";
  std::string line = "explica " + name;
  descriptor["inputs"] = Json::array();
  for (const bool positional : {true, false}) {
    for (const Json& p : command["parameters"]) {
      if (p["positional"].get<bool>() != positional) continue;
      descriptor["inputs"].push_back(boutiquesInput(p));
      line += " " + word(descriptor["inputs"].back()["value-key"]);
    }
  }
  descriptor["command-line"] = line;
  if (command["writes_folder"] && !command["outputs"].empty()) {
    descriptor["output-files"] = Json::array();
    for (const Json& slot : command["outputs"]) {
      const std::string pattern = word(slot["pattern"]);
      descriptor["output-files"].push_back({{"id", identifier(pattern)},
                                            {"name", pattern},
                                            {"description", word(slot["help"])},
                                            {"path-template", "[OUT]/" + pattern},
                                            {"optional", true}});
    }
  }
  descriptor["error-codes"] = Json::array();
  for (const auto& [code, meaning] : kExitCodes) {
    if (code != 0) descriptor["error-codes"].push_back({{"code", code}, {"description", meaning}});
  }
  descriptor["tags"] = {{"domain", {"neuroinformatics", "mri"}}};
  return descriptor;
}

std::string slicerXmlOf(const Json& command, const std::string& version) {
  std::string xml = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<executable>\n";
  xml += "  <category>Explica</category>\n";
  xml += "  <title>explica " + escapedXml(word(command["command"])) + "</title>\n";
  const std::string description = word(command["description"]);
  xml += "  <description>" +
         escapedXml(description.empty() ? word(command["synopsis"]) : description) +
         "</description>\n";
  xml += "  <version>" + escapedXml(version) + "</version>\n";
  xml += "  <documentation-url></documentation-url>\n  <license>Apache-2.0</license>\n";
  xml += "  <contributor>The Explica developers</contributor>\n";
  for (const std::string& category : categoriesOf(command)) {
    xml += "  <parameters" + std::string(category == "Common" ? " advanced=\"true\"" : "") + ">\n";
    xml += "    <label>" + escapedXml(category) + "</label>\n";
    xml += "    <description>" + escapedXml(category) + "</description>\n";
    int index = 0;
    for (const Json& p : command["parameters"]) {
      const std::string own = p["positional"] ? "Arguments" : word(p["category"]);
      if (own == category) xml += slicerParameter(p, index);
      index += p["positional"].get<bool>();
    }
    xml += "  </parameters>\n";
  }
  return xml + "</executable>\n";
}

std::string nipypeOf(const Json& commands, const std::string& version) {
  std::string text =
      "# SPDX-FileCopyrightText: The Explica developers\n"
      "# SPDX-License-Identifier: Apache-2.0\n"
      "\"\"\"nipype interfaces of Explica " +
      version +
      ", generated from the commands' own declarations.\"\"\"\n\n"
      "import glob\nimport os\n\n"
      "from nipype.interfaces.base import (\n    CommandLine,\n    CommandLineInputSpec,\n"
      "    Directory,\n    File,\n    TraitedSpec,\n    traits,\n)\n";
  for (const Json& command : commands) {
    const std::string name = word(command["command"]);
    const std::string type = camelCase(name);
    text += "\n\nclass " + type + "InputSpec(CommandLineInputSpec):\n";
    int position = 0;
    for (const Json& p : command["parameters"]) {
      text += nipypeInput(p, position);
      position += p["positional"].get<bool>();
    }
    const bool writes = command["writes_folder"];
    text += "\n\nclass " + type + "OutputSpec(TraitedSpec):\n";
    if (writes) {
      text += "    out = Directory(desc=\"folder of the results\")\n";
      for (const Json& slot : command["outputs"]) {
        const std::string pattern = word(slot["pattern"]);
        const bool several = pattern.find('*') != std::string::npos;
        text += "    " + identifier(pattern) + " = " +
                (several ? "traits.List(File(), " : "File(") +
                "desc=" + pythonText(word(slot["help"])) + ")\n";
      }
    } else {
      text += "    pass\n";
    }
    text += "\n\nclass " + type + "(CommandLine):\n    \"\"\"" + word(command["synopsis"]) +
            ".\"\"\"\n\n    _cmd = \"explica " + name + "\"\n    input_spec = " + type +
            "InputSpec\n    output_spec = " + type + "OutputSpec\n";
    if (writes) {
      text +=
          "\n    def _list_outputs(self):\n        outputs = self.output_spec().get()\n"
          "        out = os.path.abspath(self.inputs.out)\n        outputs[\"out\"] = out\n"
          "        for name, pattern in {\n";
      for (const Json& slot : command["outputs"]) {
        const std::string pattern = word(slot["pattern"]);
        text +=
            "            " + pythonText(identifier(pattern)) + ": " + pythonText(pattern) + ",\n";
      }
      text +=
          "        }.items():\n            found = sorted(glob.glob(os.path.join(out, pattern)))\n"
          "            if found:\n                outputs[name] = found if \"*\" in pattern else "
          "found[0]\n        return outputs\n";
    }
  }
  return text;
}

std::string bashCompletionOf(const Json& commands) {
  std::string text =
      "# bash completion of explica, generated from the commands' own declarations.\n"
      "_explica() {\n  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  local command=${COMP_WORDS[1]} options= choices=\n";
  std::string verbs;
  std::string cases;
  std::string kinds;
  for (const Json& command : commands) {
    const std::string name = word(command["command"]);
    const std::size_t space = name.find(' ');
    const std::string verb = name.substr(0, space);
    if ((" " + verbs + " ").find(" " + verb + " ") == std::string::npos) {
      verbs += (verbs.empty() ? "" : " ") + verb;
    }
    if (space != std::string::npos)
      kinds += "    " + verb + ") choices+=' " + name.substr(space + 1) + "' ;;&\n";
    std::string options;
    for (const Json& p : command["parameters"]) {
      if (!p["positional"]) options += " --" + word(p["name"]);
    }
    cases += "    " + quotedShell(name) +
             ")\n      options=" + quotedShell(options + " --help --version") + "\n";
    std::string values;
    for (const Json& p : command["parameters"]) {
      if (p["positional"] || p["choices"].empty()) continue;
      std::string joined;
      for (const Json& choice : p["choices"]) joined += (joined.empty() ? "" : " ") + word(choice);
      values += "        --" + word(p["name"]) + ") COMPREPLY=($(compgen -W " +
                quotedShell(joined) + " -- \"$word\")); return ;;\n";
    }
    if (!values.empty()) cases += "      case $previous in\n" + values + "      esac\n";
    cases += "      ;;\n";
  }
  text += "  if [[ $COMP_CWORD == 1 ]]; then\n    COMPREPLY=($(compgen -W " + quotedShell(verbs) +
          " -- \"$word\"))\n    return\n  fi\n";
  if (!kinds.empty()) {
    text +=
        "  if [[ $COMP_CWORD == 2 ]]; then\n    case $command in\n" + kinds +
        "    *) ;;\n    esac\n    if [[ -n $choices ]]; then\n"
        "      COMPREPLY=($(compgen -W \"$choices\" -- \"$word\"))\n      return\n    fi\n  fi\n"
        "  case $command in\n    phantom) command=\"$command ${COMP_WORDS[2]}\" ;;\n  esac\n";
  }
  text += "  case $command in\n" + cases +
          "  esac\n  if [[ $word == -* ]]; then\n    COMPREPLY=($(compgen -W \"$options\" -- "
          "\"$word\"))\n  else\n    COMPREPLY=($(compgen -f -- \"$word\"))\n  fi\n}\n"
          "complete -o filenames -F _explica explica\n";
  return text;
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

std::string manPageOf(const Json& command, const std::string& version) {
  const std::string name = "explica-" + identifier(word(command["command"]), '-');
  std::string title = name;
  std::transform(title.begin(), title.end(), title.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::string text = ".TH " + roff(title) + " 1 \"\" \"Explica " + roff(version) +
                     "\" \"User Commands\"\n.SH NAME\n" + roff(name) + " \\- " +
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
      text += ".TP\n.B " + roff(left) + "\n" + roff(helpWithDefault(p)) + "\n";
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

Json describeAllCommands() {
  Json all = Json::array();
  for (const Command& command : allCommands()) {
    all.push_back(describeJson(command.begin().declaration));
  }
  return all;
}

}  // namespace explica::app
