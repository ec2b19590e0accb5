// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Sphere/SphereMap.h"
#include "Explica/Sphere/Summary.h"

namespace explica::app {
namespace {

struct SphereSettings {
  std::string surface;
  io::SurfaceReadOptions reading;
  sphere::SphereMapOptions map;
};

void declare(Declaration& d, SphereSettings& s) {
  d.synopsis("a closed surface one to one on a sphere, with little change of areas and shapes")
      .description(
          R"(Maps a closed surface without handles onto a sphere of 100 mm. Vertices are removed until a tetrahedron remains and are put back one by one, so that no face ever turns over; on several levels in between the map's energy is lowered: the mean over the surface of |J|^2 / (2 d) + w |d - 1/d| / 2, with J the linear map of a face, d its ratio of areas and w the --balance between areas and shapes; the absolute value, rounded at 0, keeps most areas as they are and lets few give way. The result is checked exactly in the single precision in which it is written. The sphere is rotated to agree with the surface's directions.)")
      .reference("Praun, Hoppe 2003, ACM Trans. Graphics 22(3):340-349")
      .reference("Shtengel et al. 2017, ACM Trans. Graphics 36(4):38")
      .example("explica sphere lh.white --out sphere", "sphere/lh.sphere, and as GIFTI")
      .input("SURFACE", FileKind::Surface, "closed surface of genus 0", s.surface)
      .options("Reading", s.reading)
      .options("Sphere", s.map)
      .output("sphere.surf.gii", FileKind::Surface, "the sphere, radius 100 mm")
      .output("?h.sphere", FileKind::Surface, "the same as FreeSurfer writes it")
      .output("distortion.shape.gii", FileKind::VertexData,
              "log2 of the ratio of areas; largest over smallest stretch")
      .output("evolution.tsv", FileKind::Table, "levels from coarse to fine: energy, iterations")
      .results<sphere::SphereSummary>();
}

std::string tableOf(const std::vector<sphere::SphereLevel>& levels) {
  std::string table = "level\tvertices\titerations\tenergy\n";
  for (std::size_t n = 0; n < levels.size(); ++n) {
    table += printed("%zu\t%lld\t%d\t%.9g\n", n, static_cast<long long>(levels[n].vertices),
                     levels[n].iterations, levels[n].energy);
  }
  return table;
}

void write(Context& context, const TriangleMesh& surface, const sphere::SphereMap& map,
           const sphere::SphereDistortion& distortion, io::SurfaceMetadata metadata) {
  const TriangleMesh sphere{map.positions, surface.faces};
  metadata.geometricType = "Spherical";
  metadata.topologicalType = "Closed";
  io::writeGiftiSurface(context.output("sphere.surf.gii"), sphere, metadata);
  const bool right = metadata.structure == "CortexRight";
  io::writeFreeSurferSurface(context.output(right ? "rh.sphere" : "lh.sphere"), sphere);
  io::writeGiftiShape(context.output("distortion.shape.gii"),
                      {{"areal log2", "", sphere::meansAtVertices(surface, distortion.arealLog2)},
                       {"stretch", "", sphere::meansAtVertices(surface, distortion.stretch)}},
                      metadata.structure);
  writeTextFile(context.output("evolution.tsv"), tableOf(map.levels));
}

Termination run(Context& context, const SphereSettings& s) {
  const auto loaded = readSurface(context, "SURFACE", s.surface, s.reading);
  sphere::requireSphere(loaded.mesh, s.surface);
  sayHowRead(context, loaded.origin);
  // A surface whose faces run clockwise keeps them, on a sphere that is mirrored no more than it.
  TriangleMesh surface = loaded.mesh;
  const bool inward = geometry::turnOutward(surface);
  sphere::SphereMap map;
  {
    auto step = context.step("map");
    map = sphere::mapToSphere(surface, s.map, context.monitor());
    step.iterations(map.iterations);
    step.termination(map.termination);
  }
  auto step = context.step("measure and write");
  const auto distortion = sphere::sphereDistortion(surface, map.positions);
  if (inward) surface.faces.col(1).swap(surface.faces.col(2));
  write(context, surface, map, distortion, loaded.metadata);
  const Termination end = distortion.turnedOver > 0 ? Termination::Stalled : map.termination;
  context.results(
      sphere::SphereSummary{distortion, map.rounding.moved.size(), map.iterations, end});
  return end;
}

}  // namespace

Command sphereCommand() {
  return makeCommand<SphereSettings>("sphere", declare, run);
}

}  // namespace explica::app
