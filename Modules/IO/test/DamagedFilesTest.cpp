// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

// Whatever bytes a file holds, a reader returns or throws InvalidInput or IOError: it does not
// crash, hang, or ask for memory that the file could not fill.

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/IO/VtkFile.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <cmath>
#include <random>
#include <string>

namespace {

using namespace explica;
namespace fs = std::filesystem;

constexpr unsigned kSeed = 20250607;
constexpr int kTrials = 400;
constexpr int kHeaderBytes = 700;  // damage falls here as often as anywhere else

Volume<float> smallVolume() {
  Grid grid;
  grid.size = {4, 3, 3};
  grid.spacing = {1, 2, 0.5};
  Volume<float> volume(grid);
  for (std::size_t v = 0; v < volume.size(); ++v) volume[v] = static_cast<float>(v);
  return volume;
}

io::LabelMap smallLabels() {
  io::LabelMap labels;
  labels.name = "a";
  labels.keys.setOnes(12);
  labels.table = {{0, "no", {0, 0, 0, 0}}, {1, "yes", {1, 0, 0, 1}}};
  return labels;
}

void write(const fs::path& path) {
  const std::string name = path.filename().string();
  const TriangleMesh mesh = geometry::makeIcosphere(0);
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(12, 0, 1);
  if (name.ends_with(".shape.gii")) {
    io::writeGiftiShape(path, {{"a", "mm", values}}, "Other");
  } else if (name.ends_with(".label.gii")) {
    io::writeGiftiLabel(path, smallLabels(), "Other");
  } else if (name.ends_with(".annot")) {
    io::writeFreeSurferAnnot(path, smallLabels());
  } else if (name.ends_with(".label")) {
    io::writeFreeSurferLabel(path, smallLabels(), mesh.positions);
  } else if (name.ends_with(".curv")) {
    io::writeFreeSurferCurv(path, values, 20);
  } else if (name.starts_with("polygon.")) {
    Positions2 polygon(3, 2);
    polygon << 0, 0, 1, 0, 0.25, 1;
    const io::VertexMap map{"a", "", Eigen::VectorXd::Ones(3)};
    if (name.ends_with(".csv")) io::writePolygonCsv(path, polygon, {map});
    if (name.ends_with(".vtp")) io::writePolygonVtp(path, polygon, {map});
  } else if (name == "legacy.vtk") {
    putContent(path,
               "# vtk DataFile Version 5.1\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
               "0 0 0 1 0 0 0 1 0 0 0 1\nPOLYGONS 3 6\nOFFSETS vtktypeint64\n0 3 6\n"
               "CONNECTIVITY vtktypeint64\n0 1 2 0 2 3\nPOINT_DATA 4\nSCALARS s float 1\n"
               "LOOKUP_TABLE default\n1 2 3 4\nFIELD f 1\nv 2 4 double\n1 2 3 4 5 6 7 8\n");
  } else if (name == "base64.vtp") {
    putContent(
        path,
        "<?xml version=\"1.0\"?><VTKFile type=\"PolyData\" header_type=\"UInt32\" "
        "byte_order=\"LittleEndian\"><PolyData><Piece NumberOfPoints=\"3\" "
        "NumberOfPolys=\"1\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" "
        "format=\"binary\">JAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAA==</DataArray>"
        "</Points><Polys><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 "
        "2</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3</DataArray>"
        "</Polys></Piece></PolyData></VTKFile>");
  } else if (name == "text.stl") {
    putContent(path,
               "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
               "endloop\nendfacet\nendsolid a\n");
  } else if (name == "text.ply") {
    putContent(path,
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
               "property float z\nelement face 1\nproperty list uchar int vertex_index\n"
               "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  } else if (name.starts_with("volume.")) {
    io::writeVolume(path, smallVolume());
  } else {
    io::writeSurface(path, mesh);
  }
}

/// Asks every reader; true if any of them threw something that is no answer to a damaged file.
std::string wrongAnswer(const fs::path& path) {
  const auto ask = [](const auto& read) -> std::string {
    try {
      read();
    } catch (const IOError&) {
    } catch (const InvalidInput&) {
    } catch (const std::exception& error) {
      return std::string(typeid(error).name()) + ": " + error.what();
    }
    return {};
  };
  std::string wrong;
  wrong += ask([&] { static_cast<void>(io::readScalars(path)); });
  wrong += ask([&] { static_cast<void>(io::readLabels(path)); });
  wrong += ask([&] { static_cast<void>(io::readVectors(path)); });
  wrong += ask([&] { static_cast<void>(io::readSurface(path)); });
  wrong += ask([&] { static_cast<void>(io::readVertexMaps(path)); });
  wrong += ask([&] { static_cast<void>(io::readVertexLabels(path, 12)); });
  wrong += ask([&] { static_cast<void>(io::readPolygon(path)); });
  return wrong;
}

class DamagedFiles : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    // Memory that a damaged size could ask for is refused by the system, which readers must not
    // meet.
    getrlimit(RLIMIT_AS, &before_);
    rlimit bounded = before_;
    bounded.rlim_cur = rlim_t{6} << 30;
#ifndef __SANITIZE_ADDRESS__
    setrlimit(RLIMIT_AS, &bounded);
#endif
    path_ = folder_ / GetParam();
    write(path_);
    whole_ = contentOf(path_);
  }
  void TearDown() override {
    setrlimit(RLIMIT_AS, &before_);
  }

  TemporaryFolder folder_;
  fs::path path_;
  std::string whole_;
  rlimit before_{};
};

TEST_P(DamagedFiles, WholeOnesAreUnderstood) {
  EXPECT_EQ(wrongAnswer(path_), "");
}

TEST_P(DamagedFiles, TruncatedAnywhere) {
  const std::size_t step = 1 + whole_.size() / 200;
  for (std::size_t kept = 0; kept < whole_.size(); kept += step) {
    putContent(path_, whole_.substr(0, kept));
    ASSERT_EQ(wrongAnswer(path_), "") << kept << " of " << whole_.size() << " bytes";
  }
}

TEST_P(DamagedFiles, BytesChangedAnywhere) {
  std::mt19937 random(kSeed);
  for (int trial = 0; trial < kTrials; ++trial) {
    std::string bytes = whole_;
    const std::size_t range =
        trial % 2 == 0 ? bytes.size() : std::min<std::size_t>(bytes.size(), kHeaderBytes);
    const int changes = 1 + static_cast<int>(random() % 4);
    for (int c = 0; c < changes; ++c) {
      char& byte = bytes[random() % range];
      switch (random() % 4) {
        case 0:
          byte = static_cast<char>(byte ^ (1 << random() % 8));
          break;
        case 1:
          byte = static_cast<char>(random());
          break;
        case 2:
          byte = static_cast<char>('0' + random() % 10);  // another number in text
          break;
        default:
          byte = static_cast<char>(random() % 2 == 0 ? 0xff : 0x7f);
          break;
      }
    }
    putContent(path_, bytes);
    ASSERT_EQ(wrongAnswer(path_), "") << "seed " << kSeed << ", trial " << trial;
  }
}

TEST_P(DamagedFiles, PiecesRepeatedOrLeftOut) {
  std::mt19937 random(kSeed + 1);
  for (int trial = 0; trial < kTrials / 4; ++trial) {
    const std::size_t at = random() % whole_.size();
    const std::size_t length = 1 + random() % 40;
    std::string bytes = whole_;
    if (trial % 2 == 0) {
      bytes.erase(at, length);
    } else {
      bytes.insert(at, bytes.substr(random() % whole_.size(), length));
    }
    putContent(path_, bytes);
    ASSERT_EQ(wrongAnswer(path_), "") << "seed " << kSeed + 1 << ", trial " << trial;
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, DamagedFiles,
                         testing::Values("volume.nii", "volume.nii.gz", "volume.mgh", "volume.mgz",
                                         "volume.nrrd", "volume.mha", "a.surf.gii", "a.surf.gii.gz",
                                         "a.shape.gii", "a.label.gii", "lh.white", "lh.curv",
                                         "lh.a.annot", "lh.a.label", "a.vtp", "base64.vtp",
                                         "legacy.vtk", "a.ply", "text.ply", "a.obj", "a.off",
                                         "a.stl", "text.stl", "polygon.csv", "polygon.vtp"),
                         [](const auto& instance) {
                           std::string name = instance.param;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

}  // namespace
