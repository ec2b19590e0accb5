// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "QuickRuns.h"
#include "RealSurfaces.h"

#include "Explica/Core/Results.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"
#include "Explica/Testing/DepthBuffer.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Testing/Stops.h"
#include "Explica/Unfolding/Region.h"

#include <gtest/gtest.h>

#include <csignal>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

TEST_F(RealSurfaces, FixedSurroundingsOnTheAverageCortex) {
  const TemporaryFolder folder;
  auto words = unfoldAbout(average(), Vector(-1, 0.2, 0.2), 25, "fixed");
  words.insert(words.end(),
               {"--target-visibility", "0.97", "--frames", "6", "--out", folder / "out"});
  const auto result = explica(words);
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["region_faces"], 902);
  EXPECT_NEAR(summary["visibility_initial"], 0.356, 0.001);
  EXPECT_GE(summary["visibility_final"], 0.97);
  EXPECT_LE(summary["area_error_mean"], 0.003);
  EXPECT_LE(summary["edge_strain_mean"], 0.11);
  EXPECT_EQ(summary["self_intersections_initial"], 0);
  EXPECT_EQ(summary["self_intersections_final"], 0);
  EXPECT_EQ(summary["self_intersections_frames_max"], 0);
  EXPECT_GT(summary["seen_final"], summary["seen_initial"]);
  // The file itself, read back: the whole surface, exactly tested, its surroundings untouched.
  const TriangleMesh after = io::readSurface(folder / "out/unfolded.surf.gii").mesh;
  EXPECT_EQ(after.vertexCount(), 10242);
  EXPECT_TRUE(geometry::findSelfIntersections(after).empty());
  // A rasteriser with a depth buffer sees what the ray caster saw, before and after.
  const TriangleMesh before = io::readSurface(average()).mesh;
  unfolding::RegionOptions where;
  where.vertex = std::stoi(words[3]);
  const auto region = unfolding::selectRegion(before, where);
  Point eye = Point::Zero();
  for (const std::int32_t v : region.vertices) eye += before.positions.row(v).transpose();
  eye =
      eye / static_cast<double>(region.vertices.size()) + 1000 * Vector(-1, 0.2, 0.2).normalized();
  for (const auto& [mesh, key] : {std::pair{before, "seen_initial"}, {after, "seen_final"}}) {
    const double share = seenShare(mesh, region.faces, renderFaces(mesh, eye, 3000));
    EXPECT_NEAR(summary[key].get<double>(), share, 0.005) << key;
  }
  for (int n = 0; n < 6; ++n) {
    EXPECT_TRUE(fs::exists(folder / ("out/frames/frame-000" + std::to_string(n) + ".surf.gii")));
  }
}

TEST_F(RealSurfaces, ADetachedPatchOfTheAverageCortexOpensFurther) {
  const TemporaryFolder folder;
  auto words = unfoldAbout(average(), Vector(-1, 0, 0), 40, "none");
  words.insert(words.end(), {"--target-visibility", "0.99", "--out", folder / "out"});
  ASSERT_EQ(explica(words).exitCode, 0);
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["region_faces"], 2254);
  EXPECT_GE(summary["visibility_final"], 0.99);
  EXPECT_LE(summary["area_error_mean"], 0.003);
  EXPECT_LE(summary["edge_strain_mean"], 0.08);
  EXPECT_EQ(summary["self_intersections_final"], 0);
}

std::vector<std::string> onFoldedSphere(const TemporaryFolder& folder) {
  const std::string surface = folder / "sphere.surf.gii";
  if (!fs::exists(surface)) {
    io::writeSurface(surface, geometry::makeFoldedSphere(4, 30.0));
  }
  return {"unfold", surface, "--center", "0,0,30", "--radius", "15", "--direction", "0,0,1"};
}

TEST(UnfoldCommand, SaysHowLongTheExactKnotEnergyTakes) {
  const TemporaryFolder folder;
  writeFoldedSphere(folder);
  CommandSetting setting;
  setting.signal = SIGTERM;
  setting.signalWhen = "pairs of faces, about ";
  const auto told =
      explica({"unfold", folder / "sphere.surf.gii", "--center", "0,0,30", "--radius", "12",
               "--direction", "0,0,1", "--knot", "all-pairs", "--out", folder / "out"},
              setting);
  EXPECT_EQ(told.exitCode, 3) << told;
  EXPECT_NE(told.err.find("pairs of faces, about "), std::string::npos) << told;
}

TEST(UnfoldCommand, ResumedRunsWriteTheBytesOfUninterruptedOnes) {
  const TemporaryFolder folder;
  auto words = onFoldedSphere(folder);
  auto whole = words, part = words;
  whole.insert(whole.end(), {"--max-iterations", "9", "--out", folder / "whole"});
  part.insert(part.end(), {"--max-iterations", "4", "--out", folder / "part"});
  EXPECT_EQ(explica(whole).exitCode, 3);
  EXPECT_EQ(explica(part).exitCode, 3);
  words.insert(words.end(), {"--max-iterations", "9", "--resume", "--out", folder / "part"});
  EXPECT_EQ(explica(words).exitCode, 3);
  for (const char* name : {"unfolded.surf.gii", "visibility.shape.gii", "distortion.shape.gii"}) {
    EXPECT_EQ(readText(folder / ("whole/" + std::string(name))),
              readText(folder / ("part/" + std::string(name))))
        << name;
  }
}

/// A patch of few faces by one thread, so that checks come in one order.
std::vector<std::string> onSmallSphere(const TemporaryFolder& folder) {
  io::writeSurface(folder / "sphere.surf.gii", geometry::makeFoldedSphere(4, 30.0));
  return {"unfold",    folder / "sphere.surf.gii",
          "--center",  "0,0,30",
          "--radius",  "25",
          "--threads", "1",
          "--out",     folder / "a"};
}

/// The surface as it stood is no result.
TEST(UnfoldCommand, AStopBeforeTheFirstIterationLeavesNothing) {
  TemporaryFolder folder;
  const std::vector<std::string> words = onSmallSphere(folder);
  const long first = firstCheckThatLeaves("summary.json", words, folder / "a");
  const auto stopped = explica(words, stopAtCheck(first));
  EXPECT_TRUE(isInterrupted(stopped)) << stopped;
  EXPECT_EQ(readJson(folder / "a/summary.json")["iterations"], 1);
}

TEST(UnfoldCommand, AStopWithinAStepGivesItUpAndTheRunGoesOnToTheSameBytes) {
  TemporaryFolder folder;
  const std::vector<std::string> words = onSmallSphere(folder);
  std::vector<std::string> again = words;
  again.push_back("--resume");
  const int end = explica(words).exitCode;
  const std::string whole = readText(folder / "a/unfolded.surf.gii");
  const long first = firstCheckThatLeaves("summary.json", words, folder / "a");
  for (const long later : {1, 40}) {
    std::filesystem::remove_all(folder / "a");
    const auto stopped = explica(words, stopAtCheck(first + later));
    EXPECT_TRUE(isInterrupted(stopped)) << stopped;
    EXPECT_EQ(readJson(folder / "a/summary.json")["iterations"], 1);
    EXPECT_EQ(explica(again).exitCode, end);
    EXPECT_EQ(readText(folder / "a/unfolded.surf.gii"), whole);
  }
}

TEST(UnfoldCommand, WritesEveryFileArrayAndKeyThatOthersRelyOn) {
  const TemporaryFolder folder;
  for (const std::string surround : {"fixed", "none"}) {
    const fs::path out = folder / surround;
    const auto result = explica(onFoldedSphere(folder) +
                                std::vector<std::string>{"--surround", surround, "--frames", "2",
                                                         "--max-iterations", "3", "--out", out});
    ASSERT_EQ(result.exitCode, 3) << result;
    const auto summary = readJson(out / "summary.json");
    for (const char* key : {"region_faces",
                            "region_vertices",
                            "region_area",
                            "visibility_initial",
                            "visibility_final",
                            "seen_initial",
                            "seen_final",
                            "backfacing_initial",
                            "backfacing_final",
                            "area_error_mean",
                            "area_error_max",
                            "edge_strain_mean",
                            "edge_strain_p95",
                            "angle_error_mean_deg",
                            "self_intersections_initial",
                            "self_intersections_final",
                            "iterations",
                            "seconds",
                            "seconds_per_iteration",
                            "seconds_start",
                            "seconds_visibility",
                            "seconds_repulsion",
                            "seconds_collision",
                            "seconds_solve",
                            "seconds_output",
                            "viewpoint",
                            "viewpoint_weights",
                            "flux_variance_initial",
                            "flux_variance_final",
                            "real_visibility_initial",
                            "real_visibility_final",
                            "surround",
                            "crossings_with_rest",
                            "collar_faces",
                            "flag",
                            "stop_reason"}) {
      EXPECT_TRUE(summary.contains(key)) << key;
    }
    const std::string table = readText(out / "evolution.tsv");
    const std::string header = table.substr(0, table.find('\n'));
    for (const char* column : {"iteration",
                               "phase",
                               "visibility",
                               "area_error_mean",
                               "area_error_max",
                               "edge_strain_mean",
                               "energy_visibility",
                               "energy_area",
                               "energy_spring",
                               "energy_lift",
                               "energy_guide",
                               "energy_collar",
                               "energy_overhang",
                               "energy_contact",
                               "energy_knot",
                               "objective_before",
                               "objective_after",
                               "contacts",
                               "nearest_contact",
                               "safe_step",
                               "step",
                               "largest_move",
                               "damping",
                               "solves",
                               "seconds_visibility",
                               "seconds_repulsion",
                               "seconds_collision",
                               "seconds_solve",
                               "seconds"}) {
      EXPECT_NE(("\t" + header + "\t").find("\t" + std::string(column) + "\t"), std::string::npos)
          << column;
    }
    // The start and three iterations, each with a value in every column.
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 1 + 1 + 3);
    EXPECT_EQ(std::count(table.begin(), table.end(), '\t'),
              5 * std::count(header.begin(), header.end(), '\t'));

    const auto namesOf = [&](const std::string& file) {
      std::vector<std::string> names;
      for (const auto& map : io::readVertexMaps(out / file)) names.push_back(map.name);
      return names;
    };
    using Names = std::vector<std::string>;
    const Names flux = {"flux before", "flux after", "seen before", "seen after"};
    const Names change = {"area ratio", "angle change", "edge strain"};
    EXPECT_EQ(namesOf("visibility.shape.gii"), flux);
    EXPECT_EQ(namesOf("distortion.shape.gii"), change);
    const auto all = io::readSurface(out / "unfolded.vtp");
    Names names;
    for (const auto& map : all.maps) names.push_back(map.name);
    EXPECT_EQ(names, flux + change + Names{"region"});
    const std::string vtp = readText(out / "unfolded.vtp");
    const std::string ofFaces =
        vtp.substr(vtp.find("<CellData"), vtp.find("</CellData>") - vtp.find("<CellData"));
    for (const char* name : {"area ratio", "angle change", "seen before", "seen after"}) {
      EXPECT_NE(ofFaces.find("\"" + std::string(name) + "\""), std::string::npos) << name;
    }
    const auto whole = io::readSurface(folder / "sphere.surf.gii").mesh;
    const auto unfolded = io::readSurface(out / "unfolded.surf.gii").mesh;
    EXPECT_EQ(unfolded.vertexCount(), whole.vertexCount());
    EXPECT_EQ(unfolded.faceCount(),
              surround == "none" ? summary["region_faces"].get<int>() : whole.faceCount());
    EXPECT_EQ(all.mesh.faceCount(), unfolded.faceCount());
    for (const char* name : {"region.label.gii", "intersections.tsv", "provenance.json",
                             "frames/frame-0000.surf.gii", "frames/frame-0001.surf.gii"}) {
      EXPECT_TRUE(fs::exists(out / name)) << name;
    }
  }
}

/// A folded sphere with one vertex pushed through its neighbours, inside the region or away from
/// it.
std::string writePierced(const TemporaryFolder& folder, const Point& about) {
  TriangleMesh mesh = geometry::makeFoldedSphere(4, 30.0);
  Eigen::Index nearest = 0;
  (void)(mesh.positions.rowwise() - about.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  const Vector up = about.normalized();
  const auto across = [&](const Vector& axis) { return (axis - axis.dot(up) * up).normalized(); };
  mesh.positions.row(nearest) +=
      (8 * across(Vector::UnitX()) + 5 * across(Vector::UnitY()) - 4 * up).transpose();
  io::writeSurface(folder / "pierced.surf.gii", mesh);
  return folder / "pierced.surf.gii";
}

TEST(UnfoldCommand, IntersectionsOfTheStartAreListedAndNeverMadeWorse) {
  for (const Point& about : {Point(0, 0, 30), Point(0, 0, -30)}) {
    const TemporaryFolder folder;
    const std::string surface = writePierced(folder, about);
    const auto before = geometry::findSelfIntersections(io::readSurface(surface).mesh);
    ASSERT_FALSE(before.empty());
    const auto result =
        explica({"unfold", surface, "--center", "0,0,30", "--radius", "15", "--direction", "0,0,1",
                 "--max-iterations", "8", "--no-repair", "--out", folder / "out"});
    ASSERT_EQ(result.exitCode, 3) << result;
    const auto summary = readJson(folder / "out/summary.json");
    EXPECT_EQ(summary["self_intersections_initial"], before.size());
    EXPECT_EQ(summary["self_intersections_new"], 0);
    EXPECT_EQ(summary["self_intersections_initial_region"] > 0, about.z() > 0);
    const auto after =
        geometry::findSelfIntersections(io::readSurface(folder / "out/unfolded.surf.gii").mesh);
    EXPECT_TRUE(std::includes(before.begin(), before.end(), after.begin(), after.end()));
    std::istringstream table(readText(folder / "out/intersections.tsv"));
    std::string line;
    std::getline(table, line);
    for (const geometry::FacePair& pair : before) {
      std::int32_t f = -1, g = -1;
      table >> f >> g;
      std::getline(table, line);
      EXPECT_EQ((geometry::FacePair{f, g}), pair);
      EXPECT_EQ(line.substr(line.size() - 2), "no");
    }
  }
}

TEST(UnfoldCommand, RepairPartsThemAndSaysHowFarVerticesMoved) {
  for (const Point& about : {Point(0, 0, 30), Point(0, 0, -30)}) {
    const TemporaryFolder folder;
    const std::string surface = writePierced(folder, about);
    const auto result =
        explica({"unfold", surface, "--center", "0,0,30", "--radius", "15", "--direction", "0,0,1",
                 "--max-iterations", "8", "--repair", "--out", folder / "out"});
    ASSERT_EQ(result.exitCode, 3) << result;
    const auto summary = readJson(folder / "out/summary.json");
    EXPECT_EQ(summary["self_intersections_repaired"], summary["self_intersections_initial"]);
    EXPECT_EQ(summary["self_intersections_final"], 0);
    EXPECT_GT(summary["repair_move_max"], 0);
    EXPECT_LT(summary["repair_move_max"], 12);  // the vertex was thrown 10 mm
    EXPECT_NE(result.err.find("parted by moving"), std::string::npos);
    const auto record = readText(folder / "out/provenance.json");
    EXPECT_NE(record.find("\"repair\": true"), std::string::npos);
    EXPECT_NE(record.find("parted by moving"), std::string::npos);
  }
}

TEST(UnfoldCommand, AReaderComputesTheSameNumbersFromTheFiles) {
  // Nothing crosses; a face of the region does; one of the collar does.
  for (const Point& about : {Point(0, 0, -30), Point(0, 0, 30), Point(19, 0, 23)}) {
    const TemporaryFolder folder;
    const bool crosses = about.z() > 0;
    const std::string surface =
        crosses ? writePierced(folder, about) : std::string(onFoldedSphere(folder)[1]);
    const auto run =
        explica({"unfold", surface, "--center", "0,0,30", "--radius", "15", "--direction", "0,0,1",
                 "--max-iterations", "8", "--out", folder / "out"});
    ASSERT_EQ(run.exitCode, 3) << run;
    const auto check = [&] {
      return runProgram({EXPLICA_PYTHON, EXPLICA_SOURCE_DIR "/Testing/commands/check_unfold.py",
                         surface, folder / "out"});
    };
    const auto told = check();
    EXPECT_EQ(told.exitCode, 0) << told;
    auto summary = readJson(folder / "out/summary.json");
    EXPECT_EQ(summary["reference"], crosses ? "reference.surf.gii" : "SURFACE");
    EXPECT_EQ(fs::exists(folder / "out/reference.surf.gii"), crosses);
    if (!crosses) continue;
    EXPECT_TRUE(
        geometry::findSelfIntersections(io::readSurface(folder / "out/reference.surf.gii").mesh)
            .empty());
    summary["reference"] = "SURFACE";
    writeText(folder / "out/summary.json", summary.dump());
    EXPECT_EQ(check().exitCode, 1) << "the surface as it was read is no reference";
  }
}

TEST(UnfoldCommand, ByDefaultOnlyCrossingsInTheWayAreParted) {
  for (const Point& about : {Point(0, 0, 30), Point(0, 0, -30)}) {
    const TemporaryFolder folder;
    const std::string surface = writePierced(folder, about);
    const auto result =
        explica({"unfold", surface, "--center", "0,0,30", "--radius", "15", "--direction", "0,0,1",
                 "--max-iterations", "3", "--out", folder / "out"});
    ASSERT_EQ(result.exitCode, 3) << result;
    const auto summary = readJson(folder / "out/summary.json");
    const bool inTheWay = about.z() > 0;
    EXPECT_EQ(summary["self_intersections_repaired"] > 0, inTheWay);
    EXPECT_EQ(summary["self_intersections_final"] == 0, inTheWay);
    EXPECT_EQ(summary["self_intersections_new"], 0);
  }
}

TEST(UnfoldCommand, ByDefaultThePatchIsSeenAlongItsMeanNormal) {
  const TemporaryFolder folder;
  const std::string surface = onFoldedSphere(folder)[1];
  const auto result = explica({"unfold", surface, "--center", "15.4,-7.7,18.6", "--radius", "9",
                               "--max-iterations", "2", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 3) << result;
  const TriangleMesh mesh = io::readSurface(surface).mesh;
  const auto label = io::readVertexLabels(folder / "out/region.label.gii", mesh.vertexCount());
  const auto inside = [&](Eigen::Index v) { return label.keys[v] != 0; };
  Vector normal = Vector::Zero();
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const auto [a, b, c] = std::tuple(mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2));
    if (!inside(a) || !inside(b) || !inside(c)) continue;
    const Vector at = mesh.positions.row(a);
    normal +=
        (mesh.positions.row(b).transpose() - at).cross(mesh.positions.row(c).transpose() - at);
  }
  const auto view = readJson(folder / "out/summary.json")["viewpoint"];
  const Vector seen = Vector(view[0], view[1], view[2]).normalized();
  EXPECT_GT(seen.dot(normal.normalized()), std::cos(2.0 * kPi / 180));  // from the centroid
}

TEST(UnfoldCommand, APatchIsSeenFromOutsideWhicheverWayFacesRun) {
  const TemporaryFolder folder;
  const std::string surface = onFoldedSphere(folder)[1];
  TriangleMesh mesh = io::readSurface(surface).mesh;
  mesh.faces.col(1).swap(mesh.faces.col(2));
  io::writeSurface(folder / "turned.surf.gii", mesh);
  std::vector<nlohmann::ordered_json> found;
  for (const std::string& file : {surface, folder / "turned.surf.gii"}) {
    const auto result = explica({"unfold", file, "--center", "15.4,-7.7,18.6", "--radius", "9",
                                 "--max-iterations", "2", "--force", "--out", folder / "out"});
    ASSERT_EQ(result.exitCode, 3) << result;
    found.push_back(readJson(folder / "out/summary.json"));
  }
  for (const char* key : {"visibility_initial", "visibility_final", "seen_final"}) {
    EXPECT_NEAR(found[0][key].get<double>(), found[1][key].get<double>(), 1e-4) << key;
  }
}

TEST(UnfoldCommand, ARegionThatFacesAllWaysNeedsADirection) {
  const TemporaryFolder folder;
  const TriangleMesh ball = geometry::makeIcosphere(3, 20.0);
  io::writeSurface(folder / "ball.surf.gii", ball);
  Eigen::VectorXi belt(ball.vertexCount());
  for (Eigen::Index v = 0; v < belt.size(); ++v) belt[v] = std::abs(ball.positions(v, 2)) < 8;
  io::writeGiftiLabel(folder / "belt.label.gii", {"belt", belt, {{0, "rest", {}}, {1, "belt", {}}}},
                      "Other");
  const auto result = explica({"unfold", folder / "ball.surf.gii", "--label",
                               folder / "belt.label.gii", "--out", folder / "out"});
  EXPECT_EQ(result.exitCode, 2) << result;
  EXPECT_NE(result.err.find("normals cancel out"), std::string::npos) << result;
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(UnfoldCommand, ByDefaultThePatchStaysInPlaceAndItsCollarIsAccountedFor) {
  const TemporaryFolder folder;
  const auto result =
      explica(onFoldedSphere(folder) + std::vector<std::string>{"--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["surround"], "elastic");
  EXPECT_EQ(summary["flag"], "");
  EXPECT_EQ(summary["crossings_with_rest"], 0);
  EXPECT_EQ(summary["viewpoint"].size(), 3u);
  EXPECT_GT(summary["viewpoint"][2], 1000);
  // The end says what came out.
  const std::string visibility = "Average visibility " +
                                 readable(summary["visibility_initial"].get<double>()) + " -> " +
                                 readable(summary["visibility_final"].get<double>()) + "\n";
  EXPECT_NE(result.err.find(visibility), std::string::npos) << visibility << result;
  // The numbers are those of the per-face map that is written.
  const TriangleMesh before = io::readSurface(folder / "sphere.surf.gii").mesh;
  const TriangleMesh after = io::readSurface(folder / "out/unfolded.surf.gii").mesh;
  const Eigen::VectorXd areas0 = geometry::faceAreas(before), areas1 = geometry::faceAreas(after);
  const auto label = io::readVertexLabels(folder / "out/region.label.gii", before.vertexCount());
  double sum = 0, largest = 0, count = 0;
  for (Eigen::Index f = 0; f < before.faceCount(); ++f) {
    bool moves = false, inRegion = true;
    for (int k = 0; k < 3; ++k) {
      moves = moves || before.corner(f, k) != after.corner(f, k);
      inRegion = inRegion && label.keys[before.faces(f, k)] == 1;
    }
    if (!moves || inRegion) continue;
    sum += areas1[f] / areas0[f];
    largest = std::max(largest, areas1[f] / areas0[f]);
    count += 1;
  }
  EXPECT_EQ(summary["collar_faces"], count);
  EXPECT_NEAR(summary["collar_stretch_mean"], sum / count, 1e-6);
  EXPECT_NEAR(summary["collar_stretch_max"], largest, 1e-6);
  EXPECT_LE(largest, 8);
}

TEST(UnfoldCommand, ARingThatStretchesBesideFixedSurroundingsIsSaid) {
  const TemporaryFolder folder;
  const auto result =
      explica(onFoldedSphere(folder) +
              std::vector<std::string>{"--surround", "fixed", "--out", folder / "out"});
  const auto summary = readJson(folder / "out/summary.json");
  ASSERT_GT(summary["collar_stretch_max"], 8);
  ASSERT_GT(summary["collar_stretch_mean"], 2);
  EXPECT_NE(result.err.find("around the region are stretched to more than 8 times"),
            std::string::npos)
      << result;
}

TEST(UnfoldCommand, ADetachedPatchIsComparedWithTheSurfaceThatItCameFrom) {
  const TemporaryFolder folder;
  const auto result =
      explica(onFoldedSphere(folder) +
              std::vector<std::string>{"--surround", "none", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["self_intersections_final"], 0);
  EXPECT_GT(summary["crossings_with_rest"], 0);  // laid flat it is wider than its hole
  EXPECT_FALSE(summary.contains("collar_stretch_mean"));
}

TEST(UnfoldCommand, FarFromTheOriginNothingIsLost) {
  const TemporaryFolder folder;
  const auto words = onFoldedSphere(folder);
  TriangleMesh mesh = io::readSurface(words[1]).mesh;
  mesh.positions.rowwise() += Eigen::RowVector3d(1e5, -1e5, 1e5);
  io::writeSurface(folder / "far.surf.gii", mesh);
  ASSERT_EQ(explica(words + std::vector<std::string>{"--out", folder / "near"}).exitCode, 0);
  ASSERT_EQ(explica({"unfold", folder / "far.surf.gii", "--center", "100000,-100000,100030",
                     "--radius", "15", "--direction", "0,0,1", "--out", folder / "far"})
                .exitCode,
            0);
  const auto near = readJson(folder / "near/summary.json");
  const auto far = readJson(folder / "far/summary.json");
  EXPECT_EQ(far["region_faces"], near["region_faces"]);
  EXPECT_EQ(far["self_intersections_new"], 0);
  EXPECT_EQ(far["flag"], "");
  EXPECT_NEAR(far["visibility_final"], near["visibility_final"].get<double>(), 0.005);
}

TEST(UnfoldCommand, WhatTheThesisMethodLetsCrossIsSaid) {
  const TemporaryFolder folder;
  explica({"phantom", "folds", "--edge", "2.5", "--length", "60", "--waves", "3", "--out",
           folder / "folds"});
  const auto result =
      explica({"unfold", folder / "folds/folds.surf.gii", "--label",
               folder / "folds/region.label.gii", "--direction", "0,0,1", "--surround", "fixed",
               "--method", "thesis", "--max-iterations", "50", "--out", folder / "out"});
  EXPECT_EQ(result.exitCode, 3) << result;
  const auto summary = readJson(folder / "out/summary.json");
  const auto pairs =
      geometry::findSelfIntersections(io::readSurface(folder / "out/unfolded.surf.gii").mesh);
  ASSERT_GT(pairs.size(), 0u);
  EXPECT_EQ(summary["self_intersections_new"], pairs.size());
  EXPECT_EQ(summary["flag"], "crossing");
  EXPECT_NE(summary["stop_reason"], "converged");
  EXPECT_NE(result.err.find("intersect in what is written"), std::string::npos);
}

TEST(UnfoldCommand, LooksFromSeveralDirections) {
  const TemporaryFolder folder;
  auto words = onFoldedSphere(folder);
  const auto made =
      explica(words + std::vector<std::string>{"--direction", "0,0.3,1", "--out", folder / "out"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["viewpoint"].size(), 6u);
  EXPECT_EQ(summary["viewpoint_weights"], Json::parse("[0.5, 0.5]"));
  EXPECT_GT(summary["visibility_final"], summary["visibility_initial"]);
  EXPECT_LT(summary["flux_variance_final"], summary["flux_variance_initial"]);
  // What arrives is at most what is seen, and the flux estimates it.
  EXPECT_LE(summary["real_visibility_final"], summary["seen_final"]);
  EXPECT_NEAR(summary["real_visibility_final"], summary["visibility_final"], 0.02);
  EXPECT_EQ(readJson(folder / "out/provenance.json")["options"]["direction"].size(), 2u);
  EXPECT_EQ(explica({"replay", folder / "out", "--out", folder / "again"}).exitCode, 0);
}

TEST(UnfoldCommand, OpensFoldsThatHideEachOther) {
  const TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "folds", "--out", folder / "folds"}).exitCode, 0);
  const auto made =
      explica({"unfold", folder / "folds/folds.surf.gii", "--label",
               folder / "folds/region.label.gii", "--direction", "0,0,1", "--out", folder / "out"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_NEAR(summary["visibility_initial"], 0.2, 0.01);
  EXPECT_LT(summary["seen_initial"], 0.4);
  EXPECT_GT(summary["visibility_final"], 0.99);
  EXPECT_GT(summary["seen_final"], 0.99);
  EXPECT_EQ(summary["self_intersections_final"], 0);
  EXPECT_LT(summary["area_error_mean"], 0.003);
}

TEST(UnfoldCommand, RefusesWhatCannotBeUnfoldedAndSaysWhy) {
  const TemporaryFolder folder;
  const auto words = onFoldedSphere(folder);
  const std::string& surface = words[1];
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"unfold", surface});
    more.insert(more.end(), {"--out", folder / "out"});
    return explica(more);
  };
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--center", "0,0,30", "--radius", "500", "--direction", "0,0,1"}, "whole closed surface"},
      {{"--center", "0,0,30", "--radius", "0.001", "--direction", "0,0,1"}, "no face"},
      {{"--center", "0,0,30", "--radius", "15", "--viewpoint", "0,0,1"}, "inside the surface"},
      {{"--center", "0,0,30", "--radius", "15", "--direction", "0,0,-1"}, "average visibility"},
      {{"--vertex", "999999", "--direction", "0,0,1"}, "none of the surface's vertices"}};
  for (const auto& [options, reason] : cases) {
    const auto result = run(options);
    EXPECT_EQ(result.exitCode, 2) << result;
    EXPECT_NE(result.err.find(reason), std::string::npos) << reason << "\n" << result.err;
  }
}

// ---- inputs that are readable and wrong; each row is one thing that happens to a sound sheet ----

/// A corrugated sheet of 20 x 20 mm, vertex (i, j) at row 21 j + i.
TriangleMesh makeCorrugated() {
  TriangleMesh mesh = geometry::makeRectangle(20, 20, 20, 20);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    mesh.positions(v, 2) = 3 * std::sin(0.6 * mesh.positions(v, 0));
  }
  return mesh;
}
Eigen::Index vertexAt(const TriangleMesh& mesh, double x, double y) {
  Eigen::Index nearest = 0;
  (void)(mesh.positions.leftCols<2>().rowwise() - Eigen::RowVector2d(x, y))
      .rowwise()
      .squaredNorm()
      .minCoeff(&nearest);
  return nearest;
}

struct WrongInput {
  std::string name;
  std::function<void(TriangleMesh&)> damage;
  std::vector<std::string> options;
  std::string reason;              ///< part of the sentence
  std::string file = "sheet.off";  ///< that it names; empty: the command line itself is wrong
};
void PrintTo(const WrongInput& row, std::ostream* stream) {
  *stream << row.name;
}

const std::vector<std::string> kDisc = {"--center", "10,10,0", "--radius", "7"};
std::vector<std::string> onDisc(std::vector<std::string> more) {
  more.insert(more.begin(), kDisc.begin(), kDisc.end());
  return more;
}
void nothing(TriangleMesh&) {}

const WrongInput kWrongInputs[] = {
    {"RadiusNegative",
     nothing,
     {"--center", "10,10,0", "--radius", "-3", "--direction", "0,0,1"},
     "above 0",
     ""},
    {"RegionEmpty",
     nothing,
     {"--center", "10,10,0", "--radius", "0.1", "--direction", "0,0,1"},
     "no face has all three vertices"},
    {"VertexUnknown", nothing, {"--vertex", "441", "--direction", "0,0,1"}, "0 to 440"},
    {"VertexOfNoFace",
     [](TriangleMesh& mesh) {
       mesh.positions.conservativeResize(442, 3);
       mesh.positions.row(441) << 50, 50, 50;
     },
     {"--vertex", "441", "--direction", "0,0,1"},
     "belongs to no face"},
    {"TwoViews", nothing, onDisc({"--direction", "0,0,1", "--viewpoint", "0,0,99"}),
     "give one of --viewpoint"},
    {"DirectionZero", nothing, onDisc({"--direction", "0,0,0"}), "direction"},
    {"DistanceNegative", nothing, onDisc({"--direction", "0,0,1", "--distance", "-5"}), "above 0",
     ""},
    {"ViewpointOnTheSurface", nothing, onDisc({"--viewpoint", "0,0,0"}), "on the surface"},
    {"ViewedFromBehind", nothing, onDisc({"--direction", "0,0,-1"}), "average visibility"},
    {"ConeTooWide", nothing, onDisc({"--cone", "120", "--direction", "0,0,1"}), "cone"},
    {"TargetAboveOne", nothing, onDisc({"--direction", "0,0,1", "--target-visibility", "1.5"}),
     "above 0, at most 1", ""},
    {"FramesNegative", nothing, onDisc({"--direction", "0,0,1", "--frames", "-1"}), "0 to 1000",
     ""},
    {"IterationsZero", nothing, onDisc({"--direction", "0,0,1", "--max-iterations", "0"}),
     "not within 1 to", ""},
    {"TimeNegative", nothing, onDisc({"--direction", "0,0,1", "--max-time", "-1"}), "above 0", ""},
    {"TooManyFrames", nothing, onDisc({"--direction", "0,0,1", "--frames", "1000000000"}),
     "0 to 1000", ""},
    {"CentreFarFromTheSurface",
     nothing,
     {"--center", "10,10,480", "--radius", "7", "--direction", "0,0,1"},
     "mm from the surface"},
    {"BeyondSinglePrecision",
     [](TriangleMesh& mesh) { mesh.positions.col(0).array() += 3e6; },
     {"--vertex", "220", "--radius", "7", "--direction", "0,0,1"},
     "single precision"},
    {"FaceWithoutArea",
     [](TriangleMesh& mesh) {  // a face whose corners lie on one line
       mesh.positions.row(vertexAt(mesh, 9, 9)) << 9, 9, 0;
       mesh.positions.row(vertexAt(mesh, 10, 9)) << 10, 9, 0;
       mesh.positions.row(vertexAt(mesh, 10, 10)) << 11, 9, 0;
     },
     onDisc({"--direction", "0,0,1"}), "zero area"},
    {"VerticesCoincide",
     [](TriangleMesh& mesh) {
       const Eigen::Index from = vertexAt(mesh, 12, 12);
       mesh.positions.row(from) = mesh.positions.row(vertexAt(mesh, 3, 10)).eval();
     },
     onDisc({"--direction", "0,0,1", "--no-repair"}), "weld coincident vertices"},
    {"EdgeOfThreeFaces",
     [](TriangleMesh& mesh) {
       mesh.faces.conservativeResize(mesh.faceCount() + 1, 3);
       mesh.faces.bottomRows<1>() << mesh.faces(0, 0), mesh.faces(0, 1), 400;
     },
     onDisc({"--direction", "0,0,1"}), "manifold"},
    {"FaceTurned", [](TriangleMesh& mesh) { std::swap(mesh.faces(300, 0), mesh.faces(300, 1)); },
     onDisc({"--direction", "0,0,1"}), "oriented against each other"},
    {"LabelOfAnotherSurface",
     nothing,
     {"--label", "{folder}/short.label.gii", "--direction", "0,0,1"},
     "440 values, but the surface has 441 vertices",
     "short.label.gii"},
    {"FreeSurferLabelOfAnotherSurface",
     nothing,
     {"--label", "{folder}/far.label", "--direction", "0,0,1"},
     "another surface's label",
     "far.label"},
    {"LabelEmpty",
     nothing,
     {"--label", "{folder}/none.label.gii", "--direction", "0,0,1"},
     "0 everywhere"},
    {"LabelKeyAbsent",
     nothing,
     {"--label", "{folder}/two.label.gii", "--label-key", "7", "--direction", "0,0,1"},
     "no vertex has key 7"},
    {"ValuesThatAreNoLabels",
     nothing,
     {"--label", "{folder}/values.shape.gii", "--direction", "0,0,1"},
     "labels are needed",
     "values.shape.gii"},
    {"MapNowhereAbove",
     nothing,
     {"--label", "{folder}/values.shape.gii", "--above", "1", "--direction", "0,0,1"},
     "its largest value is 0.5"},
    {"KeysAndNames",
     nothing,
     {"--label", "{folder}/two.label.gii", "--label-key", "1,in", "--direction", "0,0,1"},
     "give keys, or names",
     ""},
    {"NameAbsent",
     nothing,
     {"--label", "{folder}/two.label.gii", "--label-key", "insula", "--direction", "0,0,1"},
     "insula"},
};

io::LabelMap labelsOf(Eigen::Index count, const std::function<bool(int, int)>& inside) {
  io::LabelMap label{"region", {}, {{0, "out", {1, 1, 1, 1}}, {1, "in", {1, 0, 0, 1}}}};
  label.keys.setZero(count);
  for (int v = 0; v < count; ++v) label.keys[v] = inside(v % 21, v / 21);
  return label;
}

/// Two rectangles apart from each other; their left one is a FreeSurfer label too.
void writeLabels(const TemporaryFolder& folder) {
  const auto two = [](int i, int j) {
    return j >= 3 && j <= 16 && ((i >= 2 && i <= 8) || (i >= 12 && i <= 18));
  };
  io::writeGiftiLabel(folder / "two.label.gii", labelsOf(441, two), "");
  io::writeGiftiLabel(folder / "short.label.gii", labelsOf(440, two), "");
  io::writeGiftiLabel(folder / "none.label.gii", labelsOf(441, [](int, int) { return false; }), "");
  io::writeGiftiLabel(folder / "ring.label.gii",
                      labelsOf(441,
                               [](int i, int j) {
                                 const double r = std::hypot(i - 10, j - 10);
                                 return r >= 3 && r <= 8;
                               }),
                      "");
  io::writeGiftiShape(
      folder / "values.shape.gii",
      std::vector<io::VertexMap>{{"values", "", Eigen::VectorXd::Constant(441, 0.5)}}, "");
  io::writeGiftiShape(
      folder / "active.shape.gii",
      std::vector<io::VertexMap>{{"z", "", 3 * labelsOf(441, two).keys.cast<double>()}}, "");
  for (const bool right : {false, true}) {
    std::string lines = "#!ascii label\n98\n";
    for (int v = 0; v < 441; ++v) {
      if (two(v % 21, v / 21) && (v % 21 > 8) == right) lines += std::to_string(v) + " 0 0 0 1\n";
    }
    writeText(folder / (right ? "right.label" : "left.label"), lines);
  }
  writeText(folder / "far.label", "#!ascii label\n1\n9999 0 0 0 1\n");
}

class WrongUnfoldInput : public ::testing::TestWithParam<WrongInput> {};

TEST_P(WrongUnfoldInput, IsRefusedWithItsReasonAndWritesNothing) {
  const TemporaryFolder folder;
  TriangleMesh mesh = makeCorrugated();
  GetParam().damage(mesh);
  io::writeSurface(folder / "sheet.off", mesh);
  writeLabels(folder);
  std::vector<std::string> words = {"unfold", folder / "sheet.off", "--quiet", "--out",
                                    folder / "out"};
  for (std::string word : GetParam().options) {
    if (word.rfind("{folder}", 0) == 0) word = folder / word.substr(9);
    words.push_back(word);
  }
  const auto result = explica(words);
  EXPECT_EQ(result.exitCode, GetParam().file.empty() ? 1 : 2) << result;
  EXPECT_NE(result.err.find(GetParam().reason), std::string::npos) << result;
  EXPECT_NE(result.err.find(GetParam().file), std::string::npos) << result;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

INSTANTIATE_TEST_SUITE_P(Table, WrongUnfoldInput, ::testing::ValuesIn(kWrongInputs),
                         [](const auto& row) { return row.param.name; });

/// Regions of every kind on the sound sheet: what is selected, and that it unfolds untorn.
struct RegionKind {
  std::string name;
  std::vector<std::string> options;
  int pieces;
  int holes;
};
void PrintTo(const RegionKind& row, std::ostream* stream) {
  *stream << row.name;
}

const RegionKind kRegionKinds[] = {
    {"Euclidean", {"--center", "10,10,0", "--radius", "7"}, 1, 0},
    {"Geodesic", {"--center", "10,10,0", "--radius", "7", "--metric", "geodesic"}, 1, 0},
    {"Cone", {"--center", "10,10,0", "--radius", "20", "--cone", "0.4"}, 1, 0},
    {"GiftiLabelOfTwoPieces", {"--label", "{folder}/two.label.gii"}, 2, 0},
    {"GiftiLabelWithAHole", {"--label", "{folder}/ring.label.gii", "--label-key", "1"}, 1, 1},
    {"FreeSurferLabel", {"--label", "{folder}/left.label"}, 1, 0},
    {"SeveralFiles", {"--label", "{folder}/left.label", "--label", "{folder}/right.label"}, 2, 0},
    {"SeveralKeys", {"--label", "{folder}/two.label.gii", "--label-key", "9,1"}, 2, 0},
    {"MapAboveAValue", {"--label", "{folder}/active.shape.gii", "--above", "2.5"}, 2, 0},
};

class UnfoldRegion : public ::testing::TestWithParam<RegionKind> {};

TEST_P(UnfoldRegion, IsSelectedReportedAndUnfolded) {
  const TemporaryFolder folder;
  io::writeSurface(folder / "sheet.off", makeCorrugated());
  writeLabels(folder);
  for (const std::string surround : {"fixed", "elastic", "none"}) {
    std::vector<std::string> words = {
        "unfold", folder / "sheet.off", "--direction", "0,0,1", "--surround",
        surround, "--max-iterations",   "6",           "--out", folder / surround};
    for (std::string word : GetParam().options) {
      if (word.rfind("{folder}", 0) == 0) word = folder / word.substr(9);
      words.push_back(word);
    }
    const auto result = explica(words);
    ASSERT_TRUE(result.exitCode == 0 || result.exitCode == 3) << result;
    const auto summary = readJson(folder / (surround + "/summary.json"));
    EXPECT_EQ(summary["region_pieces"], GetParam().pieces);
    EXPECT_EQ(summary["region_holes"], GetParam().holes);
    EXPECT_GT(summary["visibility_final"], summary["visibility_initial"]) << surround;
    EXPECT_EQ(summary["self_intersections_final"], 0) << surround;
    EXPECT_EQ(result.err.find("pieces") != std::string::npos, GetParam().pieces > 1);
    EXPECT_EQ(result.err.find("hole") != std::string::npos, GetParam().holes > 0);
    const auto before = io::readVertexLabels(folder / (surround + "/region.label.gii"), 441);
    EXPECT_EQ((before.keys.array() == 1).count(), summary["region_vertices"]);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, UnfoldRegion, ::testing::ValuesIn(kRegionKinds),
                         [](const auto& row) { return row.param.name; });

TEST(UnfoldCommand, TouchingPartsUnfoldOnceTheyAreRepaired) {
  const TemporaryFolder folder;
  TriangleMesh mesh = makeCorrugated();
  mesh.positions.row(vertexAt(mesh, 12, 12)) = mesh.positions.row(vertexAt(mesh, 3, 10)).eval();
  io::writeSurface(folder / "sheet.off", mesh);
  const auto result = explica({"unfold", folder / "sheet.off", "--center", "10,10,0", "--radius",
                               "7", "--direction", "0,0,1", "--max-iterations", "8", "--repair",
                               "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 3) << result;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["self_intersections_final"], 0);
  EXPECT_GT(summary["visibility_final"], summary["visibility_initial"].get<double>() + 0.1);
}

TEST(UnfoldCentre, GivenInFreeSurfersOtherFrameIsNamed) {
  TemporaryFolder folder;
  // A ball in a volume whose middle is not the scanner's origin, as in every FreeSurfer subject.
  Grid grid;
  grid.size = {64, 64, 64};
  grid.direction << -1, 0, 0, 0, 0, 1, 0, -1, 0;  // as FreeSurfer's conformed volumes
  grid.origin = Point(38, -14, 32);
  Volume<Label> labels(grid, 0);
  const Point middle(6, 18, 0);
  for (std::size_t n = 0; n < labels.size(); ++n) {
    const auto [i, j, k] = grid.subscripts(n);
    const double r = (grid.toWorld(Vector(i, j, k)) - middle).norm();
    labels[n] = r < 20 ? 2 : (r < 24 ? 1 : 0);
  }
  io::writeVolume(folder / "seg.nii.gz", labels);
  const auto made = explica({"surface", folder / "seg.nii.gz", "--white-label", "2", "--grey-label",
                             "1", "--faces", "4000", "--out", folder / "s"});
  ASSERT_TRUE(made.exitCode == 0 || made.exitCode == 3) << made;
  const auto unfold = [&](const std::string& center) {
    return explica({"unfold", folder / "s/pial.surf.gii", "--center", center, "--radius", "8",
                    "--direction", "0,0,1", "--max-iterations", "1", "--out", folder / "u",
                    "--force"});
  };
  // The ball's top in scanner RAS is (6, 18, 24), in surface RAS (0, 0, 24).
  const auto right = unfold("6,18,24");
  EXPECT_TRUE(right.exitCode == 0 || right.exitCode == 3) << right;
  const auto mixed = unfold("0,0,24");
  EXPECT_EQ(mixed.exitCode, 2);
  EXPECT_NE(mixed.err.find("tkregister"), std::string::npos) << mixed;
  EXPECT_NE(mixed.err.find("6.00,18.00,24.00"), std::string::npos) << mixed;
  const auto lost = unfold("200,0,0");
  EXPECT_EQ(lost.exitCode, 2);
  EXPECT_NE(lost.err.find("mm from the surface"), std::string::npos) << lost;
  EXPECT_EQ(lost.err.find("tkregister"), std::string::npos) << lost;
}

TEST(UnfoldCommand, UnitsOfASurfaceDecideNothing) {
  const TemporaryFolder folder;
  const auto unfold = [&](double unit, double off) {
    io::writeSurface(folder / "s.surf.gii", geometry::makeFoldedSphere(3, 30 * unit));
    return explica({"unfold", folder / "s.surf.gii", "--center",
                    "0,0," + std::to_string((26.25 + off) * unit), "--radius",
                    std::to_string(12 * unit), "--direction", "0,0,1", "--out", folder / "u",
                    "--force"});
  };
  for (const double unit : {1e-3, 1.0, 1e3}) {
    const auto near = unfold(unit, 1.5);
    EXPECT_EQ(near.exitCode, 0) << unit << near;
    const double eye = readJson(folder / "u/summary.json")["viewpoint"][2];
    EXPECT_GT(eye, 200 * unit);  // well beyond the sphere, 60 wide
    const auto far = unfold(unit, 14);
    EXPECT_EQ(far.exitCode, 2) << unit << far;
    EXPECT_NE(far.err.find("mm from the surface"), std::string::npos) << far;
  }
}

}  // namespace
}  // namespace explica::testing
