// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "CortexRegions.h"

#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/Maps/Regions.h"
#include "Explica/Segmentation/Atlas.h"
#include "Explica/Segmentation/VoxelBox.h"
#include "Explica/Surface/Regions.h"
#include "Explica/Surface/Summary.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <span>
#include <sstream>

namespace explica::app {

using surface::Columns;
using surface::VertexKeys;

namespace {

std::string regionName(const CortexRegions& regions, Label key) {
  const auto named = regions.names.find(key);
  if (named != regions.names.end()) return named->second;
  const std::string freeSurfer = io::freeSurferRegion(key);
  return freeSurfer.empty() ? "label" + std::to_string(key) : freeSurfer;
}

/// The colour in which its atlas shows a region; else one that tells neighbours apart.
std::array<float, 4> regionColour(const CortexRegions& regions, Label key) {
  const auto given = regions.colours.find(key);
  if (given != regions.colours.end()) return given->second;
  const auto freeSurfer = io::freeSurferEntry(key);
  return freeSurfer && !io::freeSurferRegion(key).empty() ? freeSurfer->colour
                                                          : io::distinctColour(key);
}

/// What is no region of this side's cortex: FreeSurfer's words for that, and by AAL's names what
/// lies below or on the other side.
bool noRegion(const std::string& name, const std::string& structure) {
  using segmentation::Side;
  if (io::meansNoRegion(name) || name == "corpuscallosum") return true;
  const auto named = segmentation::structureNamed(name);
  const Side other = structure == "CortexRight" ? Side::Left : Side::Right;
  return named.kind != segmentation::StructureKind::Cortex || named.side == other;
}

/// Region of each column between white and outer border; 0 where there is none.
VertexKeys regionKeys(const CortexRegions& regions, const Positions& white, const Positions& pial,
                      const std::string& structure) {
  if (!regions.atlas) {
    VertexKeys keys = regions.parcellation->keys;
    for (Label& key : keys) key = noRegion(regionName(regions, key), structure) ? 0 : key;
    return keys;
  }
  // Where an atlas holds FreeSurfer's cortical labels, only these are regions, and only our side's.
  const auto& voxels = regions.atlas->data;
  const bool freeSurfer = std::any_of(voxels.begin(), voxels.end(), [](Label label) {
    return !io::freeSurferRegion(label).empty();
  });
  const Label thousand = structure == "CortexRight" ? 2 : 1;
  return surface::labelsWithin(*regions.atlas, white, pial, [&](Label label) {
    if (!freeSurfer) return !noRegion(regionName(regions, label), structure);
    const std::string name = io::freeSurferRegion(label);
    return !name.empty() && !noRegion(name, structure) && label / 1000 == thousand;
  });
}

}  // namespace

CortexRegions readRegions(Context& context, const SurfaceSettings& s,
                          const surface::CorticalSurfaces& made) {
  CortexRegions regions;
  if (s.parcellation) {
    const Eigen::Index vertices = made.white.mesh.vertexCount();
    regions.parcellation = io::readVertexLabels(*s.parcellation, vertices);
    for (const auto& entry : regions.parcellation->table) {
      regions.names[entry.key] = entry.name;
      if (entry.colour[3] > 0) regions.colours[entry.key] = entry.colour;
    }
  } else if (s.atlas) {
    io::VolumeReadOptions reading = s.reading;
    reading.dimension = 3;
    const Volume<Label> atlas = scaled(readLabels(context, "atlas", *s.atlas, reading), s.scale);
    regions.atlas = segmentation::VoxelBox::around(atlas, 0).of(atlas);
    const auto legend = s.atlasLegend ? std::optional<std::filesystem::path>(*s.atlasLegend)
                                      : io::findLegend(*s.atlas);
    if (legend) {
      regions.names =
          io::readLabelNames(s.atlasLegend ? *legend : context.input(*legend, "atlas-legend"));
    }
    if (const auto colours = io::findColours(*s.atlas)) {
      regions.colours = io::readLabelColours(context.input(*colours, "atlas-colours"));
    }
  }
  return regions;
}

std::size_t writeRegions(Context& context, const CortexRegions& regions,
                         const surface::CorticalSurfaces& made, const std::string& structure) {
  const Columns& columns = made.columns;
  const VertexKeys keys =
      regionKeys(regions, made.white.mesh.positions, made.pial.positions, structure);
  const VertexKeys keysOfColumns = regionKeys(regions, columns.inner, columns.outer, structure);
  std::set<Label> used(keys.begin(), keys.end());
  used.erase(0);
  const std::vector<Label> all(used.begin(), used.end());
  const auto momentsOf = [&](const VertexKeys& of, const Eigen::VectorXd& values,
                             const Eigen::VectorXd& areas) {
    const std::span<const Label> each(of.data(), static_cast<std::size_t>(of.size()));
    return maps::regionMoments(each, values, areas, all);
  };
  const Eigen::VectorXd areas = geometry::vertexAreas(made.mid);
  const auto moments = [&](const Eigen::VectorXd& values) {
    return momentsOf(keys, values, areas);
  };
  // A thickness of 0 is not known.
  const auto known = [](const Eigen::VectorXd& thickness) -> Eigen::VectorXd {
    return (thickness.array() > 0).select(thickness, kNaN);
  };
  const auto sizes = moments(geometry::vertexAreas(made.white.mesh)),
             volumes = moments(maps::vertexVolumes(made.white.mesh,
                                                   {made.pial.positions, made.white.mesh.faces})),
             measured = momentsOf(keysOfColumns, known(columns.thickness), columns.area),
             nearest = moments(known(made.nearestThickness));
  const Eigen::VectorXd doubtful = surface::doubtfulOf(made);
  const bool isDoubted = doubtful.size() > 0;
  const auto doubt = isDoubted ? moments((made.thickness.array() > 0).select(doubtful, kNaN))
                               : std::vector<maps::RegionMoments>();
  std::ostringstream table;
  table << "index\tname\tvertices\tarea_white_mm2\tthickness_mean_mm\tthickness_sd_mm\tthickness_"
           "nearest_mean_mm"
        << (isDoubted ? "\tdoubtful_share" : "") << "\tvolume_mm3\n";
  const auto write = [&](double value) {
    table << '\t';
    if (std::isnan(value)) {
      table << "n/a";
    } else {
      table << value;
    }
  };
  io::LabelMap labels{"regions", keys, {{0, "???", {0, 0, 0, 0}}}};
  for (std::size_t r = 0; r < all.size(); ++r) {
    const std::string name = regionName(regions, all[r]);
    table << all[r] << '\t' << name << '\t' << sizes[r].count << '\t' << sizes[r].sum;
    write(measured[r].meanOverArea);
    write(measured[r].deviationOverArea);
    write(nearest[r].meanOverArea);
    if (isDoubted) write(doubt[r].meanOverArea);
    table << '\t' << volumes[r].sum << '\n';
    labels.table.push_back({all[r], name, regionColour(regions, all[r])});
  }
  writeTextFile(context.output("regions.tsv"), table.str());
  io::writeGiftiLabel(context.output("regions.label.gii"), labels, structure);
  return all.size();
}

}  // namespace explica::app
