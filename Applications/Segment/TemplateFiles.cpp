// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "TemplateFiles.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"
#include "Explica/Core/Folders.h"
#include "Explica/IO/LabelNames.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Provenance/Doubts.h"
#include "Explica/Segmentation/Hemisphere.h"

#include <filesystem>

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
  if (name == "inia19") {
    return {{}, kMricron / "inia19-t1-brain.nii.gz", kMricron / "inia19-NeuroMaps.nii.gz"};
  }
  const fs::path folder = name;
  if (!isFolder(folder)) {
    throw InvalidInput(
        "template: '" + name +
        "' is neither colin27 nor inia19 nor none nor a folder with brain.nii.gz and atlas.nii.gz");
  }
  return {folder / "T1.nii.gz", folder / "brain.nii.gz", folder / "atlas.nii.gz"};
}

/// Reads a volume of a template.  Where its header places the voxels in two ways, the sform counts:
/// it is the one that leads to a stereotaxic frame; registration finds the rest, and only which
/// side is left depends on it.
template <class Read>
auto readPlaced(Context& context, const fs::path& path, const Read& read) {
  io::VolumeReadOptions reading{.dimension = 3};
  try {
    return read(reading).volume;
  } catch (const InvalidInput&) {
    reading.placement = io::PlacementChoice::Sform;
    const auto loaded = read(reading);
    if (!(loaded.origin.placementsApart > 0)) throw;
    context.doubt(provenance::kHeadersDisagree, 1,
                  "template: qform and sform of " + path.filename().string() +
                      " place its voxels differently; the sform is taken, and says which side is "
                      "left");
    return loaded.volume;
  }
}

}  // namespace

std::optional<LoadedTemplate> readTemplate(Context& context, const std::string& name) {
  const TemplatePaths paths = pathsOf(name);
  if (!isThere(paths.brain) || !isThere(paths.atlas)) {
    if (name == "colin27") return {};
    if (name == "inia19") {
      throw InvalidInput("template: inia19 is not installed; install the package mricron-data");
    }
    throw InvalidInput("template: " + name + " lacks brain.nii.gz or atlas.nii.gz");
  }
  LoadedTemplate loaded;
  const auto scalars = [&](const fs::path& path) {
    const fs::path file = context.input(path, "template");
    return readPlaced(context, file, [&](const io::VolumeReadOptions& reading) {
      return io::readScalars(file, reading);
    });
  };
  loaded.volumes.brain = scalars(paths.brain);
  const fs::path atlas = context.input(paths.atlas, "template");
  loaded.volumes.atlas = readPlaced(context, atlas, [&](const io::VolumeReadOptions& reading) {
    return io::readLabels(atlas, reading);
  });
  if (isThere(paths.head)) loaded.volumes.head = scalars(paths.head);
  for (const Grid* grid : {&loaded.volumes.atlas.grid, &loaded.volumes.head.grid}) {
    if (grid->voxelCount() != 0 && !sameGrid(*grid, loaded.volumes.brain.grid)) {
      throw InvalidInput("template: the volumes of " + name + " lie on different grids");
    }
  }
  loaded.legend =
      name == "inia19" ? segmentation::inia19Legend() : readAtlasLegend(context, paths.atlas, {});
  loaded.stem = segmentation::labelStem(loaded.volumes.atlas, loaded.legend);
  segmentation::labelVentricles(loaded.volumes.brain, loaded.volumes.atlas, loaded.legend);
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
  return segmentation::parseAtlasLegend(fileText(path), path.string());
}

}  // namespace explica::app
