// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

// nibabel and Workbench read our files; we read nibabel's.  Both programs stand in
// Testing/packages.txt.

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/CiftiFile.h"
#include "Explica/IO/LabelNames.h"
#include "Explica/IO/PatchFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/FreeSurferLabel.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace explica;
namespace fs = std::filesystem;

struct Outcome {
  int status = -1;
  std::string text;
};

Outcome run(const std::string& command) {
  Outcome outcome;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> piece;
  for (std::size_t got = 0; (got = std::fread(piece.data(), 1, piece.size(), pipe)) > 0;) {
    outcome.text.append(piece.data(), got);
  }
  outcome.status = ::pclose(pipe);
  return outcome;
}

void nibabelAgrees(const std::string& check, const TemporaryFolder& folder) {
  const Outcome outcome =
      run(std::string(EXPLICA_PYTHON) + " '" + EXPLICA_IO_TEST_FOLDER +
          "/independent_readers.py' " + check + " '" + folder.path().string() + "'");
  ASSERT_EQ(outcome.status, 0) << outcome.text;
}

std::string workbench(const std::string& arguments) {
  const Outcome outcome = run("wb_command " + arguments);
  EXPECT_EQ(outcome.status, 0) << "wb_command " << arguments << "\n" << outcome.text;
  return outcome.text;
}

Grid obliqueGrid(bool leftHanded) {
  Grid grid;
  grid.size = {17, 13, 11};
  grid.spacing = {2.1, 3.3, 4.7};
  grid.direction = (Eigen::AngleAxisd(0.5, Vector(1, -2, 3).normalized()) *
                    Eigen::AngleAxisd(1.1, Vector::UnitZ()))
                       .toRotationMatrix();
  if (leftHanded) grid.direction.col(1) *= -1;
  grid.origin = {-31.7, 12.2, -8.9};
  return grid;
}

template <class T>
void putRaw(const fs::path& path, const T* values, Eigen::Index count) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(values),
             static_cast<std::streamsize>(count * sizeof(T)));
}

template <class T>
std::vector<T> getRaw(const fs::path& path) {
  const std::string bytes = contentOf(path);
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

/// What independent_readers.py is to find: shape, affine, values with i fastest.
void putExpected(const fs::path& path, const Grid& grid, const std::vector<double>& values,
                 int frames) {
  std::string text;
  for (const int n : grid.size) text += std::to_string(n) + " ";
  if (frames == 3 && path.extension() != ".mgh" && path.extension() != ".mgz") text += "1 ";
  if (frames > 1) text += std::to_string(frames);
  text += "\n";
  const Eigen::Matrix4d affine = grid.affine();
  char number[40];
  for (int i = 0; i < 16; ++i) {
    std::snprintf(number, sizeof(number), "%.17g ", affine(i / 4, i % 4));
    text += number;
  }
  putContent(path.string() + ".txt", text + "\n");
  putRaw(path.string() + ".raw", values.data(), static_cast<Eigen::Index>(values.size()));
}

struct Expected {
  std::array<int, 3> size;
  Eigen::Matrix4d affine;
  std::vector<double> values;
};

Expected getExpected(const fs::path& path) {
  Expected expected;
  std::ifstream in(path.string() + ".txt");
  for (int& n : expected.size) in >> n;
  std::string frames;
  std::getline(in, frames);  // the rest of the line
  for (int i = 0; i < 16; ++i) in >> expected.affine(i / 4, i % 4);
  expected.values = getRaw<double>(path.string() + ".raw");
  return expected;
}

TEST(Nibabel, ReadsOurVolumesWithEqualValuesAndPlaces) {
  const TemporaryFolder folder;
  for (const bool leftHanded : {false, true}) {
    const Grid grid = obliqueGrid(leftHanded);
    Volume<float> scalars(grid);
    Volume<Label> labels(grid);
    Volume<Eigen::Vector3f> vectors(grid, Eigen::Vector3f::Zero());
    std::vector<double> expectedVectors(3 * grid.voxelCount());
    for (std::size_t v = 0; v < scalars.size(); ++v) {
      scalars[v] = std::sin(static_cast<float>(v));
      labels[v] = static_cast<Label>(v % 301) - 3;
      vectors[v] = Eigen::Vector3f(scalars[v], static_cast<float>(v), -1);
      for (std::size_t c = 0; c < 3; ++c) {
        expectedVectors[c * grid.voxelCount() + v] = vectors[v][static_cast<Eigen::Index>(c)];
      }
    }
    for (const std::string extension : {".nii", ".nii.gz", ".mgh", ".mgz"}) {
      const std::string hand = leftHanded ? ".left" : ".right";
      const fs::path scalarFile = folder / ("scalars" + hand + extension);
      io::writeVolume(scalarFile, scalars);
      putExpected(scalarFile, grid, {scalars.data.begin(), scalars.data.end()}, 1);
      const fs::path labelFile = folder / ("labels" + hand + extension);
      io::writeVolume(labelFile, labels);
      putExpected(labelFile, grid, {labels.data.begin(), labels.data.end()}, 1);
      const fs::path vectorFile = folder / ("vectors" + hand + extension);
      io::writeVolume(vectorFile, vectors);
      putExpected(vectorFile, grid, expectedVectors, 3);
    }
  }
  nibabelAgrees("our_volumes", folder);
}

TEST(Nibabel, WritesVolumesThatWeReadWithEqualValuesAndPlaces) {
  const TemporaryFolder folder;
  nibabelAgrees("their_volumes", folder);
  int files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.path())) {
    const fs::path& path = entry.path();
    if (path.extension() == ".txt" || path.extension() == ".raw") continue;
    ++files;
    const Expected expected = getExpected(path);
    const io::LoadedVolume<float> read = io::readScalars(path);
    EXPECT_EQ(read.volume.grid.size, expected.size) << path;
    EXPECT_LT((read.volume.grid.affine() - expected.affine).cwiseAbs().maxCoeff(), 2e-5) << path;
    const std::vector<float> values(expected.values.begin(), expected.values.end());
    EXPECT_EQ(read.volume.data, values) << path;
  }
  EXPECT_EQ(files, 5 + 40 + 1);
}

/// A sphere that lies well inside obliqueGrid.
TriangleMesh sphereInside(const Grid& grid) {
  const Point centre =
      grid.toWorld(0.5 * Vector(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1));
  return geometry::makeIcosphere(3, 11.0, centre);
}

io::LabelMap someLabels(Eigen::Index count) {
  io::LabelMap labels;
  labels.name = "parts";
  labels.keys.setZero(count);
  for (Eigen::Index v = 0; v < count; v += 3) labels.keys[v] = 3;
  labels.table = {{0, "outside", {0, 0, 0, 0}}, {3, "in & out", {1, 0, 0.2F, 1}}};
  return labels;
}

io::SurfaceMetadata midThickness() {
  io::SurfaceMetadata metadata;
  metadata.structure = "CortexLeft";
  metadata.secondary = "MidThickness";
  return metadata;
}

TEST(Nibabel, ReadsOurSurfacesMapsAndLabels) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = sphereInside(obliqueGrid(false));
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(mesh.vertexCount(), -1, 2);
  const io::LabelMap labels = someLabels(mesh.vertexCount());
  io::writeGiftiSurface(folder / "a.surf.gii", mesh, midThickness());
  io::writeGiftiSurface(folder / "a.surf.gii.gz", mesh, midThickness());
  io::writeGiftiShape(folder / "a.shape.gii", {{"thickness", "mm", values}}, "CortexLeft");
  io::writeGiftiLabel(folder / "a.label.gii", labels, "CortexLeft");
  io::writeFreeSurferSurface(folder / "lh.white", mesh);
  io::writeFreeSurferCurv(folder / "lh.thickness", values, mesh.faceCount());
  io::writeFreeSurferAnnot(folder / "lh.parts.annot", labels);
  explica::test::writeFreeSurferLabel(folder / "lh.part.label", labels, mesh.positions);
  const auto marked = (labels.keys.array() != 0).eval();
  io::writePatch(folder / "lh.part.patch.3d", io::patchOf(mesh, {marked.begin(), marked.end()}));
  putRaw(folder / "positions.raw", mesh.positions.data(), mesh.positions.size());
  putRaw(folder / "faces.raw", mesh.faces.data(), mesh.faces.size());
  putRaw(folder / "values.raw", values.data(), values.size());
  putRaw(folder / "keys.raw", labels.keys.data(), labels.keys.size());
  nibabelAgrees("our_surfaces", folder);
}

TEST(Nibabel, WritesSurfacesMapsAndLabelsThatWeRead) {
  const TemporaryFolder folder;
  nibabelAgrees("their_surfaces", folder);
  const std::vector<double> positions = getRaw<double>(folder / "positions.raw");
  const std::vector<std::int32_t> faces = getRaw<std::int32_t>(folder / "faces.raw");
  int files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename().string();
    if (name.find(".surf.gii") == std::string::npos && name != "lh.plain") continue;
    ++files;
    const TriangleMesh mesh = io::readSurface(entry.path()).mesh;
    ASSERT_EQ(mesh.positions.size(), static_cast<Eigen::Index>(positions.size())) << name;
    ASSERT_EQ(mesh.faces.size(), static_cast<Eigen::Index>(faces.size())) << name;
    // nibabel writes six decimals as text.
    const double bound = name.starts_with("ASCII") ? 1e-5 : 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      ASSERT_NEAR(mesh.positions.data()[i], positions[i], bound) << name;
    }
    EXPECT_TRUE(std::equal(faces.begin(), faces.end(), mesh.faces.data())) << name;
  }
  EXPECT_EQ(files, 14);
  const std::vector<double> values = getRaw<double>(folder / "values.raw");
  const Eigen::VectorXd sulc = io::readVertexMaps(folder / "lh.sulc", 50).at(0).values;
  EXPECT_TRUE(std::equal(values.begin(), values.end(), sulc.data()));
  const std::vector<std::int32_t> keys = getRaw<std::int32_t>(folder / "keys.raw");
  const io::LabelMap labels = io::readVertexLabels(folder / "lh.parts.annot", 50);
  EXPECT_TRUE(std::equal(keys.begin(), keys.end(), labels.keys.data()));
  EXPECT_EQ(labels.table.at(2).name, "c");
}

TEST(Nibabel, AgreesOnRealData) {
  if (!fs::exists(EXPLICA_REAL_DATA)) GTEST_SKIP() << "skipped: no real data";
  const TemporaryFolder folder;
  putContent(folder / "data.txt", EXPLICA_REAL_DATA);
  nibabelAgrees("real_data", folder);
  const fs::path data(EXPLICA_REAL_DATA);
  const char* names[] = {"bert_freesurfer/mri/ribbon.mgz",
                         "lv_sunnybrook_SCD0000101/ED_label.nii.gz", "laynii_sc/sc_rim.nii.gz"};
  for (int i = 0; i < 3; ++i) {
    const Expected expected = getExpected(folder / ("volume" + std::to_string(i)));
    const io::LoadedVolume<Label> read = io::readLabels(data / names[i]);
    EXPECT_LT((read.volume.grid.affine() - expected.affine).cwiseAbs().maxCoeff(), 1e-4)
        << names[i];
    const bool equal =
        std::equal(expected.values.begin(), expected.values.end(), read.volume.data.begin(),
                   read.volume.data.end(), [](double a, Label b) { return a == b; });
    EXPECT_TRUE(equal) << names[i];
  }
  const TriangleMesh mesh = io::readSurface(data / "s1_pycortex_lh/wm_lh.gii").mesh;
  const std::vector<double> positions = getRaw<double>(folder / "positions.raw");
  const std::vector<std::int32_t> faces = getRaw<std::int32_t>(folder / "faces.raw");
  ASSERT_EQ(mesh.vertexCount(), 152893);
  EXPECT_TRUE(std::equal(positions.begin(), positions.end(), mesh.positions.data()));
  EXPECT_TRUE(std::equal(faces.begin(), faces.end(), mesh.faces.data()));
}

/// Both hemispheres of a sphere, without a cap each.
std::array<io::CiftiStructure, 2> hemispheres(const TriangleMesh& mesh) {
  return {io::ciftiStructure("CortexLeft", (mesh.positions.col(0).array() < 0.5).cast<double>()),
          io::ciftiStructure("CortexRight", (mesh.positions.col(0).array() > -0.5).cast<double>())};
}

void writeCifti(const TemporaryFolder& folder) {
  const TriangleMesh mesh = geometry::makeIcosphere(3, 1.0);
  const auto where = hemispheres(mesh);
  putRaw(folder / "left.raw", where[0].vertices.data(),
         static_cast<Eigen::Index>(where[0].vertices.size()));
  putRaw(folder / "right.raw", where[1].vertices.data(),
         static_cast<Eigen::Index>(where[1].vertices.size()));
  std::vector<io::CiftiPart> scalars, series;
  std::vector<io::CiftiLabels> labels;
  for (int side = 0; side < 2; ++side) {
    const Eigen::VectorXd number =
        1000.0 * (side + 1) + Eigen::VectorXd::LinSpaced(642, 0, 641).array();
    Eigen::VectorXd second = -number;
    if (side == 0) second[where[0].vertices.front()] = kNaN;
    scalars.push_back({where[side], {{"first", "", number}, {"in & out", "", second}}});
    series.push_back({where[side], {}});
    for (int frame = 0; frame < 5; ++frame) {
      series.back().maps.push_back({"", "", (number.array() + 0.25 * frame).matrix()});
    }
    const Label key = side == 0 ? 1024 : 2022;
    io::LabelMap map{"parts", {}, {*io::freeSurferEntry(key)}};
    map.keys.setConstant(642, key);
    labels.push_back({where[side], map});
  }
  io::ciftiScalars(scalars).write(folder / "a.dscalar.nii");
  io::ciftiSeries(series, 1.5).write(folder / "a.dtseries.nii");
  io::ciftiLabels(labels).write(folder / "a.dlabel.nii");
  EXPECT_THROW(io::ciftiScalars(scalars).write(folder / "b.nii"), InvalidInput);
  scalars[1].where.structure = "CortexLeft";
  EXPECT_THROW(io::ciftiScalars(scalars).write(folder / "b.dscalar.nii"), InvalidInput);
}

TEST(Nibabel, ReadsOurCifti) {
  const TemporaryFolder folder;
  writeCifti(folder);
  nibabelAgrees("our_cifti", folder);
}

void expectSays(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << "'" << words << "' not in\n" << text;
}

TEST(Workbench, AcceptsOurFilesWithStructureAndType) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = sphereInside(obliqueGrid(false));
  const auto file = [&folder](const char* name) { return (folder / name).string(); };
  io::writeGiftiSurface(folder / "a.surf.gii", mesh, midThickness());
  io::writeGiftiShape(folder / "a.shape.gii",
                      {{"thickness", "mm", Eigen::VectorXd::Ones(mesh.vertexCount())},
                       {"sulc", "", Eigen::VectorXd::Zero(mesh.vertexCount())}},
                      "CortexLeft");
  io::writeGiftiLabel(folder / "a.label.gii", someLabels(mesh.vertexCount()), "CortexLeft");

  const std::string surface = workbench("-file-information " + file("a.surf.gii"));
  expectSays(surface, "CortexLeft");
  expectSays(surface, "Anatomical");
  expectSays(surface, "Midthickness");  // as it prints MidThickness
  expectSays(surface, std::to_string(mesh.vertexCount()));
  const std::string shape = workbench("-file-information " + file("a.shape.gii"));
  expectSays(shape, "CortexLeft");
  expectSays(shape, "thickness");
  expectSays(shape, "sulc");
  const std::string label = workbench("-file-information " + file("a.label.gii"));
  expectSays(label, "CortexLeft");
  expectSays(label, "in & out");

  workbench("-surface-vertex-areas " + file("a.surf.gii") + " " + file("areas.shape.gii"));
  const Eigen::VectorXd areas =
      io::readVertexMaps(file("areas.shape.gii"), mesh.vertexCount())[0].values;
  const double total = geometry::faceAreas(mesh).sum();
  EXPECT_NEAR(areas.sum(), total, 1e-5 * total);
  workbench("-metric-smoothing " + file("a.surf.gii") + " " + file("a.shape.gii") + " 2 " +
            file("smooth.shape.gii"));
}

TEST(Workbench, FindsEachVertexAtTheRasThatOurVolumesTell) {
  // Three volumes whose values are RAS x, y, z: sampled at a vertex they give its coordinates back,
  // if grid, volume file and surface file agree about the world.  Trilinear sampling of a linear
  // function is exact; float32 at 60 mm leaves 4e-6.
  for (const bool leftHanded : {false, true}) {
    for (const std::string extension : {".nii.gz", ".nii"}) {
      const TemporaryFolder folder;
      const Grid grid = obliqueGrid(leftHanded);
      const TriangleMesh mesh = sphereInside(grid);
      io::writeGiftiSurface(folder / "a.surf.gii", mesh, midThickness());
      double worst = 0;
      for (int axis = 0; axis < 3; ++axis) {
        Volume<float> ras(grid);
        for (std::size_t v = 0; v < ras.size(); ++v) {
          const std::array<int, 3> at = grid.subscripts(v);
          ras[v] = static_cast<float>(grid.toWorld(Vector(at[0], at[1], at[2]))[axis]);
        }
        const std::string volume = (folder / ("ras" + extension)).string();
        io::writeVolume(volume, ras);
        workbench("-volume-to-surface-mapping " + volume + " " + (folder / "a.surf.gii").string() +
                  " " + (folder / "ras.shape.gii").string() + " -trilinear");
        const Eigen::VectorXd sampled =
            io::readVertexMaps(folder / "ras.shape.gii", mesh.vertexCount())[0].values;
        worst = std::max(worst, (sampled - mesh.positions.col(axis)).cwiseAbs().maxCoeff());
      }
      EXPECT_LT(worst, 1e-4) << extension << (leftHanded ? " left-handed" : " right-handed");
      RecordProperty("worst", std::to_string(worst));
    }
  }
}

TEST(Workbench, ReadsOurCiftiByHemispheres) {
  const TemporaryFolder folder;
  writeCifti(folder);
  const auto file = [&folder](const char* name) { return (folder / name).string(); };
  workbench("-cifti-separate " + file("a.dscalar.nii") + " COLUMN -metric CORTEX_LEFT " +
            file("l.func.gii") + " -roi " + file("roi.func.gii"));
  const auto maps = io::readVertexMaps(file("l.func.gii"), 642);
  const Eigen::VectorXd in = io::readVertexMaps(file("roi.func.gii"), 642)[0].values;
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_EQ(maps[1].name, "in & out");
  const auto where = hemispheres(geometry::makeIcosphere(3, 1.0));
  EXPECT_EQ(in.sum(), static_cast<double>(where[0].vertices.size()));
  for (const std::int32_t v : where[0].vertices) EXPECT_EQ(maps[0].values[v], 1000 + v);
  workbench("-cifti-separate " + file("a.dlabel.nii") + " COLUMN -label CORTEX_RIGHT " +
            file("r.label.gii"));
  expectSays(contentOf(file("r.label.gii")), "ctx-rh-postcentral");
  const std::string series = workbench("-file-information " + file("a.dtseries.nii"));
  expectSays(series, "1.500");
  expectSays(series, "CortexRight");
}

TEST(Workbench, ShowsVectorsAsThreeMaps) {
  const TemporaryFolder folder;
  io::writeVolume(folder / "points.nii.gz",
                  Volume<Eigen::Vector3f>(obliqueGrid(false), Eigen::Vector3f(1, 2, 3)));
  const std::string name = (folder / "points.nii.gz").string();
  const std::string count = workbench("-file-information " + name + " -only-number-of-maps");
  EXPECT_EQ(count.substr(0, 1), "3") << count;
  expectSays(workbench("-file-information " + name), "17, 13, 11, 1, 3");
  expectSays(workbench("-nifti-information -print-header " + name), "intent_code: 1007");
}

}  // namespace
