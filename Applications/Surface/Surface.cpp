// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/Plausible.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/LabelNames.h"
#include "Explica/IO/SpecFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Maps/Folding.h"
#include "Explica/Maps/Regions.h"
#include "Explica/Provenance/Doubts.h"
#include "Explica/Segmentation/Atlas.h"
#include "Explica/Surface/CorticalSurface.h"
#include "Explica/Surface/CorticalTissue.h"
#include "Explica/Surface/GivenSurfaces.h"
#include "Explica/Surface/Measures.h"
#include "Explica/Surface/Regions.h"
#include "Explica/Surface/Summary.h"
#include "Explica/Surface/TissueSheet.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>
#include <span>
#include <sstream>
#include <utility>

namespace explica {
namespace app {

/// What `thickness.shape.gii`, the means and FreeSurfer's files hold.
enum class ThicknessMeasure {
  Trajectory,  ///< length of the trajectory that joins the two surfaces
  Nearest      ///< FreeSurfer's: mean of the nearest distances, both ways
};

/// Whether the surfaces are a sheet that may end in rims.
enum class Sheet {
  Automatic,  ///< where grey matter runs out of the image, and in LayNii's rims
  Always,
  Never  ///< a closed surface, or a refusal
};

}  // namespace app

template <>
struct EnumNames<app::Sheet> {
  static constexpr std::array table = {std::pair{app::Sheet::Automatic, "auto"},
                                       std::pair{app::Sheet::Always, "always"},
                                       std::pair{app::Sheet::Never, "never"}};
};

template <>
struct EnumNames<app::ThicknessMeasure> {
  static constexpr std::array table = {std::pair{app::ThicknessMeasure::Trajectory, "trajectory"},
                                       std::pair{app::ThicknessMeasure::Nearest, "nearest"}};
};

namespace app {
namespace {

struct Settings {
  std::optional<std::string> segmentation;
  std::optional<std::string> innerLevel;
  std::optional<std::string> outerLevel;
  std::optional<std::string> greyShare;
  std::optional<std::string> insulatedMask;
  std::optional<std::string> image;
  std::optional<double> level;
  std::optional<std::string> whiteSurface, pialSurface, midSurface;
  io::SurfaceSpace surfaceSpace = io::SurfaceSpace::Stated;
  std::optional<std::string> atlas, atlasLegend, parcellation;
  std::optional<std::string> freeSurfer;
  std::optional<std::string> fsVolume;
  io::VolumeReadOptions reading;
  surface::TissueOptions tissue;
  surface::SurfaceOptions surface;
  std::vector<std::string> accept;
  Sheet sheet = Sheet::Automatic;
  double scale = 1;
  ThicknessMeasure thicknessMeasure = ThicknessMeasure::Trajectory;
};

void declareOutputs(Declaration& d) {
  d.output("white.surf.gii", FileKind::Surface, "white surface")
      .output("mid.surf.gii", FileKind::Surface, "surface at half depth, same faces")
      .output("pial.surf.gii", FileKind::Surface, "outer surface, same faces")
      .output("thickness.shape.gii", FileKind::VertexData,
              "thickness by both measures, mm, the one asked for first; 0 where there is no grey "
              "matter")
      .output("valid.shape.gii", FileKind::VertexData, "1 where the thickness is defined, else 0")
      .output(
          "doubt.shape.gii", FileKind::VertexData,
          "with --image: standard deviation of the white and of the outer border's place, mm; a "
          "voxel where the image shows no border")
      .output("curvature.shape.gii", FileKind::VertexData,
              "mean curvature of the white surface, 1/mm, positive in sulci")
      .output("sulc.shape.gii", FileKind::VertexData,
              "sulcal depth: distance travelled outwards as the white surface is inflated, mm")
      .output("area.shape.gii", FileKind::VertexData,
              "area at each vertex of the white, middle and outer surface, mm^2")
      .output("topology.tsv", FileKind::Table, "one row for each corrected defect")
      .output("regions.tsv", FileKind::Table, "with --atlas: area and thickness of each region")
      .output("regions.label.gii", FileKind::VertexLabel, "with --atlas: region of each vertex")
      .output("surface.spec", FileKind::Any, "opens everything in Workbench")
      .output("*lh.*", FileKind::Any, "with --freesurfer: FreeSurfer files, left")
      .output("*rh.*", FileKind::Any, "with --freesurfer: FreeSurfer files, right");
}

void declareVolumes(Declaration& d, Settings& s) {
  d.input("SEG", FileKind::LabelVolume,
          "labels; may be left out if --inner-level or --white-surface is given", s.segmentation)
      .inputOption("inner-level", FileKind::Volume,
                   "scalars that cross a level at the white surface: a probability or a distance",
                   s.innerLevel)
      .inputOption("outer-level", FileKind::Volume,
                   "scalars that cross a level at the outer surface", s.outerLevel)
      .inputOption("grey-share", FileKind::Volume,
                   "probability of grey matter: with --inner-level the outer surface is where both "
                   "together reach one half",
                   s.greyShare)
      .inputOption("insulated-mask", FileKind::LabelVolume,
                   "with --inner-level: nonzero where there is neither white matter nor outside, "
                   "e.g. a cut through the callosum",
                   s.insulatedMask)
      .inputOption("image", FileKind::Volume,
                   "image whose labels these are, such as a T1: white and outer border are placed "
                   "by it, within a voxel of the labels' border",
                   s.image)
      .option("Inputs",
              Field{"level", "",
                    "value on the boundaries of level volumes (default: half the "
                    "largest value of shares, 0 of distances)"},
              s.level);
}

void declare(Declaration& d, Settings& s) {
  d.synopsis("inner, middle and outer surface of the cortical ribbon, vertex by vertex")
      .description(
          "From labels, or from volumes that cross a level at the boundaries. The white surface "
          "has the topology of a sphere (each corrected defect is listed), lies between voxels, "
          "and is meshed with even triangles. Outer vertices lie on the trajectories of the "
          "harmonic interpolant that start at the white ones, middle ones half way; the hidden "
          "boundary of buried sulci is recovered. None of the surfaces intersects itself, by an "
          "exact test. Tissue that runs out of the image, such as a block or a slab, gives sheets "
          "with a rim, of the tissue's own topology. Surfaces that another program has made are "
          "taken over as they are with --white-surface and --pial-surface, and measured and "
          "checked in the same way.")
      .reference("Jones, Buchbinder, Aharon 2000, Human Brain Mapping 11:12-32")
      .reference("Han, Pham, Tosun, Rettmann, Xu, Prince 2004, NeuroImage 23:997-1012")
      .reference("Fischl, Dale 2000, Proc. Natl. Acad. Sci. USA 97:11050-11055")
      .reference("Botsch, Kobbelt 2004, Symposium on Geometry Processing, 185-192")
      .example("explica surface aseg.mgz --hemisphere L --out left",
               "Left hemisphere of a FreeSurfer, FastSurfer or SynthSeg segmentation")
      .example("explica surface aseg.mgz --hemisphere L --image brain.mgz --out left",
               "Borders placed by the image, finer than labels do")
      .example(
          "explica surface seg.nii.gz --white-label 3 --grey-label 2 --faces 80000 --out brain",
          "Labels by name")
      .example("explica surface rim.nii.gz --preset laynii --out block",
               "A slab of cortex as LayNii has it, as sheets with a rim")
      .example("explica surface --inner-level wm.nii.gz --grey-share gm.nii.gz --out brain",
               "From tissue probabilities, with sub-voxel boundaries")
      .example(
          "explica surface --white-surface lh.white --pial-surface lh.pial --fs-volume "
          "orig.mgz --surface-space tkr --out left",
          "FreeSurfer's surfaces, checked and measured");
  declareVolumes(d, s);
  d.inputOption("white-surface", FileKind::Surface, "white surface that is there already",
                s.whiteSurface, "Given surfaces")
      .inputOption("pial-surface", FileKind::Surface, "its pial surface, same faces", s.pialSurface,
                   "Given surfaces")
      .inputOption("mid-surface", FileKind::Surface,
                   "its middle surface, same faces (default: half way)", s.midSurface,
                   "Given surfaces")
      .option("Given surfaces",
              Field{"surface-space", "", "frame of their coordinates, if the files do not say"},
              s.surfaceSpace)
      .inputOption("atlas", FileKind::LabelVolume,
                   "labels of cortical regions in the same space: writes regions.tsv", s.atlas,
                   "Regions")
      .inputOption("atlas-legend", FileKind::Table,
                   "what its labels are called (default: the .tsv or .nii.txt beside it; "
                   "FreeSurfer's names are known)",
                   s.atlasLegend, "Regions")
      .inputOption("parcellation", FileKind::VertexLabel,
                   "regions of given surfaces, vertex by vertex, instead of --atlas",
                   s.parcellation, "Regions")
      .options("Reading", s.reading)
      .option("Reading",
              Field{"scale", "",
                    "multiplies the lengths of the volumes' headers, for such as were scaled to a "
                    "human brain's size"},
              s.scale)
      .options("Tissue", s.tissue)
      .options("Surface", s.surface)
      .option(
          "Surface",
          Field{"sheet", "",
                "whether the surfaces may end in rims, with the topology of the tissue, instead "
                "of being closed: where grey matter runs out of the image (auto), always, never"},
          s.sheet)
      .option("Output",
              Field{"thickness-measure", "",
                    "what comes first in thickness.shape.gii, and its means: length of the "
                    "trajectory, or the mean of the nearest distances both ways, as FreeSurfer "
                    "has it"},
              s.thicknessMeasure)
      .option("Output",
              Field{"freesurfer", "",
                    "write lh.white, lh.pial, lh.thickness and so on, too, into "
                    "this folder (within --out if relative)"},
              s.freeSurfer)
      .namesOutput("freesurfer")
      .inputOption("fs-volume", FileKind::Volume,
                   "volume (orig.mgz) whose surface RAS FreeSurfer files use, read or written "
                   "(default: the labels, if FreeSurfer's)",
                   s.fsVolume, "Output");
  d.excludes("parcellation", {"atlas", "atlas-legend"})
      .excludes("no-fill", {"fill"})
      .excludes("outer-level", {"grey-share"})
      .needs({"outer-level", "grey-share", "insulated-mask", "level"}, {"inner-level"})
      .needs({"atlas-legend"}, {"atlas"})
      .needs({"fluid"}, {"image"})
      .needs({"surface-space"}, {"white-surface"});
  declareAccept(d, s.accept);
  declareOutputs(d);
  d.results<surface::SurfaceSummary>();
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

struct Inputs {
  surface::CorticalTissue tissue;             ///< boundaries empty for a sheet
  std::optional<surface::TissueMasks> block;  ///< of a sheet
  Grid grid;
};

template <class T>
Volume<T> scaled(Volume<T> volume, double scale) {
  volume.grid.spacing *= scale;
  volume.grid.origin *= scale;
  return volume;
}

bool surfacesGiven(const Settings& s) {
  return s.whiteSurface || s.pialSurface || s.midSurface;
}

void checkChoice(const Settings& s) {
  constexpr double kMostScale = 1e3;  // from metres to millimetres
  if (!(s.scale >= 1 / kMostScale && s.scale <= kMostScale)) {
    throw UsageError("surface: --scale is a factor between 0.001 and 1000");
  }
  if (s.scale != 1 && surfacesGiven(s)) {
    throw UsageError("surface: --scale is of volumes; given surfaces have their own lengths");
  }
  const int sources = s.segmentation.has_value() + s.innerLevel.has_value() + surfacesGiven(s);
  if (sources != 1) {
    throw UsageError("surface: give one of SEG, --inner-level and --white-surface");
  }
  if (surfacesGiven(s) && !(s.whiteSurface && s.pialSurface)) {
    throw UsageError("surface: --white-surface and --pial-surface go together");
  }
  if (s.image && surfacesGiven(s)) {
    throw UsageError("surface: --image places borders that are made, not those of --white-surface");
  }
  if (s.parcellation && !surfacesGiven(s)) {
    throw UsageError("surface: --parcellation belongs to the vertices of --white-surface");
  }
}

/// Surfaces of another program, as they are; they must bound a volume, whatever their topology.
surface::CorticalSurfaces readGivenSurfaces(Context& context, const Settings& s,
                                            std::string& structure) {
  io::SurfaceReadOptions reading;
  reading.space = s.surfaceSpace;
  reading.fsVolume = s.fsVolume;
  const auto read = [&](const char* name, const std::string& path) {
    io::LoadedSurface loaded = readSurface(context, name, path, reading);
    geometry::requireClosedManifold(loaded.mesh, path);
    if (structure == "Cortex" && loaded.metadata.structure != "Other") {
      structure = loaded.metadata.structure;
    }
    sayHowRead(context, loaded.origin);
    return std::move(loaded.mesh);
  };
  structure = "Cortex";
  TriangleMesh white = read("white-surface", *s.whiteSurface);
  TriangleMesh pial = read("pial-surface", *s.pialSurface);
  std::optional<TriangleMesh> mid;
  if (s.midSurface) mid = read("mid-surface", *s.midSurface);
  if (s.tissue.hemisphere) {
    structure = *s.tissue.hemisphere == surface::Side::Left ? "CortexLeft" : "CortexRight";
  }
  return surface::adoptSurfaces(std::move(white), std::move(pial), std::move(mid));
}

/// Labels of regions, on an atlas's voxels or on the vertices of given surfaces.
struct Regions {
  std::optional<Volume<Label>> atlas;
  std::optional<io::LabelMap> parcellation;
  io::LabelNames names;
  io::LabelColours colours;
};

Regions readRegions(Context& context, const Settings& s, const surface::CorticalSurfaces& made) {
  Regions regions;
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
    regions.atlas = scaled(readLabels(context, "atlas", *s.atlas, reading), s.scale);
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

std::string regionName(const Regions& regions, Label key) {
  const auto named = regions.names.find(key);
  if (named != regions.names.end()) return named->second;
  const std::string freeSurfer = io::freeSurferRegion(key);
  return freeSurfer.empty() ? "label" + std::to_string(key) : freeSurfer;
}

/// The colour in which its atlas shows a region; else one that tells neighbours apart.
std::array<float, 4> regionColour(const Regions& regions, Label key) {
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
  for (const char* word :
       {"unknown", "Unknown", "corpuscallosum", "medialwall", "Medial_wall", "???"}) {
    if (name == word) return true;
  }
  const auto named = segmentation::structureNamed(name);
  const Side other = structure == "CortexRight" ? Side::Left : Side::Right;
  return named.kind != segmentation::StructureKind::Cortex || named.side == other;
}

/// Region of each vertex; 0 where there is none.
surface::VertexKeys regionKeys(const Regions& regions, const surface::CorticalSurfaces& made,
                               const std::string& structure) {
  if (!regions.atlas) {
    surface::VertexKeys keys = regions.parcellation->keys;
    for (Label& key : keys) key = noRegion(regionName(regions, key), structure) ? 0 : key;
    return keys;
  }
  // Where an atlas holds FreeSurfer's cortical labels, only these are regions, and only our side's.
  const auto& voxels = regions.atlas->data;
  const bool freeSurfer = std::any_of(voxels.begin(), voxels.end(), [](Label label) {
    return !io::freeSurferRegion(label).empty();
  });
  const Label thousand = structure == "CortexRight" ? 2 : 1;
  return surface::labelsWithin(
      *regions.atlas, made.white.mesh.positions, made.pial.positions, [&](Label label) {
        if (!freeSurfer) return !noRegion(regionName(regions, label), structure);
        const std::string name = io::freeSurferRegion(label);
        return !name.empty() && !noRegion(name, structure) && label / 1000 == thousand;
      });
}

/// @return how many there are
std::size_t writeRegions(Context& context, const Regions& regions,
                         const surface::CorticalSurfaces& made, const std::string& structure,
                         std::vector<io::SpecEntry>& spec) {
  const surface::VertexKeys keys = regionKeys(regions, made, structure);
  std::set<Label> used(keys.begin(), keys.end());
  used.erase(0);
  const std::vector<Label> all(used.begin(), used.end());
  const auto moments = [&](const Eigen::VectorXd& values) {
    const std::span<const Label> of(keys.data(), static_cast<std::size_t>(keys.size()));
    return maps::regionMoments(of, values, made.columnArea, all);
  };
  // A thickness of 0 is not known.
  const auto known = [](const Eigen::VectorXd& thickness) -> Eigen::VectorXd {
    return (thickness.array() > 0).select(thickness, kNaN);
  };
  const auto sizes = moments(geometry::vertexAreas(made.white.mesh)),
             measured = moments(known(made.columnThickness)),
             nearest = moments(known(made.nearestThickness));
  const Eigen::VectorXd doubtful = surface::doubtfulOf(made);
  const bool isDoubted = doubtful.size() > 0;
  const auto doubt = isDoubted ? moments((made.thickness.array() > 0).select(doubtful, kNaN))
                               : std::vector<maps::RegionMoments>();
  std::ostringstream table;
  table << "index\tname\tvertices\tarea_white_mm2\tthickness_mean_mm\tthickness_sd_mm\t"
           "thickness_nearest_mean_mm"
        << (isDoubted ? "\tdoubtful_share\n" : "\n");
  io::LabelMap labels{"regions", keys, {{0, "???", {0, 0, 0, 0}}}};
  for (std::size_t r = 0; r < all.size(); ++r) {
    const std::string name = regionName(regions, all[r]);
    table << all[r] << '\t' << name << '\t' << sizes[r].count << '\t' << sizes[r].sum;
    if (measured[r].count > 0) {
      table << '\t' << measured[r].meanOverArea << '\t' << measured[r].deviationOverArea << '\t'
            << nearest[r].meanOverArea;
      if (isDoubted) table << '\t' << doubt[r].meanOverArea;
    } else {
      table << (isDoubted ? "\tn/a\tn/a\tn/a\tn/a" : "\tn/a\tn/a\tn/a");
    }
    table << '\n';
    labels.table.push_back({all[r], name, regionColour(regions, all[r])});
  }
  writeTextFile(context.output("regions.tsv"), table.str());
  io::writeGiftiLabel(context.output("regions.label.gii"), labels, structure);
  spec.push_back({structure, "regions.label.gii"});
  return all.size();
}

/// Whether the tissue is a sheet; says so where nobody asked.
bool isSheet(Context& context, const Settings& s, const surface::TissueMasks& masks) {
  if (s.sheet == Sheet::Never || s.tissue.closeEdges) return false;
  if (s.sheet == Sheet::Always) return true;
  if (!surface::isBlock(masks)) return false;
  context.info(surface::runsOutOfImage(masks)
                   ? "grey matter runs out of the image: the surfaces are sheets with a rim "
                     "(--sheet never refuses)"
                   : "a rim of tissue: the surfaces are sheets with a rim");
  return true;
}

Inputs readTissue(Context& context, const Settings& s) {
  io::VolumeReadOptions reading = s.reading;
  reading.dimension = 3;
  Inputs inputs;
  if (s.segmentation) {
    const Volume<Label> labels =
        scaled(readTissueLabels(context, "SEG", *s.segmentation, reading), s.scale);
    inputs.grid = labels.grid;
    auto step = context.step("tissue");
    surface::TissueMasks masks = surface::masksFromLabels(labels, s.tissue, context.monitor());
    if (isSheet(context, s, masks)) {
      static_cast<surface::TissueFacts&>(inputs.tissue) = masks;
      inputs.block = std::move(masks);
    } else {
      inputs.tissue = surface::tissueFromMasks(masks, s.tissue.closeEdges, context.monitor());
    }
    return inputs;
  }
  const Volume<float> inner =
      scaled(readScalars(context, "inner-level", *s.innerLevel, reading), s.scale);
  inputs.grid = inner.grid;
  Volume<float> outer, grey;
  Volume<std::uint8_t> insulated;
  if (s.outerLevel) {
    outer = scaled(readScalars(context, "outer-level", *s.outerLevel, reading), s.scale);
  }
  if (s.greyShare) {
    grey = scaled(readScalars(context, "grey-share", *s.greyShare, reading), s.scale);
  }
  if (s.insulatedMask) {
    const Volume<Label> mask =
        scaled(readLabels(context, "insulated-mask", *s.insulatedMask, reading), s.scale);
    insulated = Volume<std::uint8_t>(mask.grid);
    std::transform(mask.data.begin(), mask.data.end(), insulated.data.begin(),
                   [](Label label) { return static_cast<std::uint8_t>(label != 0); });
  }
  auto step = context.step("tissue");
  const Volume<float> white = surface::sharesOf(inner, s.level, "inner-level");
  Volume<float> tissue;
  if (s.outerLevel) tissue = surface::sharesOf(outer, s.level, "outer-level");
  if (s.greyShare) {
    tissue = surface::addShares(white, surface::sharesOf(grey, s.level, "grey-share"));
  }
  inputs.tissue = surface::tissueFromShares(white, tissue, insulated, s.tissue, context.monitor());
  return inputs;
}

io::SurfaceMetadata metadataOf(const std::string& structure, const std::string& secondary) {
  io::SurfaceMetadata metadata;
  metadata.structure = structure;
  metadata.secondary = secondary;
  metadata.name = secondary;
  return metadata;
}

/// One of the surfaces that are written.
struct Named {
  const char* file;
  const char* fsName;
  const char* secondary;
  const char* key;
  const TriangleMesh* mesh;
};

std::vector<Named> namedSurfaces(const surface::CorticalSurfaces& made, bool hasGrey) {
  std::vector<Named> surfaces = {
      {"white.surf.gii", "white", "GrayWhite", "white", &made.white.mesh}};
  if (hasGrey) {
    surfaces.push_back({"mid.surf.gii", "mid", "MidThickness", "mid", &made.mid});
    surfaces.push_back({"pial.surf.gii", "pial", "Pial", "pial", &made.pial});
  }
  return surfaces;
}

std::vector<io::VertexMap> areasOf(const std::vector<Named>& surfaces) {
  std::vector<io::VertexMap> areas;
  for (const Named& surface : surfaces) {
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

std::vector<io::SpecEntry> writeMaps(Context& context, const Settings& s,
                                     const surface::CorticalSurfaces& made,
                                     const surface::CorticalTissue& tissue,
                                     const std::vector<Named>& surfaces, const Regions& regions,
                                     surface::SurfaceSummary& summary) {
  std::vector<io::SpecEntry> spec;
  for (const Named& surface : surfaces) {
    io::writeGiftiSurface(context.output(surface.file), *surface.mesh,
                          metadataOf(tissue.structure, surface.secondary));
    spec.push_back({tissue.structure, surface.file});
  }
  const auto writeShape = [&](const std::string& file, const std::vector<io::VertexMap>& maps) {
    io::writeGiftiShape(context.output(file), maps, tissue.structure);
    spec.push_back({tissue.structure, file});
  };
  writeShape("curvature.shape.gii", {{"curvature", "mm^-1", made.curvature}});
  writeShape("area.shape.gii", areasOf(surfaces));
  if (!tissue.hasGrey) return spec;
  writeShape("thickness.shape.gii", thicknessMaps(made, s.thicknessMeasure));
  writeShape("valid.shape.gii", {{"valid", "", surface::validOf(made)}});
  if (made.image.doubt.size() > 0) {
    writeShape("doubt.shape.gii", {{"doubt_white", "mm", made.image.doubt.col(0)},
                                   {"doubt_outer", "mm", made.image.doubt.col(1)}});
  }
  if (made.sulcalDepth.size() > 0) writeShape("sulc.shape.gii", {{"sulc", "mm", made.sulcalDepth}});
  if (regions.atlas || regions.parcellation) {
    summary.regions = writeRegions(context, regions, made, tissue.structure, spec);
  }
  return spec;
}

void writeFreeSurfer(Context& context, const Settings& s, const surface::CorticalSurfaces& made,
                     const surface::CorticalTissue& tissue, const std::vector<Named>& surfaces,
                     const std::optional<Grid>& fsGrid) {
  const std::string hemi = tissue.structure == "CortexRight" ? "rh." : "lh.";
  const std::filesystem::path folder = *s.freeSurfer;
  if (folder.is_absolute()) std::filesystem::create_directories(folder);
  const auto place = [&](const std::string& name) {
    return folder.is_absolute() ? folder / (hemi + name)
                                : context.output((folder / (hemi + name)).string());
  };
  for (const Named& surface : surfaces) {
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

/// What a reader must know of a sheet, and of an image that shows too little to be the labels'.
void warnOf(Context& context, const surface::CorticalSurfaces& made, bool hasImage) {
  const std::int64_t cut = made.sheet.cutByImage;
  if (cut > 0) {
    context.warn(std::to_string(cut) + " of " + std::to_string(made.thickness.size()) +
                 " vertices lie so near to the image's edge that their thickness holds only if it "
                 "cuts the tissue at right angles (0 in valid.shape.gii)");
  }
  constexpr double kFewest = 0.5;  // share of vertices with an edge
  const auto vertices = static_cast<double>(made.thickness.size() - made.noRibbon);
  const std::int64_t missing = made.image.missingWhite - made.noRibbon;
  if (hasImage && static_cast<double>(missing) > (1 - kFewest) * vertices) {
    context.warn("the image shows no edge of white matter at " + std::to_string(missing) +
                 " vertices: is it the image of these labels?");
  }
}

/// What of the labels is cut, guessed or not known.
void doubtLabels(Context& context, const surface::TissueFacts& tissue, bool sheet) {
  const auto count = [](std::int64_t number) { return static_cast<std::size_t>(number); };
  context.doubt(provenance::kHemisphereCutByGuess, count(tissue.cutContact),
                "no label parts the hemispheres: white matter was cut at " +
                    std::to_string(tissue.cutContact) +
                    " voxel faces where waves from both sides meet; look at the cut");
  // A sheet is meant to end there, and says which vertices it concerns.
  context.doubt(provenance::kTissueAtImageBorder, count(tissue.atImageBorder),
                sheet ? ""
                      : std::to_string(tissue.atImageBorder) +
                            " voxels of white and grey matter lie in the image's outermost layer: "
                            "the surface ends where the image does");
  std::string unknown;
  for (const Label label : tissue.unknownLabels) {
    unknown += (unknown.empty() ? "" : ", ") + std::to_string(label);
  }
  context.doubt(provenance::kLabelsUnknown, tissue.unknownLabels.size(),
                "programs of preset '" + std::string(nameOf(tissue.preset)) + "' use no label " +
                    unknown + "; taken to lie outside the tissue");
}

surface::SurfaceSummary summaryOf(const Settings& s, const surface::CorticalTissue& tissue,
                                  const surface::CorticalSurfaces& made) {
  surface::SurfaceSummary summary;
  summary.regions.reset();
  summary.cerebrumVolume.reset();
  summary.given = surfacesGiven(s);
  summary.tissue = &tissue;
  summary.made = &made;
  summary.hasGrey = tissue.hasGrey;
  summary.hasImage = s.image.has_value();
  const std::array meshes = {&made.white.mesh, &made.mid, &made.pial};
  parallelFor(tissue.hasGrey ? 3 : 1, 1,
              [&](std::size_t n) { summary.checks[n] = surface::checkOf(*meshes[n]); });
  const Eigen::VectorXd angles = geometry::smallestAnglesRad(made.white.mesh);
  std::vector<double> sorted(angles.begin(), angles.end());
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 20, sorted.end());
  summary.smallestAngleDeg = sorted[sorted.size() / 20] * 180 / kPi;
  summary.thickness.reset();
  if (tissue.hasGrey) {
    summary.thickness =
        surface::thicknessMeansOf(made, s.thicknessMeasure == ThicknessMeasure::Nearest);
  }
  summary.thicknessKnown.reset();
  if (made.sheet.open) {
    const Eigen::VectorXd known = surface::validOf(made).array() * made.columnThickness.array();
    summary.thicknessKnown = surface::meanThickness(made.columnArea, known);
  }
  return summary;
}

surface::CorticalSurfaces makeSurfaces(Context& context, const Settings& s, const Inputs& inputs,
                                       const std::optional<Volume<float>>& image) {
  auto step = context.step("surfaces");
  if (inputs.block) {
    return surface::buildSheets(*inputs.block, s.surface, context.monitor());
  }
  const surface::CorticalTissue& tissue = inputs.tissue;
  if (tissue.hasGrey && image) {
    return surface::buildSurfaces(tissue, *image, s.surface, context.monitor());
  }
  if (tissue.hasGrey) return surface::buildSurfaces(tissue, s.surface, context.monitor());
  context.warn("no grey matter given: only the white surface is made");
  surface::CorticalSurfaces made;
  made.white = surface::extractWhite(tissue, s.surface, context.monitor());
  made.seconds = made.white.seconds;
  made.curvature = maps::meanCurvature(made.white.mesh);
  made.sulcalDepth = maps::sulcalDepth(made.white.mesh);
  return made;
}

/// Of human labels: says so where the cerebrum's volume is not a human's.
void checkVolume(Context& context, const surface::CorticalSurfaces& made,
                 const surface::CorticalTissue& tissue, surface::SurfaceSummary& summary) {
  using surface::LabelPreset;
  const LabelPreset preset = tissue.preset;
  const bool human = preset == LabelPreset::Aseg || preset == LabelPreset::Ribbon ||
                     preset == LabelPreset::Dhcp || preset == LabelPreset::Dhcp87;
  if (!human || made.sheet.open || !tissue.hasGrey) return;
  constexpr double kUsual = 1100;  // ml
  const double sides = tissue.structure == "Cortex" ? 1 : 2;
  const double volume = sides * geometry::enclosedVolume(made.pial) / 1000;
  summary.cerebrumVolume = volume;
  if (volume >= surface::kLeastCerebrum && volume <= surface::kMostCerebrum) return;
  std::ostringstream text;
  text.precision(3);
  text << "the cerebrum holds " << volume << " ml" << (sides == 2 ? " (twice this hemisphere)" : "")
       << ", a human one 250 to 2000 ml: if the header's lengths were scaled, --scale V multiplies "
          "them ("
       << std::cbrt(kUsual / volume) << " would make it a human's)";
  context.warn(text.str());
}

std::optional<Volume<float>> readImage(Context& context, const Settings& s) {
  if (!s.image) return {};
  io::VolumeReadOptions reading = s.reading;
  reading.dimension = 3;
  reading.frame.reset();
  return scaled(readScalars(context, "image", *s.image, reading), s.scale);
}

/// The volume whose surface RAS FreeSurfer files use.
std::optional<Grid> freeSurferGrid(const Settings& s, const Inputs& inputs) {
  if (s.fsVolume) {
    Grid grid = io::readGrid(*s.fsVolume);
    grid.spacing *= s.scale;
    grid.origin *= s.scale;
    return grid;
  }
  const surface::LabelPreset preset = inputs.tissue.preset;
  if (preset == surface::LabelPreset::Aseg || preset == surface::LabelPreset::Ribbon ||
      preset == surface::LabelPreset::Wm) {
    return inputs.grid;
  }
  return {};
}

Termination run(Context& context, const Settings& s) {
  checkChoice(s);
  Judge judge(context, s.accept);
  const bool given = surfacesGiven(s);
  Inputs inputs;
  surface::CorticalSurfaces made;
  if (given) made = readGivenSurfaces(context, s, inputs.tissue.structure);
  const Regions regions = readRegions(context, s, made);
  if (!given) inputs = readTissue(context, s);
  const surface::CorticalTissue& tissue = inputs.tissue;
  if (inputs.block && s.image) {
    throw UsageError("surface: --image places the borders of closed surfaces, not of sheets");
  }
  const std::optional<Grid> fsGrid = freeSurferGrid(s, inputs);
  if (!given) made = makeSurfaces(context, s, inputs, readImage(context, s));
  const std::vector<Named> surfaces = namedSurfaces(made, tissue.hasGrey);
  surface::SurfaceSummary summary;
  {
    auto step = context.step("check");
    summary = summaryOf(s, tissue, made);
  }
  {
    auto step = context.step("write");
    const std::vector<io::SpecEntry> spec =
        writeMaps(context, s, made, tissue, surfaces, regions, summary);
    io::writeSpec(context.output("surface.spec"), spec);
    writeTextFile(context.output("topology.tsv"), defectTable(made.white.defects));
    if (s.freeSurfer) writeFreeSurfer(context, s, made, tissue, surfaces, fsGrid);
  }
  if (!given) {
    doubtLabels(context, tissue, made.sheet.open);
    checkVolume(context, made, tissue, summary);
  }
  warnOf(context, made, summary.hasImage && tissue.hasGrey);
  context.results(summary);
  judge.flag("defects", static_cast<double>(made.white.defects.size()));
  // Labels named by hand need not be a cortex's.
  if (tissue.hasGrey && s.tissue.white.empty()) {
    judge.flag("thickness-mean", surface::meanThickness(made.columnArea, made.columnThickness));
  }
  const std::int64_t meetings = summary.meetings();
  if (!given && meetings > 0) {
    context.warn("the surfaces meet themselves at " + std::to_string(meetings) + " pairs of faces");
    return Termination::Stalled;
  }
  return Termination::Finished;
}

}  // namespace

Command surfaceCommand() {
  return makeCommand<Settings>("surface", declare, run);
}

}  // namespace app
}  // namespace explica
