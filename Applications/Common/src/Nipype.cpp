// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "DescriptorWords.h"

#include <algorithm>
#include <cctype>

namespace explica::app {
namespace {

std::string pythonText(const std::string& text) {
  return "\"" + replaced(replaced(text, "\\", "\\\\"), "\"", "\\\"") + "\"";
}

std::string nipypeName(const Json& p) {
  std::string name = identifier(word(p["name"]));
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  // Words of Python's own; a name that ends with "_" would be a wildcard of Traits.
  return name == "lambda" || name == "from" ? "option_" + name : name;
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

}  // namespace

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

}  // namespace explica::app
