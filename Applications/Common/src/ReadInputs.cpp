// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/ReadInputs.h"

#include "Explica/Core/Errors.h"
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
}

}  // namespace

Volume<float> readScalars(Context& context, const std::string& name, const std::string& path,
                          const io::VolumeReadOptions& options) {
  io::LoadedVolume<float> loaded = io::readScalars(path, options);
  record(context, name, path, loaded.origin);
  return std::move(loaded.volume);
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
  return loaded;
}

void sayHowRead(Context& context, const io::SurfaceOrigin& origin) {
  say(context, origin.path.string(), origin.notes);
}

}  // namespace explica::app
