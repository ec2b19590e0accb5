// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace explica::testing {

/// A small, quick use of a command, without --out.  {folder} stands for a folder in which `before`
/// has been run.
struct QuickRun {
  std::string name;
  std::vector<std::vector<std::string>> before;  ///< command lines that make its inputs
  std::vector<std::string> words;
  /// Writes inputs that no command makes.
  std::function<void(const TemporaryFolder&)> prepare = {};
};

/// A folded sphere of 30 mm, 1280 faces.
inline void writeFoldedSphere(const TemporaryFolder& folder) {
  io::writeSurface(folder / "sphere.surf.gii", geometry::makeFoldedSphere(3, 30.0));
}

/// A sphere with two folding maps beside it, named as FreeSurfer's.
inline void writeSphereWithFolds(const TemporaryFolder& folder) {
  const TriangleMesh sphere = geometry::makeIcosphere(3, 100.0);
  io::writeFreeSurferSurface(folder / "lh.sphere", sphere);
  const auto x = sphere.positions.col(0).array() / 100, y = sphere.positions.col(1).array() / 100,
             z = sphere.positions.col(2).array() / 100;
  io::writeFreeSurferCurv(folder / "lh.sulc", ((5 * x).sin() + 2 * y * z).matrix(), 1280);
  io::writeFreeSurferCurv(folder / "lh.curv", ((9 * z + x).cos() + y).matrix(), 1280);
}

/// A person as FreeSurfer has one: a folded surface with its sphere and folding maps.
inline void writePerson(const TemporaryFolder& folder) {
  writeSphereWithFolds(folder);
  io::writeSurface(folder / "white.surf.gii", geometry::makeFoldedSphere(3, 30.0));
  io::writeSurface(folder / "pial.surf.gii", geometry::makeFoldedSphere(3, 33.0));
}

/// The upper part of it, with a rim.
inline void writeFoldedCap(const TemporaryFolder& folder) {
  const TriangleMesh sphere = geometry::makeFoldedSphere(3, 30.0);
  std::vector<std::int32_t> faces;
  for (Eigen::Index f = 0; f < sphere.faceCount(); ++f) {
    if (sphere.corner(f, 0).z() > 5 && sphere.corner(f, 1).z() > 5 && sphere.corner(f, 2).z() > 5) {
      faces.push_back(static_cast<std::int32_t>(f));
    }
  }
  io::writeSurface(folder / "cap.surf.gii", geometry::extractFaces(sphere, faces).mesh);
}

/// Maps of ten people on a sphere, and what is known of them.
inline void writePeoplesMaps(const TemporaryFolder& folder) {
  const TriangleMesh sphere = geometry::makeIcosphere(2, 30.0);
  io::writeSurface(folder / "sphere.surf.gii", sphere);
  std::string maps = "participant_id\tfile\n", people = "participant_id\tage\tgroup\n";
  for (int person = 0; person < 10; ++person) {
    const std::string name = "sub-" + std::to_string(person);
    Eigen::VectorXd values(sphere.vertexCount());
    for (Eigen::Index v = 0; v < values.size(); ++v) {
      const double place = sphere.positions.row(v).sum() / 20 + person * 2.4;
      values[v] = 2.5 + 0.2 * std::sin(place * (1 + person % 3)) + (v < 12 ? 0.1 * person : 0);
    }
    io::writeGiftiShape(folder / (name + ".shape.gii"), {{"thickness", "mm", values}},
                        "CortexLeft");
    maps += name + "\t" + name + ".shape.gii\n";
    people += name + "\t" + std::to_string(20 + 5 * person) + (person % 2 == 0 ? "\ta\n" : "\tb\n");
  }
  writeText(folder / "maps.tsv", maps);
  writeText(folder / "people.tsv", people);
}

/// White and pial surface, a map and an electrode; two spheres that pass through each other.
inline void writeCortexAndMap(const TemporaryFolder& folder) {
  io::writeSurface(folder / "white.surf.gii", geometry::makeIcosphere(3, 10.0));
  io::writeSurface(folder / "pial.surf.gii", geometry::makeIcosphere(3, 14.0));
  io::writeSurface(folder / "crossed.surf.gii",
                   geometry::joined(geometry::makeIcosphere(3, 10.0),
                                    geometry::makeIcosphere(3, 10.0, Point(19.8, 0.3, 0.2))));
  Grid grid;
  grid.size = {24, 24, 24};
  grid.spacing = {1.3, 1.3, 1.3};
  grid.origin = {-15, -15, -15};
  Volume<float> map(grid);
  for (std::size_t v = 0; v < map.size(); ++v) map[v] = static_cast<float>(v % 101);
  io::writeVolume(folder / "map.nii.gz", map);
  writeText(folder / "points.tsv", "x\ty\tz\n0\t1\t12\n");
}

/// White and pial surface, a map and regions of the left hemisphere.
inline void writeMapAndRegions(const TemporaryFolder& folder) {
  writeCortexAndMap(folder);
  const Positions places = geometry::makeIcosphere(3, 10.0).positions;
  io::writeGiftiShape(folder / "thickness.shape.gii", {{"thickness", "mm", places.col(0)}},
                      "CortexLeft");
  io::LabelMap regions{"regions", {}, {{0, "unknown"}, {1, "front"}, {2, "back"}}};
  regions.keys =
      (places.col(1).array() > 3).cast<Label>() + 2 * (places.col(1).array() < -3).cast<Label>();
  io::writeGiftiLabel(folder / "lh.regions.label.gii", regions, "CortexLeft");
  io::writeSurface(folder / "sphere.reg.surf.gii", geometry::makeIcosphere(3, 10.0));
}

/// Labels of a left and a right side of the brain.
inline void writeSides(const TemporaryFolder& folder) {
  writeText(folder / "sides.nii.txt", "1 Frontal_Inf_L\n2 Frontal_Inf_R\n");
  Volume<Label> sides;
  sides.grid.size = {2, 2, 2};
  sides.grid.spacing = {60, 60, 60};
  sides.grid.origin = {-30, -30, -30};
  sides.data = {1, 2, 1, 2, 1, 2, 1, 2};
  io::writeVolume(folder / "sides.nii.gz", sides);
}

/// An ellipse about the origin, mm.
inline void writeEllipse(const std::string& file, double a, double b) {
  Positions2 polygon(120, 2);
  for (Eigen::Index v = 0; v < polygon.rows(); ++v) {
    const double t = 2 * kPi * static_cast<double>(v) / static_cast<double>(polygon.rows());
    polygon.row(v) << a * std::cos(t), b * std::sin(t);
  }
  io::writePolygonCsv(file, polygon);
}

inline void PrintTo(const QuickRun& run, std::ostream* stream) {
  *stream << run.name;
}

/// One row a command: tried for equal bytes with 1, 2 and 4 threads, replay, dry run and full disk.
inline const std::vector<QuickRun>& quickRuns() {
  const std::vector<std::string> kShell = {"phantom", "shell", "--size",
                                           "20",      "--out", "{folder}/shell"};
  static const std::vector<QuickRun> runs = {
      {"PhantomPolygon19", {}, {"phantom", "polygon19"}},
      {"PhantomPolygon34", {}, {"phantom", "polygon34"}},
      {"PhantomCortex", {}, {"phantom", "cortex", "--size", "32", "--spacing", "2"}},
      {"PhantomFolds", {}, {"phantom", "folds", "--edge", "2"}},
      {"PhantomEccentric", {}, {"phantom", "eccentric", "--size", "64"}},
      {"PhantomSpheroid", {}, {"phantom", "spheroid", "--size", "48", "--spacing", "2.7"}},
      {"PhantomVentricle", {}, {"phantom", "ventricle", "--size", "48", "--spacing", "2.7"}},
      {"PhantomShell", {}, {"phantom", "shell", "--size", "24"}},
      {"Cifti",
       {kShell,
        {"surface", "{folder}/shell/labels.nii.gz", "--white-label", "1", "--grey-label", "2",
         "--faces", "2000", "--out", "{folder}/surfaces"}},
       {"cifti", "--left", "{folder}/surfaces/thickness.shape.gii", "--right",
        "{folder}/surfaces/thickness.shape.gii"}},
      {"Embed",
       {{"phantom", "polygon19", "--out", "{folder}/p19"},
        {"polygon", "{folder}/p19/polygon.csv", "--out", "{folder}/c"}},
       {"embed", "{folder}/c/polygon.csv", "--center", "50,20,0", "--inner-radius", "2", "--order",
        "16", "--max-iterations", "4"}},
      {"PolygonPhantom", {}, {"polygon", "--phantom", "polygon34", "--frames", "3"}},
      {"Polygon",
       {{"phantom", "polygon19", "--out", "{folder}/p19"}},
       {"polygon", "{folder}/p19/polygon.csv", "--region", "0:19", "--viewpoint", "50.5,4000"}},
      {"Parcellate",
       {},
       {"parcellate", "{folder}", "--atlas", "{folder}/lh.regions.label.gii", "--volume"},
       writeMapAndRegions},
      {"Regions",
       {},
       {"regions", "{folder}", "--atlas", "{folder}/lh.regions.label.gii"},
       writeMapAndRegions},
      {"Resample",
       {},
       {"resample", "{folder}/thickness.shape.gii", "{folder}/lh.regions.label.gii", "--from",
        "{folder}/white.surf.gii", "--to", "fsaverage3"},
       writeMapAndRegions},
      {"Smooth",
       {},
       {"smooth", "{folder}/thickness.shape.gii", "--surface", "{folder}/white.surf.gii", "--fwhm",
        "6"},
       writeMapAndRegions},
      {"Repair", {}, {"repair", "{folder}/crossed.surf.gii", "--max-move", "5"}, writeCortexAndMap},
      {"Sample",
       {},
       {"sample", "{folder}/map.nii.gz", "--surfaces", "{folder}", "--depths", "5", "--points",
        "{folder}/points.tsv"},
       writeCortexAndMap},
      {"Segment",
       {kShell},
       {"segment", "{folder}/shell/level.nii.gz", "--template", "none", "--max-iterations", "4"}},
      {"Surface",
       {kShell},
       {"surface", "{folder}/shell/labels.nii.gz", "--white-label", "1", "--grey-label", "2",
        "--faces", "2000"}},
      {"Thickness",
       {kShell},
       {"thickness", "{folder}/shell/labels.nii.gz", "--inner", "1", "--tissue", "2", "--layers",
        "3"}},
      {"PhantomBeat",
       {},
       {"phantom", "ventricle", "--size", "64", "--spacing", "2", "--slice", "8", "--frames", "2"}},
      {"Heart",
       {{"phantom", "ventricle", "--size", "64", "--spacing", "2", "--slice", "8", "--frames", "2",
         "--out", "{folder}/beat"}},
       {"heart", "{folder}/beat/frame-0000.nii.gz", "{folder}/beat/frame-0001.nii.gz"},
       {}},
      {"Unfold",
       {},
       {"unfold", "{folder}/sphere.surf.gii", "--center", "0,0,30", "--radius", "12", "--direction",
        "0,0,1", "--max-iterations", "3"},
       writeFoldedSphere},
      {"Flatten", {}, {"flatten", "{folder}/cap.surf.gii", "--grid", "1"}, writeFoldedCap},
      {"FlattenCut",
       {},
       {"flatten", "{folder}/sphere.surf.gii", "--cuts", "auto", "--cut.strain", "0.2", "--grid",
        "2"},
       writeFoldedSphere},
      {"Compare",
       {},
       {"compare", "{folder}/sphere.surf.gii", "{folder}/sphere.surf.gii", "--pairs", "400",
        "--sources", "10"},
       writeFoldedSphere},
      {"Figure",
       {},
       {"figure", "{folder}/sphere.surf.gii", "--views", "lateral", "--size", "300"},
       writeFoldedSphere},
      {"Glm",
       {},
       {"glm", "{folder}/maps.tsv", "--table", "{folder}/people.tsv", "--model",
        "thickness ~ age + group", "--surface", "{folder}/sphere.surf.gii", "--permutations", "200",
        "--tfce", "--threshold", "0.05"},
       writePeoplesMaps},
      {"Inflate",
       {},
       {"inflate", "{folder}/sphere.surf.gii", "--max-iterations", "3", "--frames", "2"},
       writeFoldedSphere},
      {"Longitudinal",
       {{"phantom", "cortex", "--size", "32", "--spacing", "2", "--out", "{folder}/1"},
        {"phantom", "cortex", "--size", "32", "--spacing", "2", "--seed", "2", "--out",
         "{folder}/2"}},
       {"longitudinal", "{folder}/1/t1.nii.gz", "{folder}/2/t1.nii.gz", "--atlas",
        "{folder}/sides.nii.gz", "--hemisphere", "L", "--template", "none", "--surface.faces",
        "1000"},
       writeSides},
      {"Register",
       {},
       {"register", "{folder}/lh.sphere", "--to", "{folder}/lh.sphere", "--level", "3"},
       writeSphereWithFolds},
      {"Sphere", {}, {"sphere", "{folder}/sphere.surf.gii"}, writeFoldedSphere},
      {"Template",
       {},
       {"template", "{folder}", "{folder}", "--density", "fsaverage3", "--level", "3"},
       writePerson},
      {"Run",
       {kShell},
       {"run", "{folder}/shell/labels.nii.gz", "--kind", "labels", "--steps", "thickness,report",
        "--thickness.inner", "1", "--thickness.tissue", "2"},
       {}},
  };
  return runs;
}

/// Words with {folder} filled in.
inline std::vector<std::string> filled(std::vector<std::string> words,
                                       const TemporaryFolder& folder) {
  for (auto& word : words) {
    for (auto at = word.find("{folder}"); at != std::string::npos; at = word.find("{folder}")) {
      word.replace(at, 8, folder.path().string());
    }
  }
  return words;
}

inline std::vector<std::string> operator+(std::vector<std::string> words,
                                          const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// A quick run whose inputs are made; `words_` is its command line without --out.
class PreparedRun : public ::testing::TestWithParam<QuickRun> {
 protected:
  void SetUp() override {
    for (const auto& line : GetParam().before) {
      const auto made = explica(filled(line, folder_));
      ASSERT_TRUE(made.exitCode == 0 || made.exitCode == 3) << made;
    }
    if (GetParam().prepare) GetParam().prepare(folder_);
    words_ = filled(GetParam().words, folder_);
  }

  TemporaryFolder folder_;
  std::vector<std::string> words_;
};

}  // namespace explica::testing
