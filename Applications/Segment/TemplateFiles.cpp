// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "TemplateFiles.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/LabelNames.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Segmentation/Hemisphere.h"

#include <filesystem>
#include <fstream>
#include <iterator>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

struct TemplatePaths {
  fs::path head, brain, atlas;
};

// Debian's and NeuroDebian's package mricron-data.
const fs::path kMricron = "/usr/share/mricron/templates";

TemplatePaths pathsOf(const std::string& name) {
  if (name == "colin27") {
    return {kMricron / "ch2.nii.gz", kMricron / "ch2bet.nii.gz", kMricron / "aal.nii.gz"};
  }
  const fs::path folder = name;
  if (!fs::is_directory(folder)) {
    throw InvalidInput("template: '" + name +
                       "' is neither colin27 nor none nor a folder with brain.nii.gz and "
                       "atlas.nii.gz");
  }
  return {folder / "T1.nii.gz", folder / "brain.nii.gz", folder / "atlas.nii.gz"};
}

}  // namespace

std::optional<LoadedTemplate> readTemplate(Context& context, const std::string& name) {
  const TemplatePaths paths = pathsOf(name);
  if (!fs::exists(paths.brain) || !fs::exists(paths.atlas)) {
    if (name == "colin27") return {};
    throw InvalidInput("template: " + name + " lacks brain.nii.gz or atlas.nii.gz");
  }
  LoadedTemplate loaded;
  const io::VolumeReadOptions reading{.dimension = 3};
  loaded.volumes.brain = io::readScalars(context.input(paths.brain, "template"), reading).volume;
  loaded.volumes.atlas = io::readLabels(context.input(paths.atlas, "template"), reading).volume;
  if (fs::exists(paths.head)) {
    loaded.volumes.head = io::readScalars(context.input(paths.head, "template"), reading).volume;
  }
  for (const Grid* grid : {&loaded.volumes.atlas.grid, &loaded.volumes.head.grid}) {
    if (grid->voxelCount() != 0 && !sameGrid(*grid, loaded.volumes.brain.grid)) {
      throw InvalidInput("template: the volumes of " + name + " lie on different grids");
    }
  }
  loaded.legend = readAtlasLegend(context, paths.atlas, {});
  loaded.stem = segmentation::labelStem(loaded.volumes.atlas, loaded.legend);
  return loaded;
}

segmentation::AtlasLegend readAtlasLegend(Context& context, const fs::path& atlas,
                                          const std::optional<std::string>& legend) {
  fs::path path;
  if (legend) {
    path = *legend;
  } else if (const auto beside = io::findLegend(atlas)) {
    path = context.input(*beside, "atlas-legend");
  } else {
    throw InvalidInput(atlas.string() +
                       ": no legend (.tsv or .nii.txt) beside it; name one with --atlas-legend");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw IOError(path.string() +
                  ": cannot be opened; name the atlas's legend with --atlas-legend");
  }
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return segmentation::parseAtlasLegend(text, path.string());
}

}  // namespace explica::app
