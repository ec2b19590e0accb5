// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

// Whatever bytes a file holds, a reader returns or throws InvalidInput or IOError: it does not
// crash, hang, or ask for memory that the file could not fill.

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/CiftiFile.h"
#include "Explica/IO/LabelNames.h"
#include "Explica/IO/PatchFile.h"
#include "Explica/IO/PointTableFile.h"
#include "Explica/IO/PointTransformFile.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/TransformFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/IO/VtkFile.h"
#include "Explica/Testing/FreeSurferLabel.h"
#include "RawFiles.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <random>
#include <string>

namespace {

using namespace explica;
namespace fs = std::filesystem;

constexpr unsigned kSeed = 20250607;
constexpr int kTrials = 200;
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

/// A grey picture of 4 x 3 pixels with more chunks before its pixels.
std::string pngWith(const std::string& more, char colour = 0) {
  const std::string size("\0\0\0\4\0\0\0\3\10", 9);
  const std::string packed(
      "\x78\x9c\x63\x60\x30\x4a\x39\xc1\xc0\x05\x22\x44\x80\x04\x00\x1b\xad\x04\x39", 19);
  return "\x89PNG\r\n\x1a\n" + pngChunk("IHDR", size + colour + std::string(3, '\0')) + more +
         pngChunk("IDAT", packed) + pngChunk("IEND", "");
}

/// A rigid transform in each format that is text; false for another name.
bool writeTextTransform(const fs::path& path) {
  const std::string rows = "0 -1 0 5\n1 0 0 -7\n0 0 1 11\n0 0 0 1\n";
  const std::string side =
      " volume info\nvalid = 1  # volume info valid\nfilename = a.nii\nvolume = 40 40 40\n"
      "voxelsize = 1 1 1\nxras = 1 0 0\nyras = 0 1 0\nzras = 0 0 1\ncras = ";
  const std::map<std::string, std::string> texts = {
      {"matrix.txt", "# surface to volume\n" + rows},
      {"itk.tfm",
       "#Insight Transform File V1.0\n#Transform 0\nTransform: AffineTransform_double_3_3\n"
       "Parameters: 0 -1 0 1 0 0 0 0 1 5 -7 11\nFixedParameters: 0 0 0\n"},
      {"reg.lta", "type = 1\nnxforms = 1\nmean = 0 0 0\nsigma = 1\n1 4 4\n" + rows + "src" + side +
                      "0 0 0\ndst" + side + "20 20 20\nsubject a\nfscale 0.1\n"},
      {"register.dat", "bert\n2.2\n3.5\n0.15\n" + rows + "round\n"},
      {"matrices.xfm",
       "{\"coord\": [[0, -1, 0, 5],\n [1, 0, 0, -7],\n [0, 0, 1, 11], [0, 0, 0, 1]], \"shape\": "
       "[4]}"}};
  const auto found = texts.find(path.filename().string());
  if (found == texts.end()) return false;
  putContent(path, found->second);
  return true;
}

/// Transforms, tables and patches; false for another name.
bool writeOtherThanMaps(const fs::path& path) {
  const std::string name = path.filename().string();
  const TriangleMesh mesh = geometry::makeIcosphere(0);
  if (writeTextTransform(path)) return true;
  if (name == "itk.mat") {
    std::string bytes;
    appendMatlab(bytes, "AffineTransform_double_3_3", {0, -1, 0, 1, 0, 0, 0, 0, 1, 5, -7, 11});
    appendMatlab(bytes, "fixed", {0, 0, 0});
    putContent(path, bytes);
  } else if (name == "itk.h5") {
    Grid grid;
    grid.size = {3, 3, 3};
    io::writeTransform(path, Eigen::Affine3d(Eigen::Translation3d(1, 2, 3)),
                       Volume<Eigen::Vector3f>(grid, Eigen::Vector3f(0.5F, 0, -1)));
  } else if (name == "points.tsv") {
    putContent(path, "name\tx\ty\tz\nA1\t1.5\t-2\t30\nA2\t1e1\t0\t0.25\n");
  } else if (name == "legend.tsv") {
    putContent(path, "index\tname\n1\tleft\n2\tright\n");
  } else if (name.ends_with(".dscalar.nii")) {
    const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(12, 1, 2);
    io::ciftiScalars({{io::ciftiStructure("CortexLeft", values), {{"a", "", values}}}}).write(path);
  } else if (name.ends_with(".patch.3d")) {
    io::writePatch(path, {{0, 1, 2, 5}, {true, false, true, false}, mesh.positions.topRows(4)});
  } else {
    return false;
  }
  return true;
}

void write(const fs::path& path) {
  const std::string name = path.filename().string();
  if (writeOtherThanMaps(path)) return;
  const TriangleMesh mesh = geometry::makeIcosphere(0);
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(12, 0, 1);
  if (name.ends_with(".shape.gii")) {
    io::writeGiftiShape(path, {{"a", "mm", values}}, "Other");
  } else if (name.ends_with(".label.gii")) {
    io::writeGiftiLabel(path, smallLabels(), "Other");
  } else if (name.ends_with(".annot")) {
    io::writeFreeSurferAnnot(path, smallLabels());
  } else if (name.ends_with(".label")) {
    explica::test::writeFreeSurferLabel(path, smallLabels(), mesh.positions);
  } else if (name.ends_with(".curv")) {
    io::writeFreeSurferCurv(path, values, 20);
  } else if (name.starts_with("polygon.")) {
    Positions2 polygon(3, 2);
    polygon << 0, 0, 1, 0, 0.25, 1;
    const io::VertexMap map{"a", "", Eigen::VectorXd::Ones(3)};
    if (name.ends_with(".csv")) io::writePolygonCsv(path, polygon);
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
  } else if (name == "volume.png") {
    putContent(path, pngWith(""));
  } else if (name == "volume.nrrd" || name == "volume.mha") {
    putContent(path, itkImage(name == "volume.nrrd", {4, 3, 3}, smallVolume().data));
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
  wrong += ask([&] { static_cast<void>(io::readPatch(path)); });
  wrong += ask([&] { static_cast<void>(io::readPointTable(path)); });
  wrong += ask([&] { static_cast<void>(io::readLabelNames(path)); });
  io::TransformSides sides;
  sides.volume.size = {40, 40, 40};
  sides.scannerFromTkr = Eigen::Matrix4d::Identity();
  wrong += ask([&] { static_cast<void>(io::readPointTransform(path, sides)); });
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
  const std::size_t step = 1 + whole_.size() / 100;
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

/// What a reader says of a file.
template <class Read>
std::string complaint(const fs::path& path, const Read& read) {
  try {
    read(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ImplausibleHeaders, OfNiftiAreRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder / "volume.nii";
  io::writeVolume(path, smallVolume());
  const std::string whole = contentOf(path);
  const auto said = [&](std::size_t at, float value) {
    std::string bytes = whole;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    putContent(path, bytes);
    return complaint(path, [](const fs::path& p) { static_cast<void>(io::readScalars(p)); });
  };
  const float infinite = std::numeric_limits<float>::infinity();
  constexpr std::size_t kOffset = 108, kSlope = 112, kIntercept = 116, kOrigin = 268;
  EXPECT_NE(said(kSlope, infinite).find("correct scl_slope and scl_inter"), std::string::npos);
  EXPECT_EQ(said(kSlope, std::nanf("")), "accepted") << "no scaling, as NIfTI's library reads it";
  EXPECT_NE(said(kIntercept, infinite).find("correct scl_slope"), std::string::npos);
  EXPECT_NE(said(kOffset, 351).find("inside the header (vox_offset 351)"), std::string::npos);
  EXPECT_NE(said(kOffset, 1e15F), "accepted");
  EXPECT_NE(said(kOrigin, infinite), "accepted");
  EXPECT_EQ(said(kSlope, 2), "accepted");
  EXPECT_EQ(said(kOffset, 352), "accepted");
}

TEST(ImplausibleHeaders, OfGiftiAreRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.surf.gii";
  io::writeSurface(path, geometry::makeIcosphere(0));
  const std::string whole = contentOf(path);
  const auto said = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    putContent(path, text.replace(at, from.size(), to));
    return complaint(path, [](const fs::path& p) { static_cast<void>(io::readSurface(p)); });
  };
  EXPECT_NE(said("NIFTI_TYPE_FLOAT32", "NIFTI_TYPE_FLOAT33").find("unknown type"),
            std::string::npos);
  EXPECT_NE(said("LittleEndian", "MiddleEndian").find("unknown Endian 'MiddleEndian'"),
            std::string::npos);
  EXPECT_NE(said("RowMajorOrder", "ColumnMinorOrder").find("unknown ArrayIndexingOrder"),
            std::string::npos);
  EXPECT_EQ(said("LittleEndian", "GIFTI_ENDIAN_LITTLE"), "accepted");
}

TEST(ImplausibleCoordinates, OfTablesAreRefused) {
  const TemporaryFolder folder;
  const auto said = [&](const std::string& number) {
    putContent(folder / "points.tsv", "x\ty\tz\n1\t2\t3\n0\t" + number + "\t0\n");
    return complaint(folder / "points.tsv",
                     [](const fs::path& p) { static_cast<void>(io::readPointTable(p)); });
  };
  EXPECT_EQ(said("9e6"), "accepted");
  EXPECT_NE(said("1e18").find("row 2 has '1e18', farther than 10 km"), std::string::npos);
  EXPECT_NE(said("nan").find("where a coordinate is needed"), std::string::npos);
}

TEST(ImplausibleCoordinates, AreRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.off";
  const auto said = [&](const std::string& number) {
    putContent(path, "OFF\n3 1 0\n0 0 0\n" + number + " 0 0\n0 1 0\n3 0 1 2\n");
    return complaint(path, [](const fs::path& p) { static_cast<void>(io::readSurface(p)); });
  };
  EXPECT_NE(said("1e18").find("vertex 1 lies farther than 10 km"), std::string::npos);
  EXPECT_NE(said("-2e7").find("vertex 1 lies farther than 10 km"), std::string::npos);
  EXPECT_EQ(said("9e6"), "accepted");
}

TEST(DamagedFile, PicturesAreRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.png";
  const auto said = [&](const std::string& bytes) {
    putContent(path, bytes);
    return complaint(path, [](const fs::path& p) { static_cast<void>(io::readScalars(p)); });
  };
  EXPECT_EQ(said(pngWith("")), "accepted");
  EXPECT_EQ(said(pngWith(pngChunk("teXt", "what no reader needs"))), "accepted");
  const std::string header = pngWith("").substr(8, 25);
  for (const std::string& chunk : {header, pngChunk("ABCD", "must be understood")}) {
    EXPECT_NE(said(pngWith(chunk)).find("is damaged"), std::string::npos) << chunk.substr(4, 4);
  }
  EXPECT_NE(said(pngWith("", 3)).find("is damaged"), std::string::npos);
  EXPECT_NE(said(pngWith("", 5)).find("is damaged"), std::string::npos);
  std::string renamed = pngWith("");
  renamed[37] = '\3';
  EXPECT_NE(said(renamed).find("is damaged"), std::string::npos);
}

/// A file of every kind that is read.
const std::string kKinds[] = {
    "volume.nii",  "volume.nii.gz", "volume.mgh",    "volume.mgz",    "volume.nrrd",  "volume.mha",
    "volume.png",  "a.surf.gii",    "a.surf.gii.gz", "a.shape.gii",   "a.label.gii",  "lh.white",
    "lh.curv",     "lh.a.annot",    "lh.a.label",    "a.vtp",         "base64.vtp",   "legacy.vtk",
    "a.ply",       "text.ply",      "a.obj",         "a.off",         "a.stl",        "text.stl",
    "polygon.csv", "polygon.vtp",   "a.dscalar.nii", "lh.a.patch.3d", "matrix.txt",   "itk.tfm",
    "itk.mat",     "itk.h5",        "reg.lta",       "register.dat",  "matrices.xfm", "points.tsv",
    "legend.tsv",
};

TEST(DamagedFilesList, HasAFileOfEverySurfaceFormat) {
  for (const std::string& ending : io::surfaceEndings()) {
    EXPECT_TRUE(std::any_of(std::begin(kKinds), std::end(kKinds), [&](const std::string kind) {
      return kind.ends_with(ending);
    })) << ending;
  }
}

/// With EXPLICA_SEEDS set to a folder, writes one file of each format as fuzzers' first inputs.
TEST_P(DamagedFiles, WholeOnesAreSeeds) {
  const char* seeds = std::getenv("EXPLICA_SEEDS");
  const fs::path place = seeds != nullptr ? fs::path(seeds) / GetParam() : folder_ / "seeds";
  fs::create_directories(place);
  fs::copy_file(path_, place / "seed", fs::copy_options::overwrite_existing);
  EXPECT_EQ(contentOf(place / "seed"), whole_);
}

INSTANTIATE_TEST_SUITE_P(Formats, DamagedFiles, testing::ValuesIn(kKinds),
                         [](const auto& instance) {
                           std::string name = instance.param;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

}  // namespace
