// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/ReadInputs.h"

#include "Explica/Core/Errors.h"
#include "Explica/Provenance/Digest.h"
#include "Explica/Provenance/Doubts.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Segmentation/HeadContrast.h"
#include "Explica/Segmentation/Plausibility.h"

#include <nlohmann/json.hpp>

namespace explica::app {
namespace {

using Json = nlohmann::ordered_json;

Json rowsOf(const Eigen::Matrix4d& matrix) {
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row) {
    rows.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)});
  }
  return rows;
}

void say(Context& context, const std::string& path, const std::vector<std::string>& notes) {
  for (const std::string& note : notes) context.info("'" + path + "': " + note);
}

void record(Context& context, const std::string& name, const std::string& path,
            const io::VolumeOrigin& origin) {
  Json understood = {{"format", origin.format},
                     {"stored_type", origin.storedType},
                     {"stored_size", origin.storedSize},
                     {"placement", origin.placement}};
  if (origin.qformCode) understood["qform_code"] = *origin.qformCode;
  if (origin.sformCode) understood["sform_code"] = *origin.sformCode;
  understood["affine"] = rowsOf(origin.affine);
  understood["notes"] = origin.notes;
  context.note(name, understood);
  say(context, path, origin.notes);
  const bool disagree = origin.placementsApart > 0;
  context.doubt(provenance::kHeadersDisagree, disagree ? 1 : 0,
                "'" + path + "': its qform and sform place the voxels differently (by up to " +
                    std::to_string(origin.placementsApart) + " voxels); the " + origin.placement +
                    " is used, as chosen");
  context.doubt(provenance::kPlacementsAssumed, origin.placement == io::kNotPlaced ? 1 : 0,
                "'" + path + "': its header does not say where the voxels lie; that is assumed");
}

/// Where a volume lay, by what a record notes of it.
std::optional<Grid> notedGrid(const Json& note) {
  const Json rows = note.value("affine", Json::array()),
             size = note.value("stored_size", Json::array());
  if (rows.size() != 4 || size.size() < 3) return {};
  Grid grid;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector step(rows[0][axis], rows[1][axis], rows[2][axis]);
    if (!(step.norm() > 0) || !step.allFinite()) return {};
    grid.size[axis] = size[axis];
    grid.spacing[axis] = step.norm();
    grid.direction.col(axis) = step.normalized();
    grid.origin[axis] = rows[axis][3];
  }
  return grid;
}

/// The volume that a surface was made from, by the record beside it.
std::optional<Grid> gridOfOrigin(const std::filesystem::path& surface) {
  const auto found = provenance::findRecordOf(surface, provenance::digestOf(surface));
  if (!found || !found->sameContent || found->record.value("command", "") != "surface") return {};
  const Json notes = found->record.value("notes", Json::object());
  for (const auto& [name, note] : notes.items()) {
    if (const auto grid = notedGrid(note)) return grid;
  }
  return {};
}

}  // namespace

Eigen::Matrix4d surfaceFromTkr(const io::LoadedSurface& surface,
                               const io::SurfaceReadOptions& options) {
  if (!surface.origin.applied.isIdentity(1e-6)) return surface.origin.applied;
  if (options.fsVolume) return io::scannerFromTkr(io::readGrid(*options.fsVolume));
  const auto grid = gridOfOrigin(surface.origin.path);
  return grid ? io::scannerFromTkr(*grid) : Eigen::Matrix4d::Identity();
}

Volume<float> readScalars(Context& context, const std::string& name, const std::string& path,
                          const io::VolumeReadOptions& options) {
  io::LoadedVolume<float> loaded = io::readScalars(path, options);
  record(context, name, path, loaded.origin);
  return std::move(loaded.volume);
}

Volume<float> readBrightness(Context& context, const std::string& name, const std::string& path,
                             const io::VolumeReadOptions& options) {
  Volume<float> image = readScalars(context, name, path, options);
  if (const float lift = segmentation::countFromAir(image); lift > 0) {
    context.info(path + ": air is " + std::to_string(-lift) + ", and is taken as 0");
  }
  return image;
}

Volume<Label> readLabels(Context& context, const std::string& name, const std::string& path,
                         const io::VolumeReadOptions& options) {
  io::LoadedVolume<Label> loaded = io::readLabels(path, options);
  record(context, name, path, loaded.origin);
  return std::move(loaded.volume);
}

Volume<Label> readTissueLabels(Context& context, const std::string& name, const std::string& path,
                               const io::VolumeReadOptions& options) {
  Volume<Label> labels = readLabels(context, name, path, options);
  if (segmentation::looksLikeImage(labels)) {
    throw InvalidInput(path +
                       ": holds more than 64 values and most neighbours differ, as in an image; "
                       "expected labels (explica segment makes them from a T1)");
  }
  return labels;
}

io::LoadedSurface readSurface(Context& context, const std::string& name, const std::string& path,
                              const io::SurfaceReadOptions& options) {
  if (options.fsVolume) context.input(*options.fsVolume, "fs-volume");
  io::LoadedSurface loaded = io::readSurface(path, options);
  const io::SurfaceOrigin& origin = loaded.origin;
  context.note(name, Json{{"format", origin.format},
                          {"structure", loaded.metadata.structure},
                          {"space", origin.space},
                          {"applied_matrix", rowsOf(origin.applied)},
                          {"notes", origin.notes}});
  context.doubt(provenance::kFramesNotStated, origin.space == io::kFrameNotStated ? 1 : 0,
                "'" + path + "': " + std::string(io::kFrameNotStatedNote));
  return loaded;
}

void sayHowRead(Context& context, const io::SurfaceOrigin& origin) {
  std::vector<std::string> notes = origin.notes;
  std::erase(notes, io::kFrameNotStatedNote);  // a warning since it was read
  say(context, origin.path.string(), notes);
}

}  // namespace explica::app
