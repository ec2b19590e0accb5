// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/FoldingFiles.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Sphere/SphereMap.h"

#include <filesystem>
#include <vector>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

bool isRight(const std::string& structure) {
  return structure == "CortexRight";
}

std::vector<std::string> namesOf(const std::string& structure, const std::string& freeSurfer,
                                 const std::string& gifti) {
  const bool right = isRight(structure);
  return {(right ? "rh." : "lh.") + freeSurfer, (right ? "hemi-R_" : "hemi-L_") + gifti};
}

Eigen::VectorXd readMap(Context& context, const std::string& path, std::string_view role,
                        Eigen::Index count) {
  context.input(path, role);
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
    if (const auto found = findFile({place.string(), (place / "surf").string()}, names)) {
      return *found;
    }
    throw InvalidInput("'" + sphere + "': no " + names[0] + " or " + gifti + " in '" +
                       place.string() + "'; name the map by --" + option +
                       " or its folder by --surfaces");
  };
  FoldingFiles files;
  files.sphere = sphere;
  files.sulc = find(sulc, "sulc", "sulc.shape.gii", "sulc");
  files.curvature = find(curvature, "curv", "curvature.shape.gii", "curvature");
  return files;
}

sphere::FoldingSphere readFolding(Context& context, const FoldingFiles& files,
                                  std::string_view role) {
  context.input(files.sphere, role);
  sphere::FoldingSphere folding;  // spheres have a frame of their own
  folding.sphere = io::readSurface(files.sphere, {.space = io::SurfaceSpace::Scanner}).mesh;
  sphere::requireSphere(folding.sphere, files.sphere);
  requireAboutOrigin(folding.sphere, files.sphere);
  geometry::turnOutward(folding.sphere);
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
  folding.sulc = readMap(context, files.sulc, role, count);
  folding.curvature = readMap(context, files.curvature, role, count);
  if (!files.sulcSd.empty()) folding.sulcSd = readMap(context, files.sulcSd, role, count);
  if (!files.curvatureSd.empty())
    folding.curvatureSd = readMap(context, files.curvatureSd, role, count);
  return folding;
}

}  // namespace explica::app
