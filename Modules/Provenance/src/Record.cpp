// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Record.h"

#include "Explica/Core/Errors.h"
#include "Explica/Provenance/Software.h"

namespace explica::provenance {
namespace {

Json digestJson(const Digest& digest) {
  return {{"size", digest.size}, {"sha256", digest.sha256}};
}

/// Names of files without their folders, in any value: for records that shall not tell folders.
Json withoutFolders(const Json& value) {
  if (value.is_string()) {
    const auto text = value.get<std::string>();
    const auto equals = text.rfind("--", 0) == 0 ? text.find('=') : std::string::npos;
    const auto slash = text.rfind('/');
    if (slash == std::string::npos) return value;
    const std::string option = equals == std::string::npos ? "" : text.substr(0, equals + 1);
    return option + text.substr(slash + 1);
  }
  if (!value.is_array() && !value.is_object()) return value;
  Json all = value;
  for (auto& element : all) element = withoutFolders(element);
  return all;
}

Json wordList(const std::vector<std::string>& words) {
  Json array = Json::array();
  for (const auto& word : words) array.push_back(word);
  return array;
}

}  // namespace

std::string Record::id() const {
  Json identity = Json::object();
  identity["version"] = software().version;
  identity["command"] = command;
  identity["options"] = options;
  Json files = Json::array();
  for (const auto& input : inputs) files.push_back({input.role, input.digest.sha256});
  identity["inputs"] = files;
  return sha256Of(identity.dump()).substr(0, 32);
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
  json["options"] = r.options;

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
  json["warnings"] = wordList(r.warnings);
  json["termination"] = nameOf(r.termination);
  json["exit_code"] = r.exitCode;
  json["results"] = r.results;
  json["notes"] = r.notes;

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
  execution["arguments"] = r.withNames ? r.arguments : withoutFolders(r.arguments);
  execution["argv"] = r.withNames ? wordList(r.argv) : withoutFolders(wordList(r.argv));
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
  Json record = readJson(path);
  const auto faults = schemaFaults(record, recordSchema());
  if (!faults.empty()) {
    throw IOError(path.string() + ": not a provenance record of Explica: " + faults.back());
  }
  return record;
}

std::optional<FoundRecord> findRecordOf(const std::filesystem::path& file, const Digest& digest) {
  constexpr int kFoldersAbove = 3;  // outputs lie in their record's folder or shortly below it
  std::error_code fault;
  const auto absolute = std::filesystem::weakly_canonical(file, fault);
  if (fault) return std::nullopt;
  auto folder = absolute.parent_path();
  for (int level = 0; level <= kFoldersAbove && !folder.empty(); ++level) {
    const auto candidate = folder / kRecordName;
    if (candidate != absolute && std::filesystem::is_regular_file(candidate, fault)) {
      try {
        Json record = readRecord(candidate);
        const auto name = absolute.lexically_relative(folder).generic_string();
        for (const char* list : {"outputs", "varying"}) {
          const Json& outputs = std::string_view(list) == "outputs"
                                    ? record["outputs"]
                                    : record["execution"]["varying_outputs"];
          for (const auto& output : outputs) {
            if (output["path"] != name || !output.contains("sha256")) continue;
            const bool same = output["sha256"] == digest.sha256;
            return FoundRecord{candidate, record, same};
          }
        }
      } catch (const Error&) {
        // Another program's provenance.json, or a damaged one: not a record of this file.
      }
    }
    if (folder == folder.root_path()) break;
    folder = folder.parent_path();
  }
  return std::nullopt;
}

}  // namespace explica::provenance
