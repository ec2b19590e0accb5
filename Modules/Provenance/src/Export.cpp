// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Export.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Provenance/Verify.h"

#include <algorithm>
#include <set>

namespace explica::provenance {
namespace {

namespace fs = std::filesystem;

/// A file by its content, with the name it had.
struct FileFact {
  std::string sha256;
  std::uintmax_t size = 0;
  std::string label;  ///< path below the study, or the name alone
  std::string role;   ///< of an input
  bool inside = false;
};

/// What a record read and wrote, the study's files named by their path below `root`.
struct Account {
  std::string activity;
  std::vector<FileFact> used, generated;
};

std::string below(const fs::path& root, const fs::path& path) {
  std::error_code ignored;
  const fs::path relative =
      fs::weakly_canonical(path, ignored).lexically_relative(fs::weakly_canonical(root, ignored));
  if (relative.empty() || *relative.begin() == "..") return "";
  return relative.generic_string();
}

/// The path below the study at which each file that a record wrote lies, by content.
std::map<std::string, std::string> placesOf(const std::vector<LocatedRecord>& records,
                                            const fs::path& root) {
  std::map<std::string, std::string> places;
  for (const LocatedRecord& located : records) {
    const std::string folder = below(root, located.path.parent_path());
    for (const Json& output : hashedOutputs(located.record)) {
      const std::string name = output["path"];
      places.emplace(output["sha256"],
                     folder.empty() || folder == "." ? name : folder + "/" + name);
    }
  }
  return places;
}

std::vector<Account> accountsOf(const std::vector<LocatedRecord>& records, const fs::path& root) {
  const auto places = placesOf(records, root);
  const auto fact = [&](const Json& entry, const std::string& name) {
    FileFact file;
    file.sha256 = entry["sha256"];
    file.size = entry["size"];
    const auto place = places.find(file.sha256);
    file.inside = place != places.end();
    file.label = file.inside ? place->second : fs::path(name).filename().string();
    return file;
  };
  std::vector<Account> accounts;
  for (const LocatedRecord& located : records) {
    Account account;
    account.activity = activityName(located.record);
    for (const Json& input : located.record["inputs"]) {
      account.used.push_back(fact(input, input["name"]));
      account.used.back().role = input["role"];
    }
    for (const Json& output : hashedOutputs(located.record)) {
      account.generated.push_back(fact(output, output["path"]));
    }
    accounts.push_back(std::move(account));
  }
  return accounts;
}

std::string softwareName(const Json& record) {
  return "explica-" + record["software"]["version"].get<std::string>();
}

/// Elements of which no two have the same Id.
struct Unique {
  Json all = Json::array();
  std::set<std::string> seen = {};
  void add(Json element) {
    if (seen.insert(element["Id"].get<std::string>()).second) all.push_back(std::move(element));
  }
};

/// The command without its paths: options as they were resolved.
std::string commandText(const Json& record) {
  return "explica " + record["command"].get<std::string>();
}

}  // namespace

std::string activityName(const Json& record) {
  return "run-" + record["id"].get<std::string>();
}

std::vector<LocatedRecord> recordsBelow(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().filename() == kRecordName) paths.push_back(entry.path());
  }
  std::ranges::sort(paths);
  std::vector<LocatedRecord> records;
  for (const fs::path& path : paths) {
    try {
      records.push_back({path, readRecord(path)});
    } catch (const IOError&) {
      continue;  // damaged: `verify` tells
    }
  }
  return records;
}

std::vector<LocatedRecord> recordsBehind(const fs::path& first) {
  std::vector<LocatedRecord> records;
  std::set<fs::path> seen;
  std::vector<fs::path> waiting = {first};
  while (!waiting.empty()) {
    const fs::path path = waiting.back();
    waiting.pop_back();
    std::error_code ignored;
    if (!seen.insert(fs::weakly_canonical(path, ignored)).second) continue;
    if (!records.empty() && !isThere(path)) continue;
    records.push_back({path, readRecord(path)});
    for (const fs::path& parent : parentRecords(path)) waiting.push_back(parent);
  }
  return records;
}

Json toProvJson(const std::vector<LocatedRecord>& records) {
  Json prov = Json::object();
  prov["prefix"] = {{"explica", "https://explica.invalid/ns#"},
                    {"sha256", "urn:sha256:"},
                    {"prov", "http://www.w3.org/ns/prov#"}};
  for (const char* part :
       {"entity", "activity", "agent", "used", "wasGeneratedBy", "wasAssociatedWith"}) {
    prov[part] = Json::object();
  }
  const auto relate = [&](const char* relation, Json value) {
    const std::string name = std::string("_:") + relation + std::to_string(prov[relation].size());
    prov[relation][name] = std::move(value);
  };
  const auto entity = [&](const FileFact& file) {
    std::string name = "sha256:" + file.sha256;
    prov["entity"].emplace(name, Json{{"prov:label", file.label}, {"explica:size", file.size}});
    return name;
  };
  const fs::path root = records.empty() ? fs::path() : records.front().path.parent_path();
  const auto accounts = accountsOf(records, root);
  std::set<std::string> made;
  for (std::size_t n = 0; n < records.size(); ++n) {
    const Json& record = records[n].record;
    const std::string activity = "explica:" + accounts[n].activity;
    prov["activity"][activity] = {{"prov:startTime", record["execution"]["started"]},
                                  {"prov:endTime", record["execution"]["ended"]},
                                  {"prov:label", commandText(record)},
                                  {"explica:options", textOf(record["options"])},
                                  {"explica:termination", record["termination"]}};
    const std::string agent = "explica:" + softwareName(record);
    prov["agent"][agent] = {{"prov:type", "prov:SoftwareAgent"},
                            {"explica:commit", record["software"]["commit"]}};
    relate("wasAssociatedWith", {{"prov:activity", activity}, {"prov:agent", agent}});
    for (const FileFact& file : accounts[n].used) {
      relate(
          "used",
          {{"prov:activity", activity}, {"prov:entity", entity(file)}, {"prov:role", file.role}});
    }
    for (const FileFact& file : accounts[n].generated) {
      if (!made.insert(file.sha256 + activity).second) continue;
      relate("wasGeneratedBy", {{"prov:entity", entity(file)}, {"prov:activity", activity}});
    }
  }
  // Of inputs whose makers are not among the records, at least the makers' names.
  for (const LocatedRecord& located : records) {
    for (const Json& input : located.record["inputs"]) {
      if (!input.contains("parent")) continue;
      const std::string maker = "explica:run-" + input["parent"].get<std::string>();
      if (prov["activity"].contains(maker)) continue;
      prov["activity"][maker] = Json::object();
      relate("wasGeneratedBy", {{"prov:entity", "sha256:" + input["sha256"].get<std::string>()},
                                {"prov:activity", maker}});
    }
  }
  return prov;
}

std::map<std::string, Json> toBidsProv(const std::vector<LocatedRecord>& records,
                                       const fs::path& root) {
  const std::string base = "bids::prov#";
  Unique activities, entities, environments, software;
  const auto accounts = accountsOf(records, root);
  const auto nameOfFile = [&](const FileFact& file) {
    return file.inside ? "bids::" + file.label : base + "entity-" + file.sha256.substr(0, 16);
  };
  for (std::size_t n = 0; n < records.size(); ++n) {
    const Json& record = records[n].record;
    const Json& execution = record["execution"];
    const std::string id = base + accounts[n].activity;
    const std::string program = base + softwareName(record);
    const Json& machine = execution["machine"];
    const Json facts = {{"OperatingSystem", machine.value("os", "")},
                        {"Libraries", execution["libraries"]}};
    const std::string environment = base + "env-" + sha256Of(textOf(facts)).substr(0, 12);
    software.add({{"Id", program},
                  {"Label", "Explica"},
                  {"Version", record["software"]["version"]},
                  {"AltIdentifier", "commit:" + record["software"]["commit"].get<std::string>()}});
    Json described = {{"Id", environment}, {"Label", "software environment"}};
    described.update(facts);
    environments.add(described);
    Json used = Json::array({environment});
    const auto addFile = [&](const FileFact& file, bool made) {
      Json entity = {{"Id", nameOfFile(file)},
                     {"Label", fs::path(file.label).filename().string()},
                     {"AtLocation", file.label}};
      if (made) entity["GeneratedBy"] = id;
      entity["Digest"] = {{"sha256", file.sha256}};
      entities.add(std::move(entity));
    };
    for (const FileFact& file : accounts[n].used) {
      used.push_back(nameOfFile(file));
      addFile(file, false);
    }
    for (const FileFact& file : accounts[n].generated) addFile(file, true);
    activities.add({{"Id", id},
                    {"Label", commandText(record)},
                    {"Command", commandText(record) + " --config " + textOf(record["options"])},
                    {"AssociatedWith", program},
                    {"Used", used},
                    {"StartedAtTime", execution["started"]},
                    {"EndedAtTime", execution["ended"]}});
  }
  return {{"prov-explica_act.json", Json{{"Activities", activities.all}}},
          {"prov-explica_ent.json", Json{{"Entities", entities.all}}},
          {"prov-explica_env.json", Json{{"Environments", environments.all}}},
          {"prov-explica_soft.json", Json{{"Software", software.all}}}};
}

}  // namespace explica::provenance
