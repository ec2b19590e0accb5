// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Files.h"

#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/SurfaceFile.h"

#include <filesystem>
#include <sstream>
#include <utility>

namespace explica::app {
namespace {

io::SurfaceMetadata metadataOf(const std::string& structure, const std::string& secondary) {
  io::SurfaceMetadata metadata;
  metadata.structure = structure;
  metadata.secondary = secondary;
  metadata.name = secondary;
  return metadata;
}

std::vector<io::VertexMap> areasOf(const std::vector<WrittenSurface>& surfaces) {
  std::vector<io::VertexMap> areas;
  for (const WrittenSurface& surface : surfaces) {
    areas.push_back(
        {std::string("area_") + surface.key, "mm^2", geometry::vertexAreas(*surface.mesh)});
  }
  return areas;
}

/// Both measures of thickness, the one that was asked for first.
std::vector<io::VertexMap> thicknessMaps(const surface::CorticalSurfaces& made,
                                         ThicknessMeasure first) {
  std::vector<io::VertexMap> maps = {{"thickness", "mm", made.thickness},
                                     {"thickness_nearest", "mm", made.nearestThickness}};
  if (first == ThicknessMeasure::Nearest) std::swap(maps[0], maps[1]);
  return maps;
}

}  // namespace

std::vector<WrittenSurface> namedSurfaces(const surface::CorticalSurfaces& made, bool hasGrey) {
  std::vector<WrittenSurface> surfaces = {
      {"white.surf.gii", "white", "GrayWhite", "white", &made.white.mesh}};
  if (hasGrey) {
    surfaces.push_back({"mid.surf.gii", "mid", "MidThickness", "mid", &made.mid});
    surfaces.push_back({"pial.surf.gii", "pial", "Pial", "pial", &made.pial});
  }
  return surfaces;
}

void writeMaps(Context& context, const SurfaceSettings& s, const surface::CorticalSurfaces& made,
               const surface::CorticalTissue& tissue, const std::vector<WrittenSurface>& surfaces,
               const CortexRegions& regions, surface::SurfaceSummary& summary) {
  for (const WrittenSurface& surface : surfaces) {
    io::writeGiftiSurface(context.output(surface.file), *surface.mesh,
                          metadataOf(tissue.structure, surface.secondary));
  }
  const auto writeShape = [&](const std::string& file, const std::vector<io::VertexMap>& maps) {
    io::writeGiftiShape(context.output(file), maps, tissue.structure);
  };
  writeShape("curvature.shape.gii", {{"curvature", "mm^-1", made.curvature}});
  writeShape("area.shape.gii", areasOf(surfaces));
  if (!tissue.hasGrey) return;
  writeShape("thickness.shape.gii", thicknessMaps(made, s.thicknessMeasure));
  writeShape("valid.shape.gii", {{"valid", "", surface::validOf(made)}});
  if (made.image.doubt.size() > 0) {
    writeShape("doubt.shape.gii", {{"doubt_white", "mm", made.image.doubt.col(0)},
                                   {"doubt_outer", "mm", made.image.doubt.col(1)}});
  }
  if (made.sulcalDepth.size() > 0) writeShape("sulc.shape.gii", {{"sulc", "mm", made.sulcalDepth}});
  if (regions.atlas || regions.parcellation) {
    summary.regions = writeRegions(context, regions, made, tissue.structure);
  }
}

void writeFreeSurfer(Context& context, const SurfaceSettings& s,
                     const surface::CorticalSurfaces& made, const surface::CorticalTissue& tissue,
                     const std::vector<WrittenSurface>& surfaces,
                     const std::optional<Grid>& fsGrid) {
  const std::string hemi = tissue.structure == "CortexRight" ? "rh." : "lh.";
  const std::filesystem::path folder = *s.freeSurfer;
  if (folder.is_absolute()) std::filesystem::create_directories(folder);
  const auto place = [&](const std::string& name) {
    return folder.is_absolute() ? folder / (hemi + name)
                                : context.output((folder / (hemi + name)).string());
  };
  for (const WrittenSurface& surface : surfaces) {
    io::writeFreeSurferSurface(place(surface.fsName), *surface.mesh, fsGrid);
  }
  const Eigen::Index faces = made.white.mesh.faceCount();
  const std::vector<io::VertexMap> areas = areasOf(surfaces);
  io::writeFreeSurferCurv(place("curv"), made.curvature, faces);
  io::writeFreeSurferCurv(place("area"), areas.front().values, faces);
  if (!tissue.hasGrey) return;
  io::writeFreeSurferCurv(place("thickness"), thicknessMaps(made, s.thicknessMeasure)[0].values,
                          faces);
  if (made.sulcalDepth.size() > 0) io::writeFreeSurferCurv(place("sulc"), made.sulcalDepth, faces);
  io::writeFreeSurferCurv(place("area.pial"), areas.back().values, faces);
}

std::string defectTable(const std::vector<surface::Defect>& defects) {
  std::ostringstream table;
  table << "kind\tx_mm\ty_mm\tz_mm\tvoxels\tcost\talternative_cost\tside\twhy\n";
  for (const auto& defect : defects) {
    using surface::DefectKind;
    const bool filled = defect.kind == DefectKind::Tunnel || defect.kind == DefectKind::Cavity;
    const char* why = defect.kind == DefectKind::Island   ? "not connected to the white matter"
                      : defect.kind == DefectKind::Cavity ? "enclosed by white matter"
                      : filled ? "filling overrules less evidence than cutting"
                               : "cutting overrules less evidence than filling";
    table << nameOf(defect.kind) << '\t' << defect.place.x() << '\t' << defect.place.y() << '\t'
          << defect.place.z() << '\t' << defect.voxels << '\t' << defect.cost << '\t';
    if (defect.alternativeCost == defect.alternativeCost) {
      table << defect.alternativeCost;
    } else {
      table << "n/a";
    }
    table << '\t' << (filled ? "filled" : "removed") << '\t' << why << '\n';
  }
  return table.str();
}

}  // namespace explica::app
