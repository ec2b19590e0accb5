// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Flatten.h"

#include "AutomaticCuts.h"
#include "Explica/Application/Command.h"
#include "Explica/Application/Describing.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/TimeBudget.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Flattening/Comparison.h"
#include "Explica/Flattening/Disc.h"
#include "Explica/Flattening/FlatGrid.h"
#include "Explica/Flattening/PatchTable.h"
#include "Explica/Flattening/Selection.h"
#include "Explica/Flattening/State.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/PatchFile.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Provenance/Digest.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Report/FlatFigure.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Distortion.h"
#include "Explica/Unfolding/FlatSummary.h"

#include <fnmatch.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <numeric>
#include <set>

namespace explica::app {
namespace {

constexpr double kPatchTolerance = 0.01;    // mean area error of a patch ...
constexpr double kCutTolerance = 0.05;      // ... and of a hemisphere with cuts: less costs lengths
constexpr const char* kAutomatic = "auto";  // of --cuts
constexpr const char* kStateFile = "flattening.state";
constexpr double kDistanceWork = 2e6;  // vertices visited for the distance errors, about

struct Settings {
  std::string surface;
  io::SurfaceReadOptions reading;
  std::optional<std::string> reference;
  std::optional<std::string> cuts;
  std::optional<std::string> cortex;
  flattening::CutOptions cut;
  std::vector<std::string> labels;
  std::vector<int> labelKeys;
  std::optional<double> areaTolerance;
  flattening::FlattenOptions flatten;
  double grid = 0.5;
  std::optional<int> depths;
  std::optional<std::string> surfaces;
  std::vector<std::string> volumes;
  bool nearest = false;
  std::vector<std::string> maps;
  std::vector<std::string> regions;
  bool resume = false;
};

void declareOutputs(Declaration& d) {
  d.output("flat.surf.gii", FileKind::Surface,
           "the flat map, z = 0: all vertices in their order, the patch's faces (one bank of cuts)")
      .output("patch.surf.gii", FileKind::Surface,
              "the reference, the patch's vertices only, in the order of vertex_of.shape.gii")
      .output("patch_flat.surf.gii", FileKind::Surface, "the flat map of patch.surf.gii")
      .output("vertex_of.shape.gii", FileKind::VertexData,
              "for each vertex of patch.surf.gii its number in the whole surface")
      .output("*.patch.flat", FileKind::Any, "the flat map as FreeSurfer writes it")
      .output("*.patch.3d", FileKind::Any, "the patch on the reference, as FreeSurfer writes it")
      .output("cuts.tsv", FileKind::Table,
              "of --cuts auto: ends (vertices), length (mm), mean depth (standard deviations)")
      .output("cuts.label.gii", FileKind::VertexLabel, "of --cuts auto: the wall and each cut")
      .output("distortion.shape.gii", FileKind::VertexData,
              "area ratio, angle change in degrees, edge strain")
      .output("patch_*.label.gii", FileKind::VertexLabel,
              "each file of --regions on the vertices of patch.surf.gii, names and colours kept")
      .output("patch.tsv", FileKind::Table, "area and means of maps, per region and in all")
      .output("grid.nii.gz", FileKind::PointVolume, "place (RAS mm) of each cell (u, v, depth)")
      .output("to_flat.nii.gz", FileKind::PointVolume,
              "u, v (mm) and depth (0 to 1) of each voxel of the first volume")
      .output("flat_*.nii.gz", FileKind::Volume, "each volume on the grid")
      .output("flat.png", FileKind::Picture, "the map with outlines, scale bar and colour bar")
      .output("frames/frame-*.surf.gii", FileKind::Surface,
              "--frames states on the way, vertices and faces as in flat.surf.gii")
      .varyingOutput(kStateFile, FileKind::Any, "what --resume needs")
      .results<flattening::CutPlan>()
      .results<unfolding::FlatSummary>();
}

void declare(Declaration& d, Settings& s) {
  d.synopsis("a patch, or a hemisphere with cuts, as a flat map that folds nowhere")
      .description(
          R"(Lays a surface with a rim flat: exactly planar, no face turned over, nowhere one part on another, face areas kept closely and lengths as well as can be. Areas and lengths are those of --reference (same vertices); for an 'unfolded.surf.gii' of 'explica unfold' they are those of the surface that its record names, and the region is its own. Holes stay open; a part joined to the rest by a single vertex is left out.

A closed surface needs --label (a patch) or --cuts (a hemisphere): a FreeSurfer patch or a label of the vertices that stay, or a flat map whose faces stay.

--cuts auto takes the medial wall out (--cortex; or lh.cortex.label or valid.shape.gii beside the surface; or the flattest fortieth of it) and finds relief cuts: each ends where a conformal map would change lengths most and comes along the sulci, where a way costs half as much for each standard deviation of depth; of five such cuts the one is taken that lowers the strain most for its length, until --cut.strain is reached. No face is lost: vertices along a cut become two, the second copies last in patch.surf.gii. Where a vertex has one place only, what touches a second copy is left out: of flat.surf.gii faces, of FreeSurfer's patches the vertices on cuts.

The map grows from a circle of few vertices to all of them, and is one-to-one from the start. A run that is stopped, by a signal or by --max-time at any moment, writes the map as far as it came, whole and one-to-one as ever, with the cuts found until then, and ends with exit code 3; --resume into the same --out goes on to the very map of a run that never stopped. --frames shows the way.

With --surfaces the map becomes a stack of depths: grid.nii.gz gives each cell its place in the tissue (RAS mm), --volumes are resampled into it, and to_flat.nii.gz gives each voxel of the first volume its u and v (mm in the map) and depth (0 at the white surface, 1 at the pial).)")
      .reference("Tutte 1963, Proceedings of the London Mathematical Society 13:743-767")
      .reference("Shen, Jiang, Zorin, Panozzo 2019, ACM Transactions on Graphics 38(4):32")
      .example(
          "explica flatten unfolded/unfolded.surf.gii --surfaces surfaces --volumes T1.nii.gz "
          "--out "
          "flat",
          "The flat map of an unfolded patch, and a volume as a stack of depths")
      .example("explica flatten lh.pial --cuts lh.cortex.patch.3d --out flat",
               "A hemisphere with given cuts")
      .example("explica flatten lh.pial --cuts auto --out flat", "A hemisphere, cut by the program")
      .reference("Ben-Chen, Gotsman, Bunin 2008, Computer Graphics Forum 27(2):449-458")
      .input("SURFACE", FileKind::Surface, "triangulated surface with a rim, or to be cut",
             s.surface)
      .options("Reading", s.reading)
      .inputOption("reference", FileKind::Surface,
                   "surface with the same vertices whose areas and lengths count", s.reference)
      .option("Region",
              Field{"cuts", "",
                    "what stays of a hemisphere: FreeSurfer patch, label (not 0), flat map, or "
                    "auto: cuts are found"},
              s.cuts)
      .inputOption("cortex", FileKind::VertexData,
                   "for --cuts auto, where there is cortex: label, annot, or map (not 0)", s.cortex,
                   "Region")
      .options("Region", s.cut, "cut.")
      .inputOption("label", FileKind::VertexLabel,
                   "lay flat only where this label, or one of several, is not 0", s.labels,
                   "Region")
      .option("Region", Field{"label-key", "", "lay flat only where --label has one of these keys"},
              s.labelKeys)
      .option("Flattening",
              Field{"area-tolerance", "",
                    "mean relative area error to reach (default: 0.01; with --cuts 0.05)", 1e-6, 1},
              s.areaTolerance)
      .options("Flattening", s.flatten, "solver.")
      .without("solver.area-tolerance")
      .without("solver.max-time")
      .without("solver.frames")
      .option("Flattening",
              Field{"frames", "",
                    "states to write on the way, evenly spaced along the way that vertices go", 0,
                    kMostFrames},
              s.flatten.frames)
      .option("Flattening", Field{"max-time", "s", "stop after this time", kAboveZero},
              s.flatten.maxTime)
      .option("Flattening", Field{"resume", "", "continue the run whose outputs are in --out"},
              s.resume)
      .reuseOutputIf(s.resume)
      .option("Grid", Field{"grid", "mm", "size of the grid's cells along u and v", 1e-3, 1e3},
              s.grid)
      .option("Grid",
              Field{"depths", "", "layers from white to pial (default: 5 with --surfaces, else 1)",
                    1, 1000},
              s.depths)
      .option("Grid",
              Field{"surfaces", "",
                    "folder with the white and pial surface of the same vertices, named as explica "
                    "surface, FreeSurfer, fMRIPrep, the HCP or pycortex do"},
              s.surfaces)
      .inputOption("volumes", FileKind::Volume, "volumes to resample into the grid, 3-D or 4-D",
                   s.volumes, "Grid")
      .severalWords("volumes")
      .option("Grid", Field{"nearest", "", "the nearest voxel's value, for label volumes"},
              s.nearest)
      .inputOption("map", FileKind::VertexData,
                   "values on the vertices, for patch.tsv; the first colours flat.png", s.maps,
                   "Patch")
      .inputOption("regions", FileKind::VertexLabel,
                   "regions for patch.tsv, their outlines in their own colours for flat.png",
                   s.regions, "Patch")
      .needs({"label-key"}, {"label"})
      .needs({"cortex", "cut.strain", "cut.most"}, {"cuts=auto"})
      .needs({"depths"}, {"surfaces"})
      .needs({"nearest"}, {"volumes"});
  declareOutputs(d);
}

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::vector<std::int32_t> everyFace(const Faces& faces) {
  std::vector<std::int32_t> all(static_cast<std::size_t>(faces.rows()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// What is laid flat: the surface that counts, and which of its faces.
struct Subject {
  io::LoadedSurface reference;
  std::vector<std::int32_t> faces;
};

/// The surface that an unfolding's record names, if it is still there unchanged.
std::optional<std::filesystem::path> recordedOriginal(const std::filesystem::path& surface) {
  const auto found = provenance::findRecordOf(surface, provenance::digestOf(surface));
  if (!found || !found->sameContent || found->record.value("command", "") != "unfold") return {};
  const auto& inputs = found->record["inputs"];
  const auto& places = found->record["execution"]["inputs"];
  for (std::size_t n = 0; n < inputs.size() && n < places.size(); ++n) {
    if (inputs[n].value("role", "") != "SURFACE") continue;
    const std::filesystem::path path = places[n].value("absolute", std::string());
    if (path.empty() || !std::filesystem::exists(path)) continue;
    if (provenance::digestOf(path).sha256 == inputs[n].value("sha256", "")) return path;
  }
  return {};
}

void requireSameVertices(const TriangleMesh& a, const TriangleMesh& b, const std::string& name) {
  if (a.vertexCount() == b.vertexCount()) return;
  throw InvalidInput("'" + name + "': has " + std::to_string(a.vertexCount()) +
                     " vertices where the surface has " + std::to_string(b.vertexCount()));
}

std::vector<std::int32_t> facesOfCuts(Context& context, const Settings& s,
                                      const TriangleMesh& mesh) {
  const auto all = everyFace(mesh.faces);
  if (*s.cuts == kAutomatic) {
    const bool closed = flattening::boundaryLoops(mesh.faces, mesh.vertexCount()).empty();
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

Subject subjectOf(Context& context, const Settings& s) {
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
  subject.faces = everyFace(mesh.faces);
  if (s.cuts) subject.faces = facesOfCuts(context, s, mesh);
  if (!s.labels.empty()) {
    const auto marked =
        io::markedByLabels({s.labels.begin(), s.labels.end()}, s.labelKeys, mesh.vertexCount());
    flattening::VertexKeys keys(mesh.vertexCount());
    std::copy(marked.begin(), marked.end(), keys.begin());
    subject.faces = flattening::facesWithin(mesh.faces, subject.faces, keys);
  }
  const auto region = std::filesystem::path(s.surface).parent_path() / "region.label.gii";
  if (recorded && s.labels.empty() && !s.cuts && std::filesystem::exists(region)) {
    const auto labels = io::readVertexLabels(context.input(region, "region"), mesh.vertexCount());
    subject.faces = flattening::facesWithin(mesh.faces, subject.faces, labels.keys);
  }
  loaded.mesh = std::move(mesh);
  subject.reference = std::move(loaded);
  return subject;
}

/// The map on all vertices of the whole, those off the patch at the origin.  A vertex on a cut lies
/// where its first copy does, and faces at second copies are left out.
TriangleMesh wholeMap(const TriangleMesh& reference, const flattening::Disc& disc,
                      const flattening::FlatPositions& map) {
  const std::vector<bool> second = flattening::secondCopies(disc);
  TriangleMesh flat{Positions::Zero(reference.vertexCount(), 3), Faces(disc.mesh.faceCount(), 3)};
  for (std::size_t v = 0; v < disc.vertexOrigin.size(); ++v) {
    if (second[v]) continue;
    flat.positions.row(disc.vertexOrigin[v]).head<2>() = map.row(static_cast<Eigen::Index>(v));
  }
  Eigen::Index kept = 0;
  for (std::size_t f = 0; f < disc.faceOrigin.size(); ++f) {
    const auto corners = disc.mesh.faces.row(static_cast<Eigen::Index>(f));
    if (second[corners[0]] || second[corners[1]] || second[corners[2]]) continue;
    flat.faces.row(kept++) = reference.faces.row(disc.faceOrigin[f]);
  }
  flat.faces.conservativeResize(kept, 3);
  return flat;
}

/// Which vertices of the whole FreeSurfer's patch has: one place each, none on a cut, for its faces
/// are all those between its vertices.
std::vector<bool> freeSurferVertices(const flattening::Disc& disc, Eigen::Index vertexCount) {
  const std::vector<bool> second = flattening::secondCopies(disc);
  std::vector<bool> inPatch(static_cast<std::size_t>(vertexCount), false);
  for (const std::int32_t v : disc.vertexOrigin) inPatch[v] = true;
  for (std::size_t v = 0; v < second.size(); ++v) {
    if (second[v]) inPatch[disc.vertexOrigin[v]] = false;
  }
  return inPatch;
}

/// Values of the whole's vertices at the patch's.
template <class Vector>
auto atPatch(const Vector& whole, const flattening::Disc& disc) {
  Vector part(static_cast<Eigen::Index>(disc.vertexOrigin.size()));
  for (std::size_t v = 0; v < disc.vertexOrigin.size(); ++v) {
    part[static_cast<Eigen::Index>(v)] = whole[disc.vertexOrigin[v]];
  }
  return part;
}

Positions patchPositions(const flattening::FlatMap& map) {
  Positions flat = Positions::Zero(map.positions.rows(), 3);
  flat.leftCols<2>() = map.positions;
  return flat;
}

void writeSurfaces(Context& context, const Subject& subject, const flattening::Disc& disc,
                   const flattening::FlatMap& map, const TriangleMesh& flat) {
  io::SurfaceMetadata metadata = subject.reference.metadata;
  metadata.topologicalType = "Open";
  io::writeGiftiSurface(context.output("patch.surf.gii"), disc.mesh, metadata);
  metadata.geometricType = "Flat";
  metadata.secondary.clear();
  metadata.name = "flat";
  io::writeGiftiSurface(context.output("flat.surf.gii"), flat, metadata);
  const Positions positions = patchPositions(map);
  io::writeGiftiSurface(context.output("patch_flat.surf.gii"), {positions, disc.mesh.faces},
                        metadata);
  Eigen::VectorXd numbers(disc.mesh.vertexCount());
  std::copy(disc.vertexOrigin.begin(), disc.vertexOrigin.end(), numbers.begin());
  io::writeGiftiShape(context.output("vertex_of.shape.gii"), {{"vertex", "", numbers}},
                      metadata.structure);
  const std::string side = metadata.structure == "CortexRight" ? "rh" : "lh";
  const auto inPatch = freeSurferVertices(disc, flat.vertexCount());
  io::writePatch(context.output(side + ".patch.flat"), io::patchOf(flat, inPatch));
  TriangleMesh whole = subject.reference.mesh;
  if (subject.reference.origin.format == "FreeSurfer") {  // patches hold surface RAS as stored
    const Eigen::Matrix4d back = subject.reference.origin.applied.inverse();
    whole.positions = ((whole.positions * back.topLeftCorner<3, 3>().transpose()).rowwise() +
                       back.topRightCorner<3, 1>().transpose())
                          .eval();
  }
  io::writePatch(context.output(side + ".patch.3d"), io::patchOf(whole, inPatch));
}

/// Values of the patch's vertices on the whole's; where a vertex has copies, their mean.
Eigen::VectorXd onWhole(const Eigen::VectorXd& part, const flattening::Disc& disc,
                        Eigen::Index vertexCount, double elsewhere) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(vertexCount), count = sum;
  for (std::size_t v = 0; v < disc.vertexOrigin.size(); ++v) {
    sum[disc.vertexOrigin[v]] += part[static_cast<Eigen::Index>(v)];
    count[disc.vertexOrigin[v]] += 1;
  }
  return (count.array() > 0).select(sum.cwiseQuotient(count), elsewhere);
}

/// Distortion and distance errors, into the summary and distortion.shape.gii.
/// @return area ratio at the patch's vertices
Eigen::VectorXd measure(Context& context, const Subject& subject, const flattening::Disc& disc,
                        const TriangleMesh& flat, unfolding::FlatSummary& summary,
                        Termination& termination) {
  const TriangleMesh& before = disc.mesh;
  const auto all = everyFace(flat.faces);
  unfolding::DistortionOptions plain;
  plain.geodesicSources = 0;
  const auto distortion = unfolding::measureDistortion(before, flat.positions, all, plain);
  const Eigen::VectorXd angleDeg = distortion.angleErrorRad * (180 / kPi);
  const Eigen::VectorXd ratio = unfolding::vertexMeans(before, all, distortion.areaRatio, 1);
  const auto whole = [&](const Eigen::VectorXd& part, double elsewhere) {
    return onWhole(part, disc, subject.reference.mesh.vertexCount(), elsewhere);
  };
  io::writeGiftiShape(
      context.output("distortion.shape.gii"),
      {{"area ratio", "", whole(ratio, 1)},
       {"angle change", "degrees", whole(unfolding::vertexMeans(before, all, angleDeg, 0), 0)},
       {"edge strain", "", whole(unfolding::vertexStrains(before, flat.positions, all), 0)}},
      subject.reference.metadata.structure);
  flattening::DistanceOptions options;
  options.farSources = static_cast<int>(
      std::clamp(kDistanceWork / static_cast<double>(flat.faceCount() / 2 + 1), 20.0, 100.0));
  describing(context, termination, [&] {
    const auto pairs = flattening::drawPairs(before, all, options);
    const auto straight = flattening::DistanceKind::Straight;
    summary.distances = {flattening::distanceError(pairs.local, flat, all, straight),
                         flattening::distanceError(pairs.all, flat, all, straight)};
  });
  summary.distortion = distortion;
  return ratio;
}

/// FreeSurfer's files name their maps with the folder they came from; those of `explica sample` by
/// depth alone.
std::string mapName(const std::string& file, const std::string& name) {
  const std::string own = std::filesystem::path(name.empty() ? file : name).filename().string();
  std::string stem = std::filesystem::path(file).filename().string();
  constexpr std::string_view kSampled = ".func.gii";
  if (name.empty() || !stem.ends_with(kSampled)) return own;
  stem.resize(stem.size() - kSampled.size());
  return stem + " " + own;
}

/// Maps on the patch's vertices, and how the first colours the picture.
std::vector<flattening::PatchMap> mapsOnPatch(const Settings& s, const flattening::Disc& disc,
                                              Eigen::Index whole, report::SurfacePaint& paint) {
  std::vector<flattening::PatchMap> maps;
  for (const std::string& path : s.maps) {
    for (const io::VertexMap& read : io::readVertexMaps(path, whole)) {
      maps.push_back({mapName(path, read.name), atPatch(read.values, disc)});
      if (maps.size() == 1) {
        paint.values = maps[0].values;
        paint.scale = report::scaleFor(paint.values, maps[0].name, read.unit);
      }
    }
  }
  return maps;
}

/// Regions on the patch's vertices: only those that it has are left.
std::vector<io::LabelMap> regionsOnPatch(const Settings& s, const flattening::Disc& disc,
                                         Eigen::Index whole) {
  std::vector<io::LabelMap> regions = io::readRegions({s.regions.begin(), s.regions.end()}, whole);
  for (io::LabelMap& one : regions) {
    one.keys = atPatch(one.keys, disc);
    std::erase_if(one.table, [&](const io::LabelEntry& entry) {
      return std::find(one.keys.begin(), one.keys.end(), entry.key) == one.keys.end();
    });
  }
  return regions;
}

void markRegions(const io::LabelMap& regions, const TriangleMesh& flat, report::FlatMarks& marks) {
  std::map<Label, report::Colour> colours;
  for (const io::LabelEntry& entry : regions.table) {
    colours[entry.key] = report::colourOfLabel(entry.key, entry.colour);
  }
  const auto colourOf = [&](Label key) {
    const auto found = colours.find(key);
    return found == colours.end() ? std::nullopt : std::optional(found->second);
  };
  for (const auto& piece : flattening::outlines(flat.faces, flat.positions, regions.keys)) {
    marks.lines.push_back(
        {piece.from, piece.to, colourOf(piece.sides[0]), colourOf(piece.sides[1])});
  }
  const auto places = flattening::regionPlaces(flat, regions.keys);
  std::vector<std::pair<std::ptrdiff_t, const io::LabelEntry*>> bySize;
  for (const io::LabelEntry& entry : regions.table) {
    bySize.emplace_back(-std::count(regions.keys.begin(), regions.keys.end(), entry.key), &entry);
  }
  std::stable_sort(bySize.begin(), bySize.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [size, entry] : bySize) {
    if (places.contains(entry->key)) marks.names.emplace_back(places.at(entry->key), entry->name);
  }
}

void writeRegions(Context& context, io::LabelMap regions, const std::string& structure) {
  const bool zeroIsRegion = std::any_of(regions.table.begin(), regions.table.end(),
                                        [](const io::LabelEntry& e) { return e.key == 0; });
  const Label none = zeroIsRegion ? -1 : 0;
  for (Label& key : regions.keys) key = key == io::kNoRegion ? none : key;
  regions.table.insert(regions.table.begin(), {none, "???", {0, 0, 0, 0}});
  io::writeGiftiLabel(context.output("patch_" + regions.name + ".label.gii"), regions, structure);
}

void writePatchTable(Context& context, const Settings& s, const Subject& subject,
                     const flattening::Disc& disc, const flattening::FlatMap& map,
                     const Eigen::VectorXd& areaRatio) {
  report::SurfacePaint paint;
  const Eigen::Index whole = subject.reference.mesh.vertexCount();
  const auto maps = mapsOnPatch(s, disc, whole, paint);
  if (maps.empty()) {
    paint.values = areaRatio.cwiseMax(1e-6).array().log2();
    paint.scale = {report::ColourMap::Diverging, -0.5, 0.5, "area, doublings", ""};
  }
  const TriangleMesh flat{patchPositions(map), disc.mesh.faces};
  std::vector<flattening::PatchRegions> rows;
  report::FlatMarks marks;
  for (const io::LabelMap& regions : regionsOnPatch(s, disc, whole)) {
    flattening::PatchRegions& row = rows.emplace_back();
    row.keys = regions.keys;
    for (const io::LabelEntry& entry : regions.table) row.names[entry.key] = entry.name;
    markRegions(regions, flat, marks);
    writeRegions(context, regions, subject.reference.metadata.structure);
  }
  writeTextFile(context.output("patch.tsv"),
                flattening::patchTable(disc.mesh, flat.positions, rows, maps));
  report::writePng(context.output("flat.png"), report::flatFigure(flat, paint, marks));
}

/// The names of a hemisphere's white or pial surface: of explica surface, FreeSurfer, fMRIPrep, the
/// HCP and pycortex.
std::vector<std::string> namesOf(const std::string& surface, bool right) {
  const std::string side = right ? "R" : "L", prefix = right ? "rh" : "lh";
  const std::string pycortex = surface == "white" ? "wm" : "pia";
  return {surface + ".surf.gii",
          prefix + "." + surface,
          prefix + "." + surface + ".surf.gii",
          "*hemi-" + side + "_*" + surface + ".surf.gii",
          "*." + side + "." + surface + ".*surf.gii",
          pycortex + "_" + prefix + ".gii"};
}

/// The first file of a folder, or of its surf, whose name is one of these.
std::optional<std::filesystem::path> fileNamed(const std::filesystem::path& folder,
                                               const std::vector<std::string>& names) {
  namespace fs = std::filesystem;
  std::error_code absent;
  for (const fs::path& place : {folder, folder / "surf"}) {
    for (const std::string& name : names) {
      std::set<fs::path> found;
      for (const fs::directory_entry& entry : fs::directory_iterator(place, absent)) {
        const std::string file = entry.path().filename().string();
        if (fnmatch(name.c_str(), file.c_str(), 0) == 0) found.insert(entry.path());
      }
      if (!found.empty()) return *found.begin();
    }
  }
  return {};
}

using Sheet = std::array<Positions, 2>;  // white and pial, each V x 3

Sheet sheetSurfaces(Context& context, const Settings& s, const Subject& subject) {
  Sheet sheet;
  const bool right = subject.reference.metadata.structure == "CortexRight";
  for (std::size_t n = 0; n < sheet.size(); ++n) {
    const std::string name = n == 0 ? "white" : "pial";
    const auto names = namesOf(name, right);
    const auto found = fileNamed(*s.surfaces, names);
    if (!found) {
      std::string tried;
      for (const std::string& one : names) tried += (tried.empty() ? "" : ", ") + one;
      throw InvalidInput("surfaces: '" + *s.surfaces + "' has no " + name +
                         " surface (looked for " + tried + ")");
    }
    const auto loaded = readSurface(context, name, context.input(*found, name).string(), s.reading);
    requireSameVertices(loaded.mesh, subject.reference.mesh, found->string());
    sheet[n] = loaded.mesh.positions;
  }
  return sheet;
}

/// Reads what is written beside the map once, so that its faults are said before the long part.
std::optional<Sheet> checkBeside(Context& context, const Settings& s, const Subject& subject) {
  const Eigen::Index vertices = subject.reference.mesh.vertexCount();
  for (const std::string& file : s.maps) static_cast<void>(io::readVertexMaps(file, vertices));
  static_cast<void>(io::readRegions({s.regions.begin(), s.regions.end()}, vertices));
  io::VolumeReadOptions first;
  first.frame = 0;
  for (const std::string& file : s.volumes) static_cast<void>(io::readGrid(file, first));
  if (!s.surfaces) return {};
  return sheetSurfaces(context, s, subject);
}

std::string volumeName(const std::string& path) {
  std::string name = std::filesystem::path(path).filename().string();
  for (const std::string ending : {".gz", ".nii", ".mgz", ".mgh", ".nrrd", ".mha"}) {
    if (name.size() > ending.size() && name.ends_with(ending))
      name.resize(name.size() - ending.size());
  }
  return name;
}

/// Every frame of a volume on the grid's points.
std::vector<VolumeOnDemand<float>> framesOnGrid(const Settings& s, const std::string& path,
                                                const Volume<Eigen::Vector3f>& points) {
  std::vector<VolumeOnDemand<float>> frames;
  io::VolumeReadOptions options;
  options.allowNonFinite = true;
  options.allowAllZero = true;
  int count = 1;
  for (int n = 0; n < count; ++n) {
    options.frame = n;
    const auto loaded = io::readScalars(path, options);
    if (n == 0 && loaded.origin.storedSize.size() > 3) count = loaded.origin.storedSize[3];
    auto values =
        std::make_shared<Volume<float>>(flattening::resampled(loaded.volume, points, s.nearest));
    VolumeOnDemand<float> frame;
    frame.grid = values->grid;
    frame.end = values->size();
    frame.fill = [values](std::size_t first, std::size_t many, float* to) {
      std::copy_n(values->data.begin() + static_cast<std::ptrdiff_t>(first), many, to);
    };
    frames.push_back(std::move(frame));
  }
  return frames;
}

void writeGrid(Context& context, const Settings& s, const std::optional<Sheet>& surfaces,
               const flattening::Disc& disc, const TriangleMesh& flat) {
  flattening::FlatSheet sheet{flat.faces, flat.positions, disc.mesh.positions, disc.mesh.positions};
  if (surfaces) {
    sheet.inner = surfaces->front()(disc.vertexOrigin, Eigen::all);
    sheet.outer = surfaces->back()(disc.vertexOrigin, Eigen::all);
  }
  flattening::FlatGridOptions options;
  options.cell = s.grid;
  options.depths = s.depths.value_or(s.surfaces ? 5 : 1);
  const auto points = flattening::flatGrid(sheet, options);
  io::writeVolume(context.output("grid.nii.gz"), points);
  for (const std::string& path : s.volumes) {
    const auto frames = framesOnGrid(s, path, points);
    const auto out = context.output("flat_" + volumeName(path) + ".nii.gz");
    if (frames.size() == 1) {
      io::writeVolume(out, frames.front());
    } else {
      io::writeFrames(out, frames);
    }
  }
  if (!s.surfaces || s.volumes.empty()) return;
  io::VolumeReadOptions reading;
  reading.frame = 0;
  io::writeVolume(context.output("to_flat.nii.gz"),
                  flattening::flatCoordinates(sheet, io::readGrid(s.volumes.front(), reading)));
}

void warnOf(Context& context, const flattening::Disc& disc, const flattening::FlatMap& map) {
  if (disc.trimmedFaces > 0) {
    context.warn(std::to_string(disc.trimmedFaces) +
                 " faces hang on the rest by a single vertex and were left out");
  }
  if (!disc.holes.empty()) {
    context.warn("the surface has " + std::to_string(disc.holes.size()) + " holes; they stay open");
  }
  if (map.turnedOver > 0 || map.rimCrossings > 0) {
    context.warn(std::to_string(map.turnedOver) + " faces are turned over and " +
                 std::to_string(map.rimCrossings) +
                 " pairs of rim edges meet in single precision: the map is not one-to-one there");
  }
}

/// Writes the states on the way, and says whether they are one-to-one as they are written.
/// @return faces turned over in a frame, at most
std::optional<std::int64_t> writeFrames(Context& context, const Subject& subject,
                                        const flattening::Disc& disc,
                                        const std::vector<flattening::FlatPositions>& frames) {
  if (frames.empty()) return {};
  io::SurfaceMetadata metadata = subject.reference.metadata;
  metadata.topologicalType = "Open";
  metadata.geometricType = "Flat";
  metadata.secondary.clear();
  std::int64_t turnedOver = 0;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    turnedOver = std::max(turnedOver, flattening::countTurnedOver(disc.mesh.faces, frames[n]));
    char name[64];
    std::snprintf(name, sizeof name, "frames/frame-%04zu.surf.gii", n);
    io::writeGiftiSurface(context.output(name), wholeMap(subject.reference.mesh, disc, frames[n]),
                          metadata);
  }
  return turnedOver;
}

// What comes after cuts and map measures and writes for about four times as long as the start took,
// and each frame for half as long.
constexpr KeptTime kKept = {4, 0.5};

/// The run from the opened surface on: its disc, its map, and what going on needs.
struct Made {
  flattening::Disc disc;
  flattening::FlatMap map;
  flattening::Checkpoint state;
  double secondsCut = 0;
};

Made make(Context& context, const Settings& s, const Subject& subject, flattening::Disc disc,
          flattening::FlattenOptions options) {
  const auto begin = Clock::now();
  std::optional<flattening::Checkpoint> from;
  if (s.resume) from = flattening::readCheckpoint(context.outputFolder() / kStateFile);
  Made made;
  made.state.uncut = flattening::sumOver(disc);
  bool cutting = false;
  if (s.cuts == kAutomatic) {
    auto step = context.step("cut");
    Monitor limited = context.monitor();
    limited.stopWanted = [&] {
      return context.monitor().shouldStop() ||
             (options.maxTime && secondsSince(begin) > *options.maxTime);
    };
    Opened opened =
        openedByItself(context, limited, subject.reference, disc, s.cut, from ? &*from : nullptr);
    cutting = opened.plan.termination == Termination::Interrupted;
    made.state.cuts = std::move(opened.plan);
    disc = std::move(opened.disc);
  }
  const StopScope kept(nullptr);  // the map is whole at any moment
  made.secondsCut = secondsSince(begin);
  constexpr double kAtOnce = 1e-9;  // s
  if (options.maxTime) options.maxTime = std::max(kAtOnce, *options.maxTime - made.secondsCut);
  if (cutting) options.frames = 0;  // the map stands at its very start
  auto step = context.step("flatten");
  made.map = flattening::flatten(disc, options, context.monitor(), from ? &from->map : nullptr);
  step.iterations(made.map.iterations);
  step.termination(made.map.termination);
  if (!cutting) made.state.map = std::move(made.map.state);
  made.disc = std::move(disc);
  return made;
}

Termination run(Context& context, const Settings& s) {
  const auto begin = Clock::now();
  const Subject subject = subjectOf(context, s);
  const std::optional<Sheet> surfaces = checkBeside(context, s, subject);
  flattening::Disc whole = flattening::discOf(subject.reference.mesh, subject.faces);
  sayHowRead(context, subject.reference.origin);
  flattening::FlattenOptions options = s.flatten;
  options.areaTolerance = s.areaTolerance.value_or(s.cuts ? kCutTolerance : kPatchTolerance);
  const double read = secondsSince(begin);
  if (options.maxTime) {
    options.maxTime = timeToIterate(*options.maxTime, read, options.frames, kKept);
  }
  const Made made = make(context, s, subject, std::move(whole), options);
  const StopScope kept(nullptr);  // what is reached is written
  const flattening::Disc& disc = made.disc;
  const flattening::FlatMap& map = made.map;
  const double flattened = secondsSince(begin);
  warnOf(context, disc, map);
  auto step = context.step("measure and write");
  flattening::writeCheckpoint(context.output(kStateFile), made.state);
  const TriangleMesh flat{patchPositions(map), disc.mesh.faces};
  writeSurfaces(context, subject, disc, map, wholeMap(subject.reference.mesh, disc, map.positions));
  unfolding::FlatSummary summary;
  summary.disc = &disc;
  summary.map = &map;
  summary.area = geometry::totalArea(disc.mesh);
  summary.areaTolerance = options.areaTolerance;
  summary.turnedOverInFrames = writeFrames(context, subject, disc, map.frames);
  Termination termination = map.termination;
  const Eigen::VectorXd areaRatio = measure(context, subject, disc, flat, summary, termination);
  writePatchTable(context, s, subject, disc, map, areaRatio);
  writeGrid(context, s, surfaces, disc, flat);
  context.results(summary);
  context.result("seconds_start", read);
  context.result("seconds_cut", made.secondsCut);
  context.result("seconds_flatten", flattened - read - made.secondsCut);
  context.result("seconds_output", secondsSince(begin) - flattened);
  const bool folded = map.turnedOver > 0 || map.rimCrossings > 0;
  return folded ? Termination::Stalled : termination;
}

}  // namespace

Command flattenCommand() {
  return makeCommand<Settings>("flatten", declare, run);
}

}  // namespace explica::app
