// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Record.h"

#include "Explica/Core/Errors.h"
#include "Explica/Provenance/Software.h"

#include <algorithm>

namespace explica::provenance {
namespace {

Json digestJson(const Digest& digest) {
  return {{"size", digest.size}, {"sha256", digest.sha256}};
}

Json wordList(const std::vector<std::string>& words) {
  Json array = Json::array();
  for (const auto& word : words) array.push_back(word);
  return array;
}

/// Ends a path that is not quoted.
bool endsPath(char c) {
  return std::string_view(" \t\n\r\"'<>|;,()[]{}=").find(c) != std::string_view::npos;
}

std::string nameOfPath(const std::string& word) {
  const auto slash = word.find_last_of('/');
  if (slash == std::string::npos) return word;
  const std::string name = word.substr(slash + 1);
  const bool rooted = word[0] == '/' || word[0] == '~' || word.starts_with("../");
  return rooted || name.find('.') != std::string::npos ? name : word;
}

}  // namespace

std::string textWithoutFolders(std::string_view text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    if (endsPath(text[at])) {
      result += text[at++];
      continue;
    }
    // Within quotes a path may hold spaces and the like.
    const char before = at > 0 ? text[at - 1] : ' ';
    std::size_t end = at;
    const auto closing = text.find(before, at);
    const bool quoted = (before == '\'' || before == '"') && closing != std::string_view::npos &&
                        (text[at] == '/' || text[at] == '~' || text[at] == '.');
    if (quoted) {
      end = closing;
    } else {
      while (end < text.size() && !endsPath(text[end])) ++end;
    }
    std::string word(text.substr(at, end - at));
    // A sentence's own colon or full stop after a path.
    std::string tail;
    while (word.size() > 1 && (word.back() == ':' || word.back() == '.')) {
      tail.insert(tail.begin(), word.back());
      word.pop_back();
    }
    result += nameOfPath(word) + tail;
    at = end;
  }
  return result;
}

Json withoutFolders(const Json& value) {
  if (value.is_string()) return textWithoutFolders(value.get_ref<const std::string&>());
  if (!value.is_array() && !value.is_object()) return value;
  Json all = value;
  for (auto& element : all) element = withoutFolders(element);
  return all;
}

std::string Record::id() const {
  Json identity = Json::object();
  identity["version"] = software().version;
  identity["command"] = command;
  identity["options"] = options;
  Json files = Json::array();
  for (const auto& input : inputs) files.push_back({input.role, input.digest.sha256});
  identity["inputs"] = files;
  return sha256Of(textOf(identity)).substr(0, 32);
}

Json toJson(const Record& r) {
  Json json = Json::object();
  json["format"] = "explica-provenance";
  json["format_version"] = 1;
  json["id"] = r.id();
  const Software& made = software();
  json["software"] = {{"name", "explica"},
                      {"version", made.version},
                      {"commit", made.commit},
                      {"dirty", made.dirty}};
  json["command"] = r.command;
  const auto told = [&](const Json& value) { return r.withNames ? value : withoutFolders(value); };
  json["options"] = told(r.options);
  json["given"] = wordList(r.given);

  json["inputs"] = Json::array();
  for (const auto& input : r.inputs) {
    Json entry = {{"role", input.role}, {"name", input.given.filename().string()}};
    entry.update(digestJson(input.digest));
    if (input.parent) entry["parent"] = input.parent->id;
    json["inputs"].push_back(entry);
  }
  Json varying = Json::array();
  json["outputs"] = Json::array();
  for (const auto& output : r.outputs) {
    Json entry = {{"path", output.path}};
    if (output.varies) {
      entry["varies"] = true;
      Json whole = {{"path", output.path}};
      whole.update(digestJson(output.digest));
      varying.push_back(whole);
    } else {
      entry.update(digestJson(output.digest));
    }
    json["outputs"].push_back(entry);
  }
  Json stepTimes = Json::array();
  json["steps"] = Json::array();
  for (const auto& step : r.steps) {
    Json entry = {{"name", step.name}};
    if (step.iterations) entry["iterations"] = *step.iterations;
    entry["termination"] = nameOf(step.termination);
    json["steps"].push_back(entry);
    stepTimes.push_back({{"name", step.name}, {"seconds", step.seconds}});
  }
  json["warnings"] = told(wordList(r.warnings));
  json["termination"] = nameOf(r.termination);
  json["exit_code"] = r.exitCode;
  json["results"] = told(r.results);
  json["meanings"] = told(r.meanings);
  json["notes"] = told(r.notes);

  Json execution = Json::object();
  execution["started"] = r.started;
  execution["ended"] = r.ended;
  execution["seconds"] = r.seconds;
  execution["cpu_seconds"] = r.cpuSeconds;
  execution["steps"] = stepTimes;
  execution["peak_memory_bytes"] = r.peakMemoryBytes;
  execution["threads"] = {{"count", r.threads}, {"because", r.threadsBecause}};
  execution["build"] = {{"type", made.buildType}, {"compiler", made.compiler}};
  execution["libraries"] = describeLibraries();
  execution["machine"] = describeMachine(r.withNames);
  execution["private"] = !r.withNames;
  execution["arguments"] = told(r.arguments);
  execution["argv"] = told(wordList(r.argv));
  if (r.withNames) {
    execution["directory"] = r.directory.string();
    execution["out"] = r.out.string();
  }
  execution["inputs"] = Json::array();
  for (const auto& input : r.inputs) {
    Json entry = {{"role", input.role},
                  {"given", (r.withNames ? input.given : input.given.filename()).string()}};
    if (r.withNames) entry["absolute"] = input.absolute.string();
    if (input.parent) {
      entry["parent_record"] = {{"sha256", input.parent->sha256}};
      if (r.withNames) entry["parent_record"]["path"] = input.parent->path.string();
    }
    execution["inputs"].push_back(entry);
  }
  execution["varying_outputs"] = varying;
  json["execution"] = execution;
  return json;
}

Json readRecord(const std::filesystem::path& path) {
  const Json record = readJson(path);
  const auto refuse = [&](const std::string& fault) {
    throw IOError(path.string() + ": not a provenance record of Explica: " + fault);
  };
  const auto faults = schemaFaults(record, recordSchema());
  if (!faults.empty()) refuse(faults.back());
  const Json& execution = record["execution"];
  if (execution["inputs"].size() != record["inputs"].size()) {
    refuse("its execution names " + std::to_string(execution["inputs"].size()) + " of " +
           std::to_string(record["inputs"].size()) + " inputs");
  }
  for (const Json* outputs : {&record["outputs"], &execution["varying_outputs"]}) {
    for (const Json& output : *outputs) {
      const auto name = output["path"].get<std::string>();
      if (!staysBelow(name)) refuse("output '" + printable(name) + "' is no name in its folder");
    }
  }
  return record;
}

std::vector<Json> hashedOutputs(const Json& record) {
  std::vector<Json> outputs(record["outputs"].begin(), record["outputs"].end());
  std::erase_if(outputs, [](const Json& output) { return !output.contains("sha256"); });
  const Json& varying = record["execution"]["varying_outputs"];
  outputs.insert(outputs.end(), varying.begin(), varying.end());
  return outputs;
}

bool staysBelow(const std::filesystem::path& name) {
  const std::string text = name.string();
  const bool controls =
      std::ranges::any_of(text, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
  if (text.empty() || name.is_absolute() || controls) return false;
  return std::ranges::none_of(name, [](const auto& part) { return part == ".."; });
}

std::optional<std::filesystem::path> ownFile(const std::filesystem::path& folder,
                                             const std::filesystem::path& name) {
  if (!staysBelow(name)) return std::nullopt;
  std::error_code fault;
  const auto root = std::filesystem::weakly_canonical(folder.empty() ? "." : folder, fault);
  if (fault) return std::nullopt;
  const auto place = std::filesystem::weakly_canonical(root / name, fault);
  if (fault || !staysBelow(place.lexically_relative(root))) return std::nullopt;
  return folder / name;
}

std::string printable(std::string_view text) {
  std::string safe;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const auto byte = [&](std::size_t ahead) {
      return at + ahead < text.size() ? static_cast<unsigned char>(text[at + ahead]) : 0U;
    };
    // Line breaks too: a file's name may hold one, and a message is one line.
    const bool control = byte(0) < 0x20 || byte(0) == 0x7f;
    // In UTF-8: the other control characters, and marks that turn the direction of what follows.
    const bool highControl = byte(0) == 0xc2 && byte(1) >= 0x80 && byte(1) < 0xa0;
    const bool turning =
        byte(0) == 0xe2 && ((byte(1) == 0x80 && byte(2) >= 0xaa && byte(2) <= 0xae) ||
                            (byte(1) == 0x81 && byte(2) >= 0xa6 && byte(2) <= 0xa9));
    safe += control || highControl || turning ? '?' : text[at];
    at += highControl ? 1 : turning ? 2 : 0;
  }
  return safe;
}

}  // namespace explica::provenance
