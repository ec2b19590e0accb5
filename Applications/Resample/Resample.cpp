// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/StatedHemisphere.h"
#include "Explica/IO/VertexFile.h"
#include "Explica/Maps/Icosphere.h"
#include "Explica/Maps/Resampling.h"
#include "Explica/Provenance/Digest.h"
#include "Explica/Provenance/Record.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>

namespace explica::app {
namespace {

constexpr const char* kFsLR = "fs_LR-32k";

struct ResampleSettings {
  std::vector<std::string> maps;
  std::optional<std::string> from;
  std::string to;
  std::optional<std::string> templateFolder;
  maps::ResamplingMethod method = maps::ResamplingMethod::Adaptive;
  std::optional<std::string> areas, space;
  std::vector<std::string> amounts;
};

void declare(Declaration& d, ResampleSettings& s) {
  d.synopsis("maps, labels and surfaces brought from one sphere to another in register with it")
      .description(
          "Carries what is known at the vertices of one surface over to the vertices of another, "
          "through two spheres in register: a person's sphere.reg and a template's, or two of one "
          "template. Maps and series by adaptive barycentric weights with the vertices' areas (as "
          "Workbench's ADAP_BARY_AREA), so that every vertex counts and integrals stay; labels by "
          "the largest weight; surfaces always by barycentric weights. NaN is left out while at "
          "least half of a vertex's weight is known.\n\n"
          "--to takes a sphere, or the name of one: fsaverage3 to fsaverage6 and fsaverage are "
          "made (vertices in fsaverage's order, so that those of a coarser one are the first of a "
          "finer one; FreeSurfer's folder fsaverage3 numbers the same vertices in another way). "
          "fs_LR-32k is read: --template names the folder with the HCP's "
          "fs_LR-deformed_to-fsaverage.L.sphere.32k_fs_LR.surf.gii, which is in register with "
          "fsaverage.")
      .reference("Glasser et al. 2013, NeuroImage 80:105-124")
      .example(
          "explica resample lh.thickness lh.aparc.annot --from lh.sphere.reg --to fsaverage5 "
          "--areas lh.white --out on-fsaverage5",
          "Thickness and labels of a person at fsaverage5's 10,242 vertices")
      .input("MAP", FileKind::Any, "per-vertex maps, series, labels or surfaces", s.maps)
      .oneByOne("MAP")
      .inputOption("from", FileKind::Surface, "sphere with the maps' vertices", s.from)
      .require("from")
      .category("Target")
      .option("to", "sphere in register, or fsaverage3 ... fsaverage6, fsaverage, fs_LR-32k", s.to)
      .require("to")
      .option("template", "folder with fs_LR's spheres", s.templateFolder)
      .category("Weights")
      .option("method", "how maps are weighted", s.method)
      .option("areas",
              "surfaces whose vertex areas count, of the maps' and of the target's vertices "
              "(SURF,SURF; one left out: its sphere)",
              s.areas)
      .inputOption("amounts", FileKind::VertexData,
                   "maps of amounts at vertices, such as areas and volumes: their sums stay, "
                   "whatever --method",
                   s.amounts, "Weights")
      .category("Target")
      .option("space",
              "name of the space in file names, or folder of the template, where --from is "
              "in register with another one than the target's name says",
              s.space)
      .needs({"template"}, {"to=fs_LR-32k"})
      .needs({"areas"}, {"method=adaptive", "amounts"})
      .output("*_space-*", FileKind::Any,
              "NAME_space-SPACE_den-DENSITY: each file, in its own format");
}

struct ResampleTarget {
  io::LoadedSurface sphere;
  std::string space;
};

/// The HCP's fs_LR sphere of a hemisphere at its place on fsaverage.
std::string fsLRFile(const ResampleSettings& s, const std::string& structure) {
  const std::string side = structure == "CortexRight" ? "R" : "L";
  const std::string name = "fs_LR-deformed_to-fsaverage." + side + ".sphere.32k_fs_LR.surf.gii";
  if (!s.templateFolder) {
    throw UsageError("--to fs_LR-32k needs --template DIR with the HCP's " + name);
  }
  return (std::filesystem::path(*s.templateFolder) / name).string();
}

/// Letters and digits of a name, or of the last part of a path, as file names have them.
std::string spaceOf(const std::string& name) {
  std::filesystem::path path = std::filesystem::path(name).lexically_normal();
  if (path.filename().empty()) path = path.parent_path();
  std::string space = path.filename().string();
  std::erase_if(space, [](unsigned char letter) { return std::isalnum(letter) == 0; });
  return space;
}

ResampleTarget readTarget(Context& context, const ResampleSettings& s,
                          const std::string& structure) {
  ResampleTarget target;
  if (s.space) target.space = spaceOf(*s.space);
  if (const auto level = maps::fsaverageLevel(s.to)) {
    target.sphere.mesh = maps::fsaverageSphere(*level);
    target.sphere.metadata.structure = structure;
    if (!s.space) target.space = "fsaverage";
    return target;
  }
  const bool fsLR = s.to == kFsLR;
  const std::string file = fsLR ? fsLRFile(s, structure) : s.to;
  if (!isThere(file) && !fsLR) {
    throw InvalidInput("--to: '" + s.to +
                       "' is no file, and none of fsaverage3 ... fsaverage6, fsaverage, fs_LR-32k");
  }
  context.input(file, "to");
  target.sphere = readSurface(context, "to", file, {.space = io::SurfaceSpace::Scanner});
  if (!s.space) target.space = fsLR ? "fsLR" : spaceOf(io::nameOfSurface(file));
  return target;
}

/// A sphere that explica has made says by its record what it is in register with.
/// @throws InvalidInput  another template than --to names
void requireRegister(const ResampleSettings& s) {
  if (s.space || (!maps::fsaverageLevel(s.to) && s.to != kFsLR)) return;
  const auto found = provenance::findRecordOf(*s.from, provenance::digestOf(*s.from));
  if (!found || !found->sameContent) return;
  const std::string command = found->record.value("command", "");
  const auto& options = found->record["options"];
  std::string to = "another sphere";
  for (const char* option : {"template", "to"}) {
    if (options.contains(option) && options[option].is_string()) to = options[option];
  }
  if (command != "sphere" && (command != "register" || to.find("fsaverage") != to.npos)) return;
  throw InvalidInput("'" + *s.from + "' is " +
                     (command == "sphere" ? "not registered" : "registered to " + to) +
                     ", and --to " + s.to +
                     " is fsaverage's: take the sphere of explica register --template fsaverage, "
                     "or say with --space what this one is in register with");
}

/// "10k" of 10,242 vertices, "642" of 642.
std::string densityOf(Eigen::Index vertices) {
  return vertices < 1000 ? std::to_string(vertices) : std::to_string((vertices + 500) / 1000) + "k";
}

Eigen::VectorXd areasOf(Context& context, const ResampleSettings& s, std::size_t place,
                        const TriangleMesh& sphere) {
  const std::string both = s.areas.value_or(""), first = both.substr(0, both.find(','));
  const std::string path =
      place == 0 ? first : both.substr(std::min(first.size() + 1, both.size()));
  if (path.empty()) return geometry::vertexAreas(sphere);
  context.input(path, "areas");
  const TriangleMesh mesh =
      readSurface(context, "areas", path, {.space = io::SurfaceSpace::Scanner}).mesh;
  if (mesh.vertexCount() != sphere.vertexCount()) {
    throw InvalidInput("'" + path + "': has " + std::to_string(mesh.vertexCount()) +
                       " vertices, its sphere " + std::to_string(sphere.vertexCount()));
  }
  return geometry::vertexAreas(mesh);
}

/// A file to be carried over, and what it holds.
struct CarriedFile {
  std::string output, structure;
  bool amounts = false;
  io::VertexFileKind kind = io::VertexFileKind::Maps;
  std::vector<io::VertexMap> maps;
  io::LabelMap labels;
  io::LoadedSurface surface;
};

CarriedFile readFile(const std::string& path, const io::LoadedSurface& from,
                     const std::string& entity) {
  CarriedFile file;
  file.kind = io::vertexFileKind(path);
  file.output = io::nameWithEntity(path, entity);
  if (file.kind == io::VertexFileKind::Surface) {
    file.surface = io::readSurface(path);
    if (file.surface.mesh.vertexCount() == from.mesh.vertexCount()) return file;
    throw InvalidInput("'" + path + "': has " + std::to_string(file.surface.mesh.vertexCount()) +
                       " vertices, the sphere of --from " +
                       std::to_string(from.mesh.vertexCount()));
  }
  file.structure = io::statedStructure(path);
  if (file.structure.empty()) file.structure = from.metadata.structure;
  if (file.kind == io::VertexFileKind::Labels) {
    file.labels = io::readVertexLabels(path, from.mesh.vertexCount());
  } else {
    file.maps = io::readVertexMaps(path, from.mesh.vertexCount());
  }
  return file;
}

std::vector<CarriedFile> readFiles(const ResampleSettings& s, const io::LoadedSurface& from,
                                   const ResampleTarget& target) {
  const std::string entity =
      "space-" + target.space + "_den-" + densityOf(target.sphere.mesh.vertexCount());
  std::vector<CarriedFile> files;
  std::set<std::string> names;
  std::vector<std::string> all = s.maps;
  all.insert(all.end(), s.amounts.begin(), s.amounts.end());
  for (const std::string& path : all) {
    files.push_back(readFile(path, from, entity));
    files.back().amounts = files.size() > s.maps.size();
    if (files.back().amounts && files.back().kind != io::VertexFileKind::Maps) {
      throw InvalidInput("'" + path + "': holds no amounts at vertices, but a surface or labels");
    }
    if (!names.insert(files.back().output).second) {
      throw UsageError("two files would be written to '" + files.back().output +
                       "'; resample them into folders of their own");
    }
  }
  return files;
}

/// Weights of maps and labels, those of surfaces, and those of amounts.
struct Weights {
  maps::ResamplingWeights maps, surfaces, amounts;
  Eigen::VectorXd toAreas;  ///< mm^2, of the target's vertices
};

void carry(const std::filesystem::path& path, CarriedFile file, const Weights& weights,
           const Faces& faces) {
  switch (file.kind) {
    case io::VertexFileKind::Surface:
      file.surface.mesh = {maps::resampleMaps(weights.surfaces, file.surface.mesh.positions),
                           faces};
      io::writeSurface(path, file.surface.mesh, file.surface.metadata);
      break;
    case io::VertexFileKind::Labels:
      file.labels.keys = maps::resampleLabels(weights.maps, file.labels.keys);
      if (path.extension() == ".annot") {
        io::writeFreeSurferAnnot(path, file.labels);
      } else {
        io::writeGiftiLabel(path, file.labels, file.structure);
      }
      break;
    case io::VertexFileKind::Maps:
      for (io::VertexMap& map : file.maps) {
        map.values = file.amounts
                         ? maps::resampleAmounts(weights.amounts, weights.toAreas, map.values)
                         : Eigen::VectorXd(maps::resampleMaps(weights.maps, map.values));
      }
      io::writeVertexMaps(path, file.maps, file.structure, faces.rows());
  }
}

Termination run(Context& context, const ResampleSettings& s) {
  const io::LoadedSurface from =
      readSurface(context, "from", *s.from, {.space = io::SurfaceSpace::Scanner});
  requireRegister(s);
  const ResampleTarget target = readTarget(context, s, from.metadata.structure);
  const std::vector<CarriedFile> files = readFiles(s, from, target);
  maps::requireSphere(from.mesh, "'" + *s.from + "'");
  maps::requireSphere(target.sphere.mesh, "'" + s.to + "'");
  const Eigen::VectorXd fromAreas = areasOf(context, s, 0, from.mesh);
  const Eigen::VectorXd toAreas = areasOf(context, s, 1, target.sphere.mesh);
  auto step = context.step("resample");
  const auto weightsBy = [&](maps::ResamplingMethod method) {
    return maps::resamplingWeights(from.mesh, target.sphere.mesh, method, fromAreas, toAreas);
  };
  using enum maps::ResamplingMethod;
  Weights weights{weightsBy(s.method), weightsBy(Barycentric), {}, toAreas};
  // By the others, what lies at a vertex that no target takes from would be lost.
  if (!s.amounts.empty()) {
    weights.amounts = s.method == Adaptive ? weights.maps : weightsBy(Adaptive);
  }
  for (std::size_t n = 0; n < files.size(); ++n) {
    checkpoint(context.monitor());
    context.monitor().progress(static_cast<double>(n) / static_cast<double>(files.size()),
                               files[n].output);
    carry(context.output(files[n].output), files[n], weights, target.sphere.mesh.faces);
  }
  context.result("files", files.size());
  context.result("vertices_from", static_cast<long>(from.mesh.vertexCount()));
  context.result("vertices_to", static_cast<long>(target.sphere.mesh.vertexCount()));
  return Termination::NotRun;
}

}  // namespace

Command resampleCommand() {
  return makeCommand<ResampleSettings>("resample", declare, run);
}

}  // namespace explica::app
