// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Subject.h"

#include "AutomaticCuts.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Flattening/Disc.h"
#include "Explica/Flattening/Selection.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/PatchFile.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Provenance/Digest.h"
#include "Explica/Provenance/Record.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

namespace explica::app {
namespace {

/// The surface that an unfolding's record names, if it is still there unchanged.
std::optional<std::filesystem::path> recordedOriginal(const std::filesystem::path& surface) {
  const auto found = provenance::findRecordOf(surface, provenance::digestOf(surface));
  if (!found || !found->sameContent || found->record.value("command", "") != "unfold") return {};
  const auto& inputs = found->record["inputs"];
  const auto& places = found->record["execution"]["inputs"];
  for (std::size_t n = 0; n < inputs.size() && n < places.size(); ++n) {
    if (inputs[n].value("role", "") != "SURFACE") continue;
    const std::filesystem::path path = places[n].value("absolute", std::string());
    if (path.empty() || !isThere(path)) continue;
    if (provenance::digestOf(path).sha256 == inputs[n].value("sha256", "")) return path;
  }
  return {};
}

std::vector<std::int32_t> facesOfCuts(Context& context, const FlattenSettings& s,
                                      const TriangleMesh& mesh) {
  const auto all = mesh.allFaces();
  if (*s.cuts == kAutomatic) {
    const bool closed = geometry::boundaryLoops(mesh.faces, mesh.vertexCount()).empty();
    if (!s.labels.empty() || !closed) return all;
    return flattening::facesWithoutWall(mesh, cortexOf(context, s.surface, mesh, s.cortex));
  }
  context.input(*s.cuts, "cuts");
  if (io::isPatchFile(*s.cuts)) {
    const io::Patch patch = io::readPatch(*s.cuts, mesh.vertexCount());
    return flattening::facesAlsoIn(mesh.faces, all,
                                   io::patchFaces(patch, mesh.faces, mesh.vertexCount()));
  }
  std::optional<TriangleMesh> flat;
  try {
    flat = readSurface(context, "cuts", *s.cuts, s.reading).mesh;
  } catch (const Error&) {
    // No surface: a label.
  }
  if (flat) {
    requireSameVertices(*flat, mesh, *s.cuts);
    return flattening::facesAlsoIn(mesh.faces, all, flat->faces);
  }
  const auto labels = io::readVertexLabels(*s.cuts, mesh.vertexCount());
  return flattening::facesWithin(mesh.faces, all, labels.keys);
}

}  // namespace

void requireSameVertices(const TriangleMesh& a, const TriangleMesh& b, const std::string& name) {
  if (a.vertexCount() == b.vertexCount()) return;
  throw InvalidInput("'" + name + "': has " + std::to_string(a.vertexCount()) +
                     " vertices where the surface has " + std::to_string(b.vertexCount()));
}

Subject subjectOf(Context& context, const FlattenSettings& s) {
  Subject subject;
  io::LoadedSurface loaded = readSurface(context, "SURFACE", s.surface, s.reading);
  std::optional<std::filesystem::path> original;
  if (s.reference) original = *s.reference;
  const auto recorded = s.reference ? std::nullopt : recordedOriginal(s.surface);
  if (recorded) original = context.input(*recorded, "reference");
  TriangleMesh mesh = loaded.mesh;
  if (original) {
    const auto reference = readSurface(context, "reference", original->string(), s.reading);
    requireSameVertices(reference.mesh, mesh, original->string());
    mesh.positions = reference.mesh.positions;
    context.info("areas and lengths are those of '" + original->string() + "'");
  }
  // Faces that run clockwise seen from outside would be laid out mirrored.
  if (geometry::inspectMesh(mesh).closedManifold()) geometry::turnOutward(mesh);
  subject.faces = mesh.allFaces();
  if (s.cuts == kOfTemplate) {
    subject.cuts = readTemplateCuts(context, s, mesh);
    subject.faces = flattening::facesWithoutWall(mesh, subject.cuts->cortex);
  } else if (s.cuts) {
    subject.faces = facesOfCuts(context, s, mesh);
  }
  const bool isBall = s.region.center || s.region.vertex;
  if (isBall) subject.faces = unfolding::selectRegion(mesh, s.region).faces;
  if (!s.labels.empty()) {
    const auto marked =
        io::markedByLabels({s.labels.begin(), s.labels.end()}, s.labelKeys, mesh.vertexCount());
    flattening::VertexKeys keys(mesh.vertexCount());
    std::copy(marked.begin(), marked.end(), keys.begin());
    subject.faces = flattening::facesWithin(mesh.faces, subject.faces, keys);
  }
  const auto region = std::filesystem::path(s.surface).parent_path() / "region.label.gii";
  if (recorded && s.labels.empty() && !s.cuts && !isBall && isThere(region)) {
    const auto labels = io::readVertexLabels(context.input(region, "region"), mesh.vertexCount());
    subject.faces = flattening::facesWithin(mesh.faces, subject.faces, labels.keys);
  }
  loaded.mesh = std::move(mesh);
  subject.reference = std::move(loaded);
  return subject;
}

}  // namespace explica::app
