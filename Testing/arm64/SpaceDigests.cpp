// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Digests of what two processors must agree on in space: Laplace's equation and trajectories in a
// shell, distances, intersections, collisions and repulsion of surfaces, factorisation.

#include "Digest.h"
#include "Explica/Collision/CollisionScene.h"
#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/Geodesic.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Harmonic/Interpolant.h"
#include "Explica/Phantom/Shell.h"
#include "Explica/Repulsion/KnotEnergy.h"

namespace {

using namespace explica;
using explica::testing::Digest;

template <class Values>
void printValues(const char* name, const Values& values) {
  Digest digest;
  for (const double value : values) digest.add(value);
  digest.print(name);
}

void printThickness() {
  phantom::ShellOptions options;
  options.size = 40;
  const phantom::Shell shell = phantom::makeShell(options);
  harmonic::LabelRoles roles;
  roles.inner = {phantom::Shell::kInner};
  roles.tissue = {phantom::Shell::kTissue};
  const harmonic::Annulus annulus = harmonic::annulusFromLabels(shell.labels, roles);
  const harmonic::Interpolant u = harmonic::solveInterpolant(annulus);
  printValues("harmonic", u.u);
  std::printf("harmonic-iterations %d\n", u.iterations);
  const auto thickness = correspondence::findCorrespondences(annulus, u);
  printValues("thickness", correspondence::thicknessOf(thickness));
}

void printSurfaces() {
  const TriangleMesh folded = geometry::makeFoldedSphere(4, 30.0);
  printValues("folded-sphere", folded.positions.reshaped());
  const geometry::MeshTopology topology =
      geometry::buildTopology(folded.faces, folded.vertexCount());
  const std::int32_t source[] = {0};
  printValues("geodesic", geometry::geodesicDistances(folded, topology, source));

  const TriangleMesh crossed = geometry::joined(
      geometry::makeIcosphere(3, 10.0), geometry::makeIcosphere(3, 10.0, Point(19.8, 0.3, 0.2)));
  Digest pairs;
  for (const auto& pair : geometry::findSelfIntersections(crossed)) {
    pairs.add(pair[0]);
    pairs.add(pair[1]);
  }
  pairs.print("self-intersections");

  const std::vector<bool> moving(static_cast<std::size_t>(folded.vertexCount()), true);
  const collision::CollisionScene scene(folded, moving);
  const Positions motion = -0.4 * folded.positions.array().sin().matrix() * 10;
  const auto meetings = scene.findMeetings(folded.positions, motion, 0.5);
  Digest met;
  for (const auto& meeting : meetings) {
    met.add(meeting.separation);
    met.add(meeting.closing);
  }
  met.print("meetings");
  std::printf("meetings-count %zu\n", meetings.size());
  Digest step;
  step.add(collision::largestSafeStep(scene, meetings, folded.positions, motion));
  step.print("safe-step");

  const TriangleMesh small = geometry::makeFoldedSphere(3, 30.0);
  const std::vector<bool> all(static_cast<std::size_t>(small.vertexCount()), true);
  for (const auto& [name, method] : {std::pair{"knot-all-pairs", repulsion::KnotMethod::AllPairs},
                                     std::pair{"knot-tree", repulsion::KnotMethod::Tree}}) {
    const auto value = repulsion::makeKnotEnergy(method, small, all)->evaluate(small.positions);
    printValues(name, value.gradient.reshaped());
    std::printf("%s-value %.12g\n", name, value.value);
  }
}

}  // namespace

int main() {
  printThickness();
  printSurfaces();
}
