// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "DescriptorWords.h"

namespace explica::app {
namespace {

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

}  // namespace

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

}  // namespace explica::app
