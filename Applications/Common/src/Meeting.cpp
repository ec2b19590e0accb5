// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Meeting.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/StatedHemisphere.h"
#include "Explica/IO/SurfaceFile.h"

#include <algorithm>
#include <optional>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

constexpr const char* kOfOnePerson = "person";  // role of a file of one of many people
constexpr int kFurthestBack = 8;  // commands from a surface to the one that it was made from

bool isSurface(const Parameter* p) {
  return p && p->file && *p->file == FileKind::Surface;
}

bool isVertexData(const Parameter* p) {
  return p && p->file && (*p->file == FileKind::VertexData || *p->file == FileKind::VertexLabel);
}

/// Whether a file is another person's, and may then be of any side; null of the person's own.
const bool* ofAnother(const Parameter* p) {
  return p ? p->ofAnother : nullptr;
}

/// Whether a name is one of a surface's; FreeSurfer's (lh.pial) cannot be told from its maps'.
bool namesSurface(const fs::path& file) {
  const std::string name = file.filename().string();
  for (const char* other : {".shape.gii", ".func.gii", ".label.gii"}) {
    if (name.find(other) != std::string::npos) return false;
  }
  if (name.starts_with("lh.") || name.starts_with("rh.")) return true;
  const auto endings = io::surfaceEndings();
  return std::any_of(endings.begin(), endings.end(),
                     [&](const std::string& ending) { return name.ends_with(ending); });
}

/// Adds the hashes of the surfaces that a record lists, and of those that these were made from.
void addSurfaces(const Json& record, int further, std::set<std::string>& hashes) {
  for (const Json& output : record["outputs"]) {
    if (namesSurface(output["path"].get<std::string>()) && output.contains("sha256")) {
      hashes.insert(output["sha256"]);
    }
  }
  const Json& places = record["execution"]["inputs"];
  for (std::size_t n = 0; n < record["inputs"].size() && n < places.size(); ++n) {
    const fs::path path = places[n].value("absolute", places[n].value("given", std::string()));
    if (!namesSurface(path)) continue;
    const std::string hash = record["inputs"][n]["sha256"];
    hashes.insert(hash);
    if (further == 0) continue;
    const auto before = provenance::findRecordOf(path, provenance::Digest{0, hash});
    if (before && before->sameContent) addSurfaces(before->record, further - 1, hashes);
  }
}

std::string optionText(const std::string& role, const Parameter* parameter) {
  return parameter && !parameter->positional ? " (--" + role + ")" : "";
}

}  // namespace

bool filesMeet(const Declaration& declaration) {
  if (declaration.writesInPlace || declaration.handsOutputOn) return false;
  int files = 0;
  for (const Parameter& p : declaration.parameters) {
    if (!isSurface(&p) && !isVertexData(&p) && !p.oneByOne) continue;
    files += p.option.isList && !p.oneByOne ? 2 : 1;
  }
  return files > 1;
}

Meeting::Meeting(const Declaration& declaration, const std::set<std::string>& given,
                 std::vector<std::string> accepted)
    : declaration_(declaration), accepted_(std::move(accepted)) {
  const bool ownLimits = declaration.find("accept") != nullptr;
  for (const std::string& name : accepted_) {
    if (!ownLimits && name != kAcceptHemisphere && name != kAcceptMesh) {
      throw UsageError("accept: '" + name + "' is not one of " + kAcceptHemisphere + ", " +
                       kAcceptMesh);
    }
  }
  const Parameter* hemisphere = declaration.find("hemisphere");
  if (!hemisphere || !given.count("hemisphere")) return;
  const std::string side = hemisphere->option.text();
  File option{"hemisphere", "--hemisphere " + side, {}, nullptr, {}};
  if (side == "L") option.side = Hemisphere::Left;
  if (side == "R") option.side = Hemisphere::Right;
  files_.push_back(option);
}

std::string Meeting::sidesOf(const File& one, const File& other) {
  const bool alike = one.role == other.role && one.parameter && one.parameter->oneByOne;
  if (!one.side || !other.side || *one.side == *other.side || alike) return {};
  return one.name + " is of the " + std::string(nameOf(*one.side)) + " hemisphere, " + other.name +
         " of the " + std::string(nameOf(*other.side)) + " hemisphere";
}

std::string Meeting::meshesOf(const File& one, const File& other) {
  if (isVertexData(other.parameter)) {
    return isVertexData(one.parameter) ? std::string() : meshesOf(other, one);
  }
  if (!isVertexData(one.parameter) || one.surfaces.empty() || other.surfaces.empty()) return {};
  const bool shared = std::any_of(one.surfaces.begin(), one.surfaces.end(),
                                  [&](const auto& hash) { return other.surfaces.count(hash) > 0; });
  if (shared) return {};
  return one.name + " was not made for the mesh of " + other.name + ", as their records tell";
}

bool Meeting::hasBothSides(const std::string& role) const {
  std::set<Hemisphere> sides;
  for (const File& file : files_) {
    const bool counts = file.role == role && file.parameter && file.parameter->oneByOne;
    if (counts && file.side) sides.insert(*file.side);
  }
  return sides.size() == 2;
}

void Meeting::contradict(const char* name, const std::string& sentence,
                         std::vector<std::string>& sentences) const {
  if (sentence.empty()) return;
  if (std::find(accepted_.begin(), accepted_.end(), name) == accepted_.end()) {
    throw InvalidInput(sentence + "; --accept " + name + " goes on all the same");
  }
  sentences.push_back(sentence);
}

std::vector<std::string> Meeting::add(const std::string& role, const fs::path& path,
                                      const std::string& sha256,
                                      const std::optional<provenance::FoundRecord>& found) {
  std::vector<std::string> sentences;
  const Parameter* parameter = declaration_.find(role);
  const bool declared =
      isSurface(parameter) || isVertexData(parameter) || (parameter && parameter->oneByOne);
  const bool otherFile = parameter && parameter->file && !declared;
  if (!filesMeet(declaration_) || otherFile || role == kOfOnePerson) return sentences;
  File file{role,
            "'" + path.string() + "'" + optionText(role, parameter),
            io::statedHemisphere(path),
            parameter,
            {}};
  if (found && found->sameContent && declared) {
    addSurfaces(found->record, kFurthestBack, file.surfaces);
    if (!isVertexData(parameter)) {
      if (!file.surfaces.empty()) file.surfaces.insert(sha256);
      if (!namesSurface(path)) file.surfaces.clear();
    }
  }
  if (parameter && parameter->side) {
    if (file.side && *file.side != *parameter->side) {
      contradict(kAcceptHemisphere,
                 file.name + " is of the " + std::string(nameOf(*file.side)) + " hemisphere",
                 sentences);
    }
    return sentences;
  }
  for (const File& other : files_) {
    if (other.role != role && hasBothSides(other.role)) continue;
    const bool *mine = ofAnother(parameter), *theirs = ofAnother(other.parameter);
    const bool apart = (mine == nullptr) != (theirs == nullptr);
    if (!apart || !*(mine ? mine : theirs))
      contradict(kAcceptHemisphere, sidesOf(other, file), sentences);
    if (!apart) contradict(kAcceptMesh, meshesOf(other, file), sentences);
  }
  files_.push_back(file);
  return sentences;
}

}  // namespace explica::app
