// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

// Reading takes no more memory than three times what the file justifies: its bytes, or what is
// handed out where that is more (a packed volume).

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
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
#include "Explica/Testing/FreeSurferLabel.h"
#include "RawFiles.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <numeric>
#include <string>

namespace {

using namespace explica;
namespace fs = std::filesystem;

constexpr double kMost = 3;                  // of what a file justifies
constexpr std::size_t kAlways = 12'000'000;  // bytes: buffers and tables of any reader
constexpr std::size_t kSmall = 72'000'000;   // bytes: what any packed file may unpack to
constexpr Eigen::Index kValues = 2'000'000;  // of a map, a table
constexpr int kSubdivisions = 8;             // of an icosphere: 655,362 vertices

/// A line of /proc/self/status, in bytes.
std::size_t statusOf(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    std::size_t kilobytes = 0;
    if (word == key + ":" && status >> kilobytes) return 1024 * kilobytes;
  }
  return 0;
}

struct Use {
  std::size_t peak = 0;    ///< bytes above what the process had before
  std::size_t handed = 0;  ///< bytes that the reader gave out; 0: it refused
};

/// Does work in a process of its own, which starts with little memory of others' making.
Use useOf(const std::function<std::size_t()>& work) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    mallopt(M_MMAP_THRESHOLD, 1 << 17);  // what is freed goes back to the system
    malloc_trim(0);
    setThreadCount(1);
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak is counted anew
    const std::size_t before = statusOf("VmRSS");
    Use use;
    try {
      use.handed = work();
    } catch (const Error&) {
    }
    use.peak = statusOf("VmHWM") - std::min(before, statusOf("VmHWM"));
    const bool told = ::write(ends[1], &use, sizeof use) == sizeof use;
    _exit(told ? 0 : 1);
  }
  close(ends[1]);
  Use use;
  if (read(ends[0], &use, sizeof use) != sizeof use) use.peak = SIZE_MAX;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return use;
}

template <class T>
std::size_t bytesOf(const Eigen::PlainObjectBase<T>& matrix) {
  return sizeof(typename T::Scalar) * static_cast<std::size_t>(matrix.size());
}

std::size_t scalars(const fs::path& path) {
  return sizeof(float) * io::readScalars(path).volume.size();
}
std::size_t labels(const fs::path& path) {
  return sizeof(Label) * io::readLabels(path).volume.size();
}
std::size_t surface(const fs::path& path) {
  const io::LoadedSurface read = io::readSurface(path);
  std::size_t bytes = bytesOf(read.mesh.positions) + bytesOf(read.mesh.faces);
  for (const io::VertexMap& map : read.maps) bytes += bytesOf(map.values);
  return bytes;
}
std::size_t maps(const fs::path& path) {
  std::size_t bytes = 0;
  for (const io::VertexMap& map : io::readVertexMaps(path)) {
    bytes += bytesOf(map.values) + sizeof map;
  }
  return bytes;
}
std::size_t vertexLabels(const fs::path& path) {
  return bytesOf(io::readVertexLabels(path, kValues).keys);
}
std::size_t polygon(const fs::path& path) {
  return bytesOf(io::readPolygon(path));
}
std::size_t points(const fs::path& path) {
  const io::PointTable table = io::readPointTable(path);
  return bytesOf(table.places) + sizeof(std::string) * table.rows.size();
}

/// A transform hands out no array: its file's own bytes justify what it takes.
std::size_t transform(const fs::path& path) {
  io::TransformSides sides;
  sides.volume.size = {40, 40, 40};
  sides.scannerFromTkr = Eigen::Matrix4d::Identity();
  return io::readPointTransform(path, sides).map(Point(1, 2, 3)).allFinite() ? 1 : 0;
}
constexpr int kFieldSize = 120;  // places of a displacement field along each axis
std::size_t fieldTransform(const fs::path& path) {
  constexpr std::size_t kPlaces = std::size_t{kFieldSize} * kFieldSize * kFieldSize;
  return transform(path) * 3 * sizeof(double) * kPlaces;
}
std::size_t patch(const fs::path& path) {
  return bytesOf(io::readPatch(path).positions);
}

Volume<float> volumeOf(int size) {
  Grid grid;
  grid.size = {size, size, size};
  Volume<float> volume(grid);
  for (std::size_t v = 0; v < volume.size(); ++v) volume[v] = static_cast<float>(v % 1000) + 0.1F;
  return volume;
}

void repeated(const fs::path& path, const std::string& head, const std::string& piece,
              std::size_t count, const std::string& tail) {
  std::ofstream file(path, std::ios::binary);
  file << head;
  std::string block;
  for (int n = 0; n < 1000; ++n) block += piece;
  for (std::size_t n = 0; n < count / 1000; ++n) file << block;
  file << tail;
}

/// The lattice of a spline of 100 x 100 x 100 weights: size, origin, spacing, directions.
std::vector<double> splineGrid() {
  return {100, 100, 100, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1};
}

struct Row {
  std::string name;  ///< of the test
  std::string file;
  std::function<void(const fs::path&)> write;
  std::size_t (*read)(const fs::path&);
  bool refused = false;  ///< the file says or holds what no such file does
  std::size_t always = kAlways;
};

void PrintTo(const Row& row, std::ostream* stream) {
  *stream << row.name;
}

std::vector<Row> honest() {
  const auto volume = [](const fs::path& path) { io::writeVolume(path, volumeOf(200)); };
  const auto itk = [](const fs::path& path) {
    const std::vector<float> values = volumeOf(200).data;
    std::ofstream(path, std::ios::binary)
        << itkImage(path.extension() == ".nrrd", {200, 200, 200}, values);
  };
  const auto segmentation = [](const fs::path& path) {
    Grid grid;
    grid.size = {200, 200, 200};
    io::writeVolume(path, Volume<Label>(grid, 3));
  };
  const auto mesh = [](const fs::path& path) {
    io::writeSurface(path, geometry::makeIcosphere(kSubdivisions));
  };
  const auto shape = [](const fs::path& path) {
    const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(kValues, 0, 1);
    if (path.extension() == ".gii") io::writeGiftiShape(path, {{"a", "mm", values}}, "Other");
    if (path.extension() == ".curv") io::writeFreeSurferCurv(path, values, 20);
  };
  const auto atlas = [](const fs::path& path) {
    io::LabelMap map;
    map.keys.setOnes(kValues);
    map.table = {{0, "no", {0, 0, 0, 0}}, {1, "yes", {1, 0, 0, 1}}};
    if (path.extension() == ".gii") io::writeGiftiLabel(path, map, "Other");
    if (path.extension() == ".annot") io::writeFreeSurferAnnot(path, map);
    if (path.extension() == ".label") {
      map.keys.tail(3 * kValues / 4).setZero();  // the text of the others says enough
      explica::test::writeFreeSurferLabel(path, map, Positions::Random(kValues, 3));
    }
  };
  const auto outline = [](const fs::path& path) {
    const Positions2 polygon = Positions2::Random(kValues / 2, 2);
    if (path.extension() == ".csv") io::writePolygonCsv(path, polygon);
    if (path.extension() == ".vtp") io::writePolygonVtp(path, polygon, {}, {});
  };
  return {
      {"NiftiVolume", "a.nii", volume, scalars},
      {"PackedNiftiVolume", "a.nii.gz", volume, scalars},
      {"NiftiLabels", "a.nii", segmentation, labels},
      {"PackedNiftiLabels", "a.nii.gz", segmentation, labels},
      {"MghVolume", "a.mgh", volume, scalars},
      {"PackedMghVolume", "a.mgz", volume, scalars},
      {"NrrdVolume", "a.nrrd", itk, scalars},
      {"MetaImageVolume", "a.mha", itk, scalars},
      {"GiftiSurface", "a.surf.gii", mesh, surface},
      {"PackedGiftiSurface", "a.surf.gii.gz", mesh, surface},
      {"FreeSurferSurface", "lh.white", mesh, surface},
      {"VtpSurface", "a.vtp", mesh, surface},
      {"PlySurface", "a.ply", mesh, surface},
      {"ObjSurface", "a.obj", mesh, surface},
      {"OffSurface", "a.off", mesh, surface},
      {"StlSurface", "a.stl", mesh, surface},
      {"GiftiMap", "a.shape.gii", shape, maps},
      {"FreeSurferCurv", "lh.curv", shape, maps},
      {"GiftiLabels", "a.label.gii", atlas, vertexLabels},
      {"FreeSurferAnnot", "lh.a.annot", atlas, vertexLabels},
      {"FreeSurferLabel", "lh.a.label", atlas, vertexLabels},
      {"PolygonTable", "a.csv", outline, polygon},
      {"PolygonVtp", "a.vtp", outline, polygon},
      {"PngPicture", "a.png",
       [](const fs::path& path) { std::ofstream(path, std::ios::binary) << plainPng(4000, 4000); },
       scalars},
      {"CiftiMap", "a.dscalar.nii",
       [](const fs::path& path) {
         const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(kValues, 1, 2);
         io::ciftiScalars({{io::ciftiStructure("CortexLeft", values), {{"a", "mm", values}}}})
             .write(path);
       },
       maps, true},
      {"FreeSurferPatch", "lh.a.patch.3d",
       [](const fs::path& path) {
         io::Patch all;
         all.vertices.resize(kValues);
         std::iota(all.vertices.begin(), all.vertices.end(), 0);
         all.border.assign(kValues, false);
         all.positions = Positions::Random(kValues, 3);
         io::writePatch(path, all);
       },
       patch},
      {"Hdf5Transform", "a.h5",
       [](const fs::path& path) {
         Grid grid;
         grid.size = {kFieldSize, kFieldSize, kFieldSize};
         io::writeTransform(path, Eigen::Affine3d::Identity(),
                            Volume<Eigen::Vector3f>(grid, Eigen::Vector3f(0.5F, 0, -1)));
       },
       fieldTransform},
      {"TextTransform", "a.tfm",
       [](const fs::path& path) {
         std::string fixed = "\nFixedParameters:";
         for (const double value : splineGrid()) fixed += " " + std::to_string(value);
         repeated(path,
                  "#Insight Transform File V1.0\n#Transform 0\nTransform: "
                  "BSplineTransform_double_3_3\nParameters:",
                  " 0.53125", 3'000'000, fixed + "\n");
       },
       transform},
      {"PointTable", "p.tsv",
       [](const fs::path& path) {
         repeated(path, "x\ty\tz\n", "12.5\t-30.25\t7\n", 1'000'000, "");
       },
       points}};
}

std::vector<Row> hostile() {
  const auto with = [](const std::string& head, const std::string& piece, std::size_t count,
                       const std::string& tail) {
    return [=](const fs::path& path) { repeated(path, head, piece, count, tail); };
  };
  const auto packed = [with](const std::string& head, std::size_t count) {
    return [=](const fs::path& path) {
      repeated(path, head, " ", count, "");
      static_cast<void>(std::system(("gzip -f '" + path.string() + "'").c_str()));
    };
  };
  return {
      {"GiftiOfManyElements", "a.surf.gii", with("<GIFTI>", "<a/>", 8'000'000, "</GIFTI>"), surface,
       true},
      {"GiftiOfManyAttributes", "a.surf.gii",
       [](const fs::path& path) {
         std::ofstream file(path);
         file << "<GIFTI ";
         for (int n = 0; n < 3'000'000; ++n) file << "a" << n << "='' ";
         file << "/>";
       },
       surface, true},
      {"VtpOfManyElements", "a.vtp",
       with("<VTKFile type=\"PolyData\"><PolyData>", "<a/>", 8'000'000, "</PolyData></VTKFile>"),
       surface, true},
      {"GiftiThatUnpacksToFarMore", "a.surf.gii", packed("<GIFTI>", 150'000'000), surface, true,
       kSmall},
      {"ObjThatUnpacksToFarMore", "a.obj", packed("v 0 0 0\n", 40'000'000), surface, true, kSmall},
      {"ObjOfOneLongFace", "a.obj",
       with("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", " 1", 8'000'000, "\n"), surface},
      {"ObjOfShortVertices", "a.obj", with("v 0 0 0\n", "v 0 1 0\n", 3'000'000, "f 1 2 3\n"),
       surface},
      {"OffOfOneLongFace", "a.off",
       with("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n8000000", " 1", 8'000'000, "\n"), surface},
      {"PlyOfManyProperties", "a.ply",
       with("ply\nformat ascii 1.0\nelement vertex 1\n", "property char a\n", 1'000'000,
            "end_header\n"),
       surface, true},
      {"AnnotOfManyNames", "lh.a.annot",
       [](const fs::path& path) {
         const auto number = [](std::uint32_t n) {
           return std::string{static_cast<char>(n >> 24), static_cast<char>(n >> 16),
                              static_cast<char>(n >> 8), static_cast<char>(n)};
         };
         const std::uint32_t entries = 1'000'000;
         repeated(path,
                  number(1) + number(0) + number(0) + number(1) + number(-2U) + number(entries) +
                      number(0) + number(entries),
                  number(7) + number(0) + std::string(16, '\1'), entries, "");
       },
       vertexLabels, true},
      {"MghOfManyFrames", "a.mgh",
       [](const fs::path& path) {
         Grid grid;
         std::string header(284, '\0');
         const auto put = [&header](std::size_t at, std::uint32_t n) {
           for (int b = 0; b < 4; ++b) header[at + b] = static_cast<char>(n >> (24 - 8 * b));
         };
         put(0, 1);
         for (const std::size_t at : {4U, 8U, 12U}) put(at, 1);
         put(16, 2'000'000);
         repeated(path, header, std::string(1, '\1'), 2'000'000, "");
       },
       maps, true},
      {"LegendOfManyNames", "l.tsv", with("index\tname\n", "1\ta\n", 5'000'000, ""),
       [](const fs::path& path) { return io::readLabelNames(path).size(); }, true},
      {"PngLargerThanItsFile", "a.png",
       [](const fs::path& path) {
         std::string bytes = plainPng(40, 30);
         bytes.replace(8, 25,
                       pngChunk("IHDR", std::string("\0\0\x7f\xff\0\0\x7f\xff\10\0\0\0\0", 13)));
         std::ofstream(path, std::ios::binary) << bytes;
       },
       scalars, true},
      {"MatlabOfManyNumbers", "a.mat",
       [](const fs::path& path) {
         std::string bytes;
         appendMatlab(bytes, "AffineTransform_double_3_3", std::vector<double>(3'000'000, 0.5));
         appendMatlab(bytes, "fixed", {0, 0, 0});
         std::ofstream(path, std::ios::binary) << bytes;
       },
       transform, true},
      {"LtaOfManyLines", "a.lta", with("type = 1\nnxforms = 1\n", "mean = 0 0 0\n", 3'000'000, ""),
       transform, true},
      {"MatrixOfManyNumbers", "m.txt", with("", "1 0 0 0\n", 5'000'000, ""), transform, true},
      {"RegisterDatOfManyLines", "register.dat",
       with("bert\n1\n1\n1\n", "1 0 0 0\n", 5'000'000, ""), transform, true},
      {"PycortexOfManyNumbers", "m.xfm", with("{\"coord\": [[", "0, ", 5'000'000, "0]]}"),
       transform, true},
      {"TextOfManyTransforms", "a.tfm",
       with("#Insight Transform File V1.0\n",
            "Transform: AffineTransform_double_3_3\nParameters: 1 0 0 0 1 0 0 0 1 0 0 0\n"
            "FixedParameters: 0 0 0\n",
            200'000, ""),
       transform, true},
      {"PointsOfFewCharacters", "p.tsv", with("x\ty\tz\n", "1\t2\t3\n", 5'000'000, ""), points},
  };
}

class ReadingMemory : public testing::TestWithParam<Row> {};

TEST_P(ReadingMemory, IsWithinThreeTimesWhatTheFileJustifies) {
  const Row& row = GetParam();
  const TemporaryFolder folder;
  fs::path path = folder / row.file;
  useOf([&]() -> std::size_t {  // so that what writing took is not there when it is read
    row.write(path);
    return 1;
  });
  if (!fs::exists(path)) path += ".gz";
  ASSERT_TRUE(fs::exists(path));
  const auto onDisk = static_cast<std::size_t>(fs::file_size(path));
  const Use use = useOf([&] { return row.read(path); });
  if (statusOf("VmHWM") == 0) GTEST_SKIP() << "skipped: no /proc to read memory from";
  const double justified = static_cast<double>(std::max(onDisk, use.handed));
  const double share =
      (static_cast<double>(use.peak) - static_cast<double>(row.always)) / justified;
  RecordProperty("times", std::to_string(share));
  EXPECT_LE(share, kMost) << onDisk << " bytes on disk, " << use.handed << " handed out, peak "
                          << use.peak;
  EXPECT_EQ(use.handed == 0, row.refused);
}

INSTANTIATE_TEST_SUITE_P(Honest, ReadingMemory, testing::ValuesIn(honest()),
                         [](const auto& row) { return row.param.name; });
INSTANTIATE_TEST_SUITE_P(Hostile, ReadingMemory, testing::ValuesIn(hostile()),
                         [](const auto& row) { return row.param.name; });

}  // namespace
