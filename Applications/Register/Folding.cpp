// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Folding.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Sphere/SphereMap.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

bool isRight(const std::string& structure) {
  return structure == "CortexRight";
}

/// The first of the names that is a file of the folder or of its folder `surf`.
std::optional<std::string> findFile(const fs::path& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    for (const fs::path& place : {folder / name, folder / "surf" / name}) {
      if (fs::is_regular_file(place)) return place.string();
    }
  }
  return {};
}

std::vector<std::string> namesOf(const std::string& structure, const std::string& freeSurfer,
                                 const std::string& gifti) {
  const bool right = isRight(structure);
  return {(right ? "rh." : "lh.") + freeSurfer, (right ? "hemi-R_" : "hemi-L_") + gifti};
}

std::vector<std::string> sphereNames(const std::string& structure) {
  auto names = namesOf(structure, "sphere.reg", "sphere.surf.gii");
  // The 164k sphere as Human Connectome Project's pipelines distribute it.
  const std::string side = isRight(structure) ? "R" : "L";
  names.push_back("fsaverage_std_sphere." + side + ".164k_fsavg_" + side + ".surf.gii");
  return names;
}

fs::path templateFolder(const std::string& name) {
  if (fs::is_directory(name)) return name;
  const char* subjects = std::getenv("SUBJECTS_DIR");
  if (subjects != nullptr && fs::is_directory(fs::path(subjects) / name))
    return fs::path(subjects) / name;
  throw InvalidInput("template '" + name +
                     "': neither a folder nor a subject in $SUBJECTS_DIR; name a folder with "
                     "lh.sphere.reg, lh.sulc and lh.curv");
}

Eigen::VectorXd readMap(Context& context, const std::string& path, Eigen::Index count) {
  context.input(path);
  return io::readVertexMaps(path, count).front().values;
}

void requireAboutOrigin(const TriangleMesh& mesh, const std::string& path) {
  constexpr double kRound = 0.02;  // of the radius: spheres of registration are rounder
  const Eigen::VectorXd radii = mesh.positions.rowwise().norm();
  if (radii.minCoeff() >= (1 - kRound) * radii.maxCoeff()) return;
  throw InvalidInput("'" + path + "': not a sphere about the origin (radii " +
                     std::to_string(radii.minCoeff()) + " to " + std::to_string(radii.maxCoeff()) +
                     "); explica sphere makes one");
}

}  // namespace

FoldingFiles subjectFiles(const std::string& sphere, const std::string& structure,
                          const std::optional<std::string>& sulc,
                          const std::optional<std::string>& curvature,
                          const std::optional<std::string>& folder) {
  const fs::path place = folder ? fs::path(*folder) : fs::path(sphere).parent_path();
  const auto find = [&](const std::optional<std::string>& named, const std::string& freeSurfer,
                        const std::string& gifti, const std::string& option) {
    if (named) return *named;
    auto names = namesOf(structure, freeSurfer, gifti);
    names.push_back(gifti);
    if (const auto found = findFile(place, names)) return *found;
    throw InvalidInput("'" + sphere + "': no " + names[0] + " or " + gifti + " in '" +
                       place.string() + "'; name the map by --" + option +
                       " or its folder by --surfaces");
  };
  return {sphere,
          find(sulc, "sulc", "sulc.shape.gii", "sulc"),
          find(curvature, "curv", "curvature.shape.gii", "curvature"),
          {},
          {}};
}

FoldingFiles templateFiles(const std::string& name, const std::string& structure) {
  const fs::path folder = templateFolder(name);
  const auto find = [&](const std::vector<std::string>& names) {
    if (const auto found = findFile(folder, names)) return *found;
    throw InvalidInput("template '" + folder.string() + "': no " + names.front() + " in it");
  };
  FoldingFiles files;
  files.sphere = find(sphereNames(structure));
  files.sulc = find(namesOf(structure, "sulc", "sulc.shape.gii"));
  files.curvature = find(namesOf(structure, "curv", "curvature.shape.gii"));
  files.sulcSd = findFile(folder, namesOf(structure, "sulc_sd", "sulc_sd.shape.gii")).value_or("");
  files.curvatureSd =
      findFile(folder, namesOf(structure, "curv_sd", "curvature_sd.shape.gii")).value_or("");
  return files;
}

sphere::FoldingSphere readFolding(Context& context, const FoldingFiles& files) {
  context.input(files.sphere);
  io::SurfaceReadOptions reading;
  reading.space = io::SurfaceSpace::Scanner;  // spheres have a frame of their own
  sphere::FoldingSphere folding;
  folding.sphere = io::readSurface(files.sphere, reading).mesh;
  sphere::requireSphere(folding.sphere, files.sphere);
  requireAboutOrigin(folding.sphere, files.sphere);
  if (geometry::enclosedVolume(folding.sphere) < 0)
    folding.sphere.faces.col(1).swap(folding.sphere.faces.col(2));
  const sphere::OneToOne mended = sphere::makeOneToOne(folding.sphere);
  if (mended.turnedAfter > 0) {
    throw InvalidInput("'" + files.sphere + "': " + std::to_string(mended.turnedAfter) +
                       " faces are turned over, so that it is no map; explica sphere makes one");
  }
  if (mended.turnedBefore > 0) {
    context.warn("'" + files.sphere + "': " + std::to_string(mended.turnedBefore) +
                 " faces are turned over; " + std::to_string(mended.moved.size()) +
                 " vertices were moved to mend that");
  }
  const Eigen::Index count = folding.sphere.vertexCount();
  folding.sulc = readMap(context, files.sulc, count);
  folding.curvature = readMap(context, files.curvature, count);
  if (!files.sulcSd.empty()) folding.sulcSd = readMap(context, files.sulcSd, count);
  if (!files.curvatureSd.empty()) folding.curvatureSd = readMap(context, files.curvatureSd, count);
  return folding;
}

}  // namespace explica::app
