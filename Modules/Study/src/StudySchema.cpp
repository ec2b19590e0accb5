// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Study/StudyFile.h"

#include <algorithm>
#include <map>
#include <regex>

namespace explica::study {
namespace {

using provenance::Json;
using Place = std::vector<std::string>;

Json text(const char* description) {
  return Json{{"type", "string"}, {"minLength", 1}, {"description", description}};
}

/// {"surface.faces": S} also as {"surface": {"faces": S}}.
Json nestedToo(const Json& flat, const char* description) {
  Json properties = flat;
  for (const auto& [name, schema] : flat.items()) {
    const std::size_t dot = name.find('.');
    if (dot == std::string::npos) continue;
    Json& step = properties[name.substr(0, dot)];
    step["type"] = "object";
    step["additionalProperties"] = false;
    step["properties"][name.substr(dot + 1)] = schema;
  }
  return Json{{"type", "object"},
              {"description", description},
              {"additionalProperties", false},
              {"properties", properties}};
}

Json regionsOf(const Json& region, const char* description) {
  return Json{{"type", "object"},
              {"description", description},
              {"additionalProperties", false},
              {"patternProperties", {{"^[A-Za-z0-9]+$", region}}}};
}

// ---- from a fault to a sentence ----

std::string shown(const Json& value) {
  const std::string dumped = provenance::textOf(value);
  return dumped.size() > 60 ? dumped.substr(0, 57) + "..." : dumped;
}

/// "; did you mean 'faces'?", or which words there are.
std::string hint(const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = nearestOf(word, known, word.size() / 3 + 2);
  if (!nearest.empty()) return "; did you mean '" + nearest + "'?";
  return known.size() > 12 || known.empty() ? "" : "; known are " + joined(known);
}

/// The schema that an object's key falls under, or nullptr.
const Json* schemaOfKey(const Json& schema, const std::string& key) {
  if (schema.contains("properties") && schema["properties"].contains(key)) {
    return &schema["properties"][key];
  }
  if (schema.contains("patternProperties")) {
    for (const auto& [pattern, below] : schema["patternProperties"].items()) {
      if (std::regex_search(key, std::regex(pattern))) return &below;
    }
  }
  return nullptr;
}

std::string typesOf(const Json& schema) {
  static const std::map<std::string, std::string> words = {
      {"string", "text"},           {"number", "a number"}, {"integer", "a whole number"},
      {"boolean", "true or false"}, {"array", "a list"},    {"object", "keys with values"},
      {"null", "nothing"}};
  const Json& type = schema["type"];
  return joined(type.is_array() ? type : Json::array({type}), " or ",
                [](const Json& one) { return words.at(one.get<std::string>()); });
}

bool hasType(const Json& value, const Json& schema) {
  const Json& type = schema["type"];
  for (const auto& one : type.is_array() ? type : Json::array({type})) {
    if (one == value.type_name() || (one == "integer" && value.is_number_integer())) return true;
  }
  return false;
}

/// What is wrong with a value itself, and the remedy; empty if only a part of it is wrong.
std::string faultOf(const Json& value, const Json& schema, Place& place) {
  const std::string meaning =
      schema.contains("description") ? " (" + schema["description"].get<std::string>() + ")" : "";
  if (schema.contains("enum") && std::ranges::find(schema["enum"], value) == schema["enum"].end()) {
    std::vector<std::string> words;
    for (const auto& word : schema["enum"]) words.push_back(word.get<std::string>());
    return shown(value) + " is not one of " + joined(words) + meaning;
  }
  if (schema.contains("type") && !hasType(value, schema)) {
    return shown(value) + " is not " + typesOf(schema) + meaning;
  }
  if (value.is_string() && schema.contains("minLength") && value.get<std::string>().empty()) {
    return "is empty" + meaning;
  }
  if (value.is_string() && schema.contains("pattern") &&
      !std::regex_search(value.get<std::string>(),
                         std::regex(schema["pattern"].get<std::string>()))) {
    return shown(value) + ": a label may hold only letters and digits, then _ses- and the same";
  }
  if (value.is_object() && schema.contains("additionalProperties")) {
    for (const auto& [key, below] : value.items()) {
      if (schemaOfKey(schema, key)) continue;
      place.push_back(key);
      std::vector<std::string> known;
      if (schema.contains("properties")) {
        for (const auto& [name, s] : schema["properties"].items()) known.push_back(name);
      }
      if (known.empty() || schema.contains("patternProperties")) {
        return "this name may hold only letters and digits" + meaning;
      }
      return "unknown key" + hint(key, known);
    }
  }
  if (value.is_object() && schema.contains("minProperties") && value.empty()) {
    return "is empty; name at least one";
  }
  if (value.is_array()) {
    const auto bound = [&](const char* name) { return schema[name].get<std::size_t>(); };
    if ((schema.contains("minItems") && value.size() < bound("minItems")) ||
        (schema.contains("maxItems") && value.size() > bound("maxItems"))) {
      const bool exact = schema.contains("maxItems") && bound("minItems") == bound("maxItems");
      return "has " + std::to_string(value.size()) + " elements; " + (exact ? "" : "at least ") +
             std::to_string(bound("minItems")) + " are needed" + meaning;
    }
  }
  return "";
}

/// Throws the first fault of a value or of a part of it.
void check(const StudyFile& file, const Json& value, const Json& schema, const Place& at) {
  if (schema.contains("anyOf")) {
    for (const Json& one : schema["anyOf"]) {
      const bool last = &one == &schema["anyOf"].back();
      Place place = at;
      if (last || faultOf(value, one, place).empty()) return check(file, value, one, at);
    }
  }
  Place place = at;
  const std::string fault = faultOf(value, schema, place);
  if (!fault.empty()) throw InvalidInput(placeIn(file, place) + fault);
  place.emplace_back();
  for (std::size_t n = 0; value.is_array() && n < value.size(); ++n) {
    place.back() = std::to_string(n);
    if (schema.contains("items")) check(file, value[n], schema["items"], place);
  }
  if (!value.is_object()) return;
  for (const auto& [key, part] : value.items()) {
    place.back() = key;
    if (const Json* below = schemaOfKey(schema, key)) check(file, part, *below, place);
  }
}

}  // namespace

Json studySchema(const Json& parameters, const Json& region) {
  const Json hemispheres = {{"type", "array"},
                            {"minItems", 1},
                            {"description", "L, R or both"},
                            {"items", {{"enum", {"L", "R"}}}}};
  const Json row = {{"type", "array"},
                    {"minItems", 4},
                    {"maxItems", 4},
                    {"description", "a row of the matrix"},
                    {"items", {{"type", "number"}}}};
  const Json affine = {
      {"type", {"array", "string"}},
      {"minItems", 3},
      {"maxItems", 4},
      {"description", "matrix from the subject's to the common coordinates, RAS mm, or its file"},
      {"items", row}};
  const Json options = nestedToo(parameters, "options of explica run");
  const Json ofSubject = {
      {"type", "object"}, {"additionalProperties", false}, {"properties", region}};
  Json ofGroup = ofSubject;
  ofGroup["properties"]["space"] = {
      {"enum", {"subject", "common"}},
      {"description", "whose coordinates these are; common needs each subject's to-common"}};
  ofGroup["properties"]["hemispheres"] = hemispheres;
  const Json subject = {{"type", {"object", "null"}},
                        {"description", "what is particular to a subject"},
                        {"additionalProperties", false},
                        {"properties",
                         {{"input", text("T1, label volume, or FreeSurfer subject directory")},
                          {"atlas", text("for a T1: labels in its space")},
                          {"hemispheres", hemispheres},
                          {"to-common", affine},
                          {"parameters", options},
                          {"regions", regionsOf(ofSubject, "in the subject's own coordinates")}}}};
  const char* const label = "^(sub-)?[A-Za-z0-9]+(_ses-[A-Za-z0-9]+)?$";
  return Json{
      {"$schema", "http://json-schema.org/draft-07/schema#"},
      {"title", "Explica study file"},
      {"type", "object"},
      {"description", "keys of a study file"},
      {"additionalProperties", false},
      {"properties",
       {{"name", text("heads the table's page")},
        {"dataset", text("BIDS data set that inputs are found in")},
        {"input", text("each subject's input, {subject} standing for the label")},
        {"atlas", text("each subject's atlas, likewise")},
        {"to-common", text("each subject's matrix to the common coordinates, likewise")},
        {"hemispheres", hemispheres},
        {"parameters", options},
        {"group",
         {{"type", "object"},
          {"description", "how people are put together by study group"},
          {"additionalProperties", false},
          {"properties",
           {{"include",
             {{"type", "array"},
              {"minItems", 1},
              {"description", "people who count although their run is doubted"},
              {"items", {{"type", "string"}, {"minLength", 1}}}}},
            {"model", text("formula as of explica glm")},
            {"fwhm", {{"type", "number"}, {"description", "mm, smoothing for the model"}}}}}}},
        {"regions", regionsOf(ofGroup, "patches to unfold, by name")},
        {"subjects",
         {{"type", {"array", "object"}},
          {"description", "labels, or labels with what is particular to each"},
          {"minItems", 1},
          {"minProperties", 1},
          {"items", {{"type", {"string", "integer"}}, {"pattern", label}}},
          {"additionalProperties", false},
          {"patternProperties", {{label, subject}}}}}}}};
}

void checkStudyFile(const StudyFile& file, const Json& schema) {
  check(file, file.values, schema, {});
}

}  // namespace explica::study
