// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Results.h"
#include "FirstHelp.h"
#include "Meeting.h"
#include "Parse.h"
#include "Wording.h"

#include <algorithm>
#include <cmath>

namespace explica::app {

using provenance::Json;

Json describeJson(const Declaration& d) {
  Json json = Json::object();
  json["command"] = d.name;
  json["synopsis"] = d.synopsisText;
  json["description"] = d.descriptionText;
  json["usage"] = usageLine(d);
  if (const FirstHelp* first = firstHelpOf(d.name)) {
    json["paste"] = first->example();
  }
  json["references"] = d.references;
  json["examples"] = Json::array();
  for (const auto& e : d.examples) {
    json["examples"].push_back({{"command", e.commandLine}, {"what", e.what}});
  }
  CommonOptions common;
  json["parameters"] = Json::array();
  for (const Parameter& p : allParameters(d, common)) {
    Json entry = Json::object();
    entry["name"] = p.option.name;
    entry["positional"] = p.positional;
    entry["required"] = p.required;
    entry["type"] = p.option.type;
    entry["list"] = p.option.isList;
    entry["optional"] = p.option.isOptional;
    entry["unit"] = p.option.unit;
    const bool above = p.option.least == kAboveZero;
    entry["above"] = above ? Json(0) : Json(nullptr);
    entry["least"] = above || std::isinf(p.option.least) ? Json(nullptr) : Json(p.option.least);
    entry["range"] = p.option.range();
    entry["most"] = std::isinf(p.option.most) ? Json(nullptr) : Json(p.option.most);
    entry["category"] = p.option.category;
    entry["help"] = p.option.help;
    entry["file"] = p.file ? Json(nameOf(*p.file)) : Json(nullptr);
    entry["side"] = p.side ? Json(nameOf(*p.side)) : Json(nullptr);
    entry["one_by_one"] = p.oneByOne;
    entry["of_another"] = p.ofAnother != nullptr;
    entry["excludes"] = p.excludes;
    entry["needs"] = p.needs;
    entry["choices"] = p.option.choices;
    entry["default"] = p.positional ? Json(nullptr) : provenance::valueOf(p.option);
    entry["first"] = shownAtFirst(d, p);
    entry["placeholder"] = p.positional ? upperCase(p.option.name) : placeholder(p);
    json["parameters"].push_back(entry);
  }
  json["writes_folder"] = d.writesOutput;
  json["files_meet"] = filesMeet(d);
  json["outputs"] = Json::array();
  for (const auto& slot : allOutputs(d)) {
    json["outputs"].push_back({{"pattern", slot.pattern},
                               {"file", nameOf(slot.kind)},
                               {"help", slot.help},
                               {"varies", slot.varies}});
  }
  json["results"] = Json::array();
  for (const Result& result : d.stageResults) {
    Json entry = {{"key", result.key}};
    entry.update(provenance::meaningOf(result));
    json["results"].push_back(entry);
  }
  return json;
}

Json describeAllCommands() {
  Json all = Json::array();
  for (const Command& command : allCommands()) {
    all.push_back(describeJson(command.begin().declaration));
  }
  return all;
}

}  // namespace explica::app
