# SPDX-FileCopyrightText: The Explica developers
# SPDX-License-Identifier: Apache-2.0
"""Breaks the code in some fifty places, one at a time, and asks whether a test notices.

    mutations.py [--only WORD]      needs a configured build/; leaves the sources as they were; EXPLICA_JOBS bounds
                                    the compilers at once
    mutations.py --check            only whether the code still has the places, each once

Each mutation is a small wrong step of the kind that people make: a sign, a factor, a bound, an index.  A
mutation counts as caught where an assertion failed or the program crashed, not where time ran out: one that
survives, or of which nothing is known after that time, names a test that is missing or too slow."""

import argparse
import os
import pathlib
import resource
import signal
import subprocess
import sys
from dataclasses import dataclass

ROOT = pathlib.Path(__file__).resolve().parents[1]
LONGEST = 300  # seconds of processor time of tests, far more than the chosen ones take


@dataclass
class Mutation:
    file: str
    right: str
    wrong: str
    program: str  # test program that must notice
    tests: str = "*"


ALL = [
    Mutation("Modules/Harmonic/src/MultigridCoarsening.cpp",
             "t_.coarsened[axis] ? 0.5F * conductance : conductance;",
             "t_.coarsened[axis] ? conductance : conductance;", "ExplicaHarmonicUnitTests"),
    Mutation("Modules/Harmonic/src/Stencil.cpp",
             "2 * inverseSquare[a] / (fractions[d] * (left + right));",
             "inverseSquare[a] / fractions[d];", "ExplicaHarmonicUnitTests"),
    Mutation("Modules/Correspondence/src/Layers.cpp",
             "share[n] = below / (below + above);", "share[n] = above / (below + above);",
             "ExplicaCorrespondenceUnitTests"),
    Mutation("Modules/Correspondence/src/CornerExtension.cpp",
             "sum.u += u_[from] + outward + 0.5 * second;", "sum.u += u_[from] + outward;",
             "ExplicaCorrespondenceUnitTests"),
    Mutation("Modules/Geometry/src/MeshMeasures.cpp",
             "return 0.5 * faceNormalVectors(mesh).rowwise().norm();",
             "return faceNormalVectors(mesh).rowwise().norm();", "ExplicaGeometryUnitTests"),
    Mutation("Modules/Visibility/src/FaceFlux.cpp",
             "moment += outward * 0.5 * (squaredLineDistance * logarithm + lq * r[next] - lp * r[k]);",
             "moment += outward * 0.5 * (squaredLineDistance * logarithm + lq * r[next] + lp * r[k]);",
             "ExplicaVisibilityUnitTests"),
    Mutation("Modules/Unfolding/src/energies/FaceTerms.cpp",
             "return face.weight * (now.multipliers[f] + strength * (ratio - 1)) * ratio;",
             "return face.weight * (now.multipliers[f] + strength * (ratio - 1));",
             "ExplicaUnfoldingUnitTests", "*Energ*:*Term*"),
    Mutation("Modules/Planar/src/PolygonVisibility.cpp",
             "result.variance += view.weights[p] * (squareFlux[p] / result.length - average * average);",
             "result.variance += view.weights[p] * (squareFlux[p] / result.length - average);",
             "ExplicaPlanarUnitTests"),
    Mutation("Modules/Repulsion/src/ClusterTree.cpp",
             "std::max(cluster.radius, (face.centre - cluster.centre).norm() + face.radius);",
             "std::max(cluster.radius, face.radius);",
             "ExplicaRepulsionUnitTests"),
    Mutation("Modules/Ventricle/src/Segments.cpp",
             "std::fmod(angleDeg - 15 + 360, 360)", "std::fmod(angleDeg + 360, 360)",
             "ExplicaVentricleUnitTests"),
    Mutation("Modules/Ventricle/include/Explica/Ventricle/Beat.h",
             "kMuscleDensity = 1.05", "kMuscleDensity = 1.5", "ExplicaVentricleUnitTests"),
    Mutation("Modules/Study/src/StudyTable.cpp",
             "0.6745 * (*number - median) / spread", "(*number - median) / spread",
             "ExplicaStudyUnitTests"),
    Mutation("Modules/Sampling/src/Depth.cpp",
             "static_cast<double>(i) / (*count - 1)", "static_cast<double>(i) / *count",
             "ExplicaSamplingUnitTests"),
    Mutation("Modules/Sampling/src/Sampler.cpp",
             "0.5F * (3 * t3 - 5 * t2 + 2)", "0.5F * (3 * t3 - 5 * t2 + 2 * t)",
             "ExplicaSamplingUnitTests"),
    Mutation("Modules/IO/src/NiftiFormat.cpp",
             "affine(axis, 3) = header.quaternion[axis + 3] * unit;",
             "affine(axis, 3) = header.quaternion[axis + 3] * unit * unit;", "ExplicaIOUnitTests"),
    Mutation("Modules/Flattening/src/MapEnergy.cpp",
             "density.dP = 4 * (p - 1) + 2 * p * slope;", "density.dP = 4 * (p - 1) + p * slope;",
             "ExplicaFlatteningUnitTests", "MapEnergy*"),
    Mutation("Modules/Maps/src/Folding.cpp",
             "-0.5 * product.row(v).dot(normals.row(v)) / areas[v]",
             "-product.row(v).dot(normals.row(v)) / areas[v]", "ExplicaMapsUnitTests"),
    Mutation("Modules/Collision/src/ContinuousCollision.cpp",
             "const double all = (distance - gap) / speed;",
             "const double all = 2 * (distance - gap) / speed;", "ExplicaCollisionUnitTests"),
    Mutation("Modules/Pipeline/src/Asymmetry.cpp",
             "(left - right) / (0.5 * (left + right))", "(left - right) / (left + right)",
             "ExplicaPipelineUnitTests"),
    Mutation("Modules/Segmentation/src/Plausibility.cpp",
             """"ml", 300, 2500""", """"ml", 300, 25000""", "ExplicaSegmentationUnitTests"),
    Mutation("Modules/Collision/src/ContinuousCollision.cpp",
             "const double room = *least > 0 ? *least : -*most;",
             "const double room = *least > 0 ? *least : *most;", "ExplicaCollisionUnitTests"),
    Mutation("Modules/Collision/src/ContinuousCollision.cpp",
             "if (staysApart(kind, now, then, gap)) return ahead;", "if (staysApart(kind, now, then, gap) && ahead < 0) return ahead;",
             "ExplicaCollisionUnitTests"),
    Mutation("Modules/Unfolding/src/Motion.cpp",
             "options.keptDistance = kTouching * contacts.range();", "options.keptDistance = 0;",
             "ExplicaUnfoldingUnitTests", "Motion.*"),
    Mutation("Modules/Unfolding/src/energies/OtherTerms.cpp",
             "const double slope = std::min(s - kHome, kFirm);", "const double slope = std::min(s - kHome, 100 * kFirm);",
             "ExplicaUnfoldingUnitTests", "Energy.AGuide*"),
    Mutation("Modules/Unfolding/src/Contacts.cpp",
             "constexpr double kHair = 0.003;", "constexpr double kHair = 0;",
             "ExplicaUnfoldingUnitTests", "*Hair*"),
    Mutation("Modules/Unfolding/src/Continuation.cpp",
             "std::sqrt(std::max(0.0, 1 - visibility) / (1 - aim))", "std::max(0.0, 1 - visibility) / (1 - aim)",
             "ExplicaUnfoldingUnitTests", "Steering.*"),
    Mutation("Modules/Unfolding/src/Continuation.cpp",
             "(kGoalStrain - strain) / options.trade", "(kGoalStrain - strain) * options.trade",
             "ExplicaUnfoldingUnitTests", "Steering.*"),
    Mutation("Modules/Unfolding/src/Continuation.cpp",
             "std::min(now.visibility, now.seen)", "std::max(now.visibility, now.seen)",
             "ExplicaUnfoldingUnitTests", "Continuation.*"),
    Mutation("Modules/Unfolding/src/Unfold.cpp",
             "return seen < kGoalSeen ? std::min(spare, seen - kGoalSeen) : spare;",
             "return seen < kGoalSeen ? std::max(spare, seen - kGoalSeen) : spare;",
             "ExplicaUnfoldingUnitTests", "Unfold.AState*"),
    Mutation("Modules/Correspondence/src/Field.h",
             "outcome == Outcome::Arrived || (walk.stuck && hop(walk, target, uphill));",
             "outcome == Outcome::Arrived;",
             "ExplicaCorrespondenceUnitTests", "Measurement.*"),
    Mutation("Modules/Correspondence/src/ImageEdge.cpp",
             "if (correspondence.missing > 0) markLeaving(", "if (false) markLeaving(",
             "ExplicaCorrespondenceUnitTests"),
    Mutation("Modules/Provenance/src/Verify.cpp",
             """found.sha256 == entry["sha256"] &&""", """true &&""",
             "ExplicaProvenanceUnitTests"),
    Mutation("Modules/Core/src/Grid.cpp",
             "m.topLeftCorner<3, 3>() = direction * spacing.asDiagonal();",
             "m.topLeftCorner<3, 3>() = spacing.asDiagonal() * direction;", "ExplicaCoreUnitTests"),
    Mutation("Applications/Common/src/Limits.cpp",
             "Clock::now() >= end_ - duration(secondsKept)", "Clock::now() >= end_",
             "ExplicaCommandTests", "TimeLimit.*"),
    Mutation("Modules/Inflation/src/DirectionField.cpp",
             "= reach * reach * geometry::cotangentLaplacian(mesh);",
             "= reach * geometry::cotangentLaplacian(mesh);",
             "ExplicaInflationUnitTests", "DirectionField.*"),
    Mutation("Modules/Phantom/src/BeatingVentricle.cpp",
             "const double angle = kPi + kRightHalf;", "const double angle = kPi - kRightHalf;",
             "ExplicaPhantomUnitTests", "BeatingVentricle.*"),
    Mutation("Modules/Harmonic/src/Phantoms.cpp",
             "(1 / a - 1 / r) / (1 / a - 1 / b)", "(r - a) / (b - a)",
             "ExplicaPhantomUnitTests", "ShellPhantom.*"),
    Mutation("Modules/Registration/src/Filters.cpp",
             "const double inVoxels = sigma / volume.grid.spacing[axis];",
             "const double inVoxels = sigma / volume.grid.spacing[0];", "ExplicaRegistrationUnitTests"),
    Mutation("Modules/Registration/src/Filters.cpp",
             "if (s - radius - 1 >= 0) sum -= in.col(s - radius - 1).cast<double>();",
             "if (s - radius >= 0) sum -= in.col(s - radius).cast<double>();", "ExplicaRegistrationUnitTests"),
    Mutation("Modules/Report/src/FlatFigure.cpp",
             "options.height / 2.0 - scale * (p.y() - camera.target.y())",
             "options.height / 2.0 + scale * (p.y() - camera.target.y())",
             "ExplicaReportUnitTests", "FlatFigure.*"),
    Mutation("Modules/Report/src/ColourMap.cpp",
             "(1 - f) * table_[e][c] + f * table_[e + 1][c]", "f * table_[e][c] + (1 - f) * table_[e + 1][c]",
             "ExplicaReportUnitTests", "Colour*"),
    Mutation("Modules/Shapes/src/HarmonicAnnulus.cpp",
             "row[n + k] = angular[k] * radial.outer;", "row[n + k] = -angular[k] * radial.outer;",
             "ExplicaShapesUnitTests"),
    Mutation("Modules/Shapes/src/AngularBasis.cpp",
             "if (degree == 0) return {1 - x, x};", "if (degree == 0) return {x, 1 - x};",
             "ExplicaShapesUnitTests"),
    Mutation("Modules/Viewer/src/Session.cpp",
             """options.emplace_back("max-iterations", std::to_string(number));""",
             """options.emplace_back("max-iterations", std::to_string(number + 1));""",
             "ExplicaViewerUnitTests"),
    Mutation("Modules/Viewer/src/Session.cpp",
             "checkpoint.history = history(number);",
             "checkpoint.history = history(number + 1);", "ExplicaViewerUnitTests"),
    Mutation("Modules/Surface/src/TopologyCorrection.cpp", "if (lost > filled) {", "if (lost < filled) {",
             "ExplicaSurfaceUnitTests", "TopologyCorrection*"),
    Mutation("Modules/Surface/src/CorticalTissue.cpp",
             "if (!near[v] || places.number[v] == medialWall) continue;",
             "if (!near[v] || places.number[v] != medialWall) continue;",
             "ExplicaSurfaceUnitTests", "*CortexThatWasAllTaken*"),
    Mutation("Modules/Surface/src/EdgeSearch.cpp", "<< arc - kPartial * size, size;", "<< arc + kPartial * size, size;",
             "ExplicaSurfaceUnitTests", "*PartVoxel*"),
]


def build(program):
    """Whether the program could be built."""
    jobs = ["-j", os.environ["EXPLICA_JOBS"]] if "EXPLICA_JOBS" in os.environ else []
    return subprocess.run(["ninja", "-C", str(ROOT / "build"), *jobs, program], check=False,
                          stdout=subprocess.DEVNULL, stderr=subprocess.STDOUT).returncode == 0


def places(mutation):
    return (ROOT / mutation.file).read_text(encoding="utf-8").count(mutation.right)


def fate(mutation):
    """What the tests make of the mutation; the file is put back in any case."""
    path = ROOT / mutation.file
    before = path.read_text(encoding="utf-8")
    try:
        path.write_text(before.replace(mutation.right, mutation.wrong), encoding="utf-8")
        if not build(mutation.program):
            return "DOES NOT COMPILE"
        tests = subprocess.run([str(ROOT / "build/bin" / mutation.program), "--gtest_brief=1",
                                "--gtest_fail_fast", f"--gtest_filter={mutation.tests}"],
                               check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU,
                                                                     (LONGEST, LONGEST)))
        if tests.returncode == -signal.SIGXCPU:
            return "OUT OF TIME"
        return "SURVIVES" if tests.returncode == 0 else "caught"
    finally:
        path.write_text(before, encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="mutations of files whose path holds the word")
    parser.add_argument("--check", action="store_true", help="whether the code still has the places")
    words = parser.parse_args()
    chosen = [m for m in ALL if words.only in m.file]
    if not chosen:
        parser.error(f"--only {words.only}: no mutation is of a file whose path has it")
    moved = [m for m in chosen if places(m) != 1]
    for mutation in moved:
        print(f"{mutation.file}: '{mutation.right}' stands {places(mutation)} times: follow the code with the mutation")
    if words.check or moved:
        return 1 if moved else 0
    survivors = []
    for mutation in chosen:
        end = fate(mutation)
        print(f"{end}: {mutation.file}: {mutation.wrong}", flush=True)
        if end != "caught":
            survivors.append(mutation)
    for program in sorted({m.program for m in chosen}):
        build(program)
    print(f"{len(chosen) - len(survivors)} of {len(chosen)} caught")
    return 1 if survivors else 0


sys.exit(main())
