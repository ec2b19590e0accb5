// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Files whose headers promise more than any machine holds, places that no scanner gives, and small
// files that unpack to large ones: one sentence, exit code 2, within 2 GB of address space.

#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <cstring>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

/// A file, and the use of it that must end with this sentence.
struct Hostile {
  std::string name;  ///< of the test
  std::string file;  ///< what it is called
  std::string content;
  std::vector<std::string> words;  ///< of the command line; {file} and {folder} are filled in
  std::string sentence;            ///< part of the message
  std::size_t megabytes = 0;       ///< of zeros behind the content, which gzip then packs
};

void PrintTo(const Hostile& row, std::ostream* stream) {
  *stream << row.name;
}

template <class T>
std::string bytesOf(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

/// A NIfTI-2 header, as CIFTI files have it, of these sizes; 12 values follow.
std::string nifti2(const std::vector<std::int64_t>& size, std::int64_t offset = 544) {
  std::string header(544, '\0');
  const auto put = [&header](std::size_t at, const std::string& bytes) {
    header.replace(at, bytes.size(), bytes);
  };
  put(0, bytesOf(std::int32_t{540}));
  put(4, std::string("n+2\0\r\n\032\n", 8));
  put(12, bytesOf(std::int16_t{16}) + bytesOf(std::int16_t{32}));
  put(16, bytesOf(static_cast<std::int64_t>(size.size())));
  for (std::size_t d = 0; d < 7; ++d) {
    put(24 + 8 * d, bytesOf(d < size.size() ? size[d] : std::int64_t{1}));
    put(112 + 8 * d, bytesOf(1.0));
  }
  put(168, bytesOf(offset));
  put(344, bytesOf(std::int32_t{1}));  // code of the qform
  return header + std::string(48, '\1');
}

/// A matrix of Matlab's level 4 that announces so many rows.
std::string matlab(const std::string& name, std::int32_t rows, const std::vector<double>& values) {
  std::string bytes = bytesOf(std::int32_t{0}) + bytesOf(rows) + bytesOf(std::int32_t{1}) +
                      bytesOf(std::int32_t{0}) +
                      bytesOf(static_cast<std::int32_t>(name.size()) + 1) + name + '\0';
  for (const double value : values) bytes += bytesOf(value);
  return bytes;
}

/// The row's file; one that unpacks to far more is made only where it is used.
void writeRow(const Hostile& row, const TemporaryFolder& folder) {
  writeText(folder / row.file, row.content);
  if (row.megabytes == 0) return;
  CommandSetting setting;
  setting.directory = folder.path();
  const auto packed =
      runProgram({"bash", "-c",
                  "{ cat " + row.file + "; head -c " + std::to_string(row.megabytes) +
                      "M /dev/zero; } | gzip -1 > packed && mv packed " + row.file},
                 setting);
  ASSERT_EQ(packed.exitCode, 0) << packed;
}

const std::vector<Hostile>& hostileFiles() {
  const std::vector<std::string> kSample = {"sample",  "{folder}/map.nii.gz",
                                            "--white", "{folder}/white.surf.gii",
                                            "--pial",  "{folder}/pial.surf.gii"};
  const auto with = [&](const std::string& option) {
    return kSample + std::vector<std::string>{option, "{file}"};
  };
  const std::vector<std::string> kVolume = {
      "sample", "{file}", "--white", "{folder}/white.surf.gii", "--pial", "{folder}/pial.surf.gii"};
  const std::string rows = "0 -1 0 5\n1 0 0 -7\n0 0 1 11\n0 0 0 1\n";
  const std::string insight = "#Insight Transform File V1.0\n#Transform 0\nTransform: ";
  constexpr std::int64_t kHuge = std::int64_t{1} << 62;
  static const std::vector<Hostile> all = {
      {"CiftiOfSizesThatMultiplyPastTheMachine", "a.dscalar.nii",
       nifti2({1, 1, 1, 1, kHuge, kHuge}), kVolume, "size of 4611686018427387904 along one axis"},
      {"CiftiLargerThanItsFile", "a.dscalar.nii", nifti2({1, 1, 1, 1, 1000, 1000000}), kVolume,
       "truncated"},
      {"CiftiWithANegativeSize", "a.dscalar.nii", nifti2({1, 1, 1, 1, -3, 4}), kVolume,
       "size of -3 along one axis"},
      {"CiftiWhoseValuesBeginBeyondItsEnd", "a.dscalar.nii", nifti2({3, 2, 2}, kHuge), kVolume,
       "truncated"},
      {"VolumeThatUnpacksToFarMore", "a.nii.gz", nifti2({3, 2, 2}).substr(0, 544), kVolume, "",
       600},
      {"MatrixOfHugeNumbers", "m.txt", "1e300 0 0 0\n0 1e300 0 0\n0 0 1e300 0\n0 0 0 1\n",
       with("--to-volume"), "m.txt"},
      {"MatrixWithTrailingNumbers", "m.txt", rows + rows, with("--to-volume"),
       "not a transform of a known format"},
      {"MatrixOfInfinity", "m.txt", "inf 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", with("--to-volume"),
       "not affine"},
      {"LtaFarAway", "m.lta",
       "type = 1\nnxforms = 1\n1 4 4\n1 0 0 1e300\n0 1 0 0\n0 0 1 0\n0 0 0 1\nsrc volume info\n",
       with("--to-volume"), "m.lta"},
      {"RegisterDatCutShort", "register.dat", "bert\n1\n1\n1\n1 0 0\n", with("--to-volume"),
       "a number is expected"},
      {"ItkFieldOfAHugeGrid", "t.tfm",
       insight +
           "DisplacementFieldTransform_double_3_3\nParameters: 1 2 3\nFixedParameters: 2000000000 "
           "2000000000 2000000000 0 0 0 1 1 1 1 0 0 0 1 0 0 0 1\n",
       with("--to-volume"), "t.tfm"},
      {"ItkSplineOfAHugeGrid", "t.tfm",
       insight + "BSplineTransform_double_3_3\nParameters: 1 2 3\nFixedParameters: 1e9 1e9 1e9 0 0 "
                 "0 1 1 1 1 0 "
                 "0 0 1 0 0 0 1\n",
       with("--to-volume"), "t.tfm"},
      {"ItkTextWithTooFewNumbers", "t.tfm",
       insight + "AffineTransform_double_3_3\nParameters: 1 2\nFixedParameters: 0 0 0\n",
       with("--to-volume"), "t.tfm"},
      {"MatlabOfManyRows", "t.mat", matlab("AffineTransform_double_3_3", 2000000000, {1, 2, 3}),
       with("--to-volume"), "t.mat"},
      {"MatlabOfNegativeRows", "t.mat", matlab("AffineTransform_double_3_3", -5, {1, 2, 3}),
       with("--to-volume"), "t.mat"},
      {"Hdf5OfRubbish", "t.h5", "\x89HDF\r\n\x1a\n" + std::string(2000, '\xFE'),
       with("--to-volume"), "t.h5"},
      {"Hdf5CutShort", "t.h5", std::string("\x89HDF\r\n\x1a\n\0\0\0\0\0\x8\x8\0", 16),
       with("--to-volume"), "t.h5"},
      {"PointsFarAway", "p.tsv", "x\ty\tz\n1e18\t0\t0\n", with("--points"), "farther than 10 km"},
      {"PointsBeyondNumbers", "p.tsv", "x\ty\tz\n1e999\t0\t0\n", with("--points"),
       "coordinate is needed"},
      {"PointsWithoutLines", "p.tsv", "x\ty\tz\n", with("--points"), "holds no point"},
      {"PointsThatUnpackToFarMore", "p.tsv", "x\ty\tz\n", with("--points"),
       "unpacks to more than 256 MB", 600},
      {"Minc1", "a.mnc", std::string("CDF\1\0\0\0\0", 8), kVolume, "mnc2nii"},
      {"Minc2", "a.mnc", "\x89HDF\r\n\x1a\n" + std::string(2000, '\xFE'), kVolume, "mnc2nii"},
      {"PolygonFarAway",
       "p.csv",
       "x,y\n1e18,0\n1,0\n0.25,1\n",
       {"polygon", "{file}", "--viewpoint", "0,100"},
       "vertex 0 lies farther than 10 km"},
      {"PolygonBetweenThePointsOfAnyGrid",
       "p.csv",
       "x,y\n9e6,0\n1,0\n0.25,1\n",
       {"embed", "{file}", "--order", "4", "--max-iterations", "2"},
       "so thin that it falls between the points of a grid"},
      {"ObjOfMinc",
       "a.obj",
       "P 0.3 0.3 0.4 10 1 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n",
       {"inflate", "{file}"},
       "which is not read; convert it"},
  };
  return all;
}

class HostileFiles : public ::testing::TestWithParam<Hostile> {};

TEST_P(HostileFiles, AreRefusedInASentence) {
  const TemporaryFolder folder;
  writeCortexAndMap(folder);
  const Hostile& row = GetParam();
  writeRow(row, folder);
  std::string line;
  for (std::string word : filled(row.words, folder)) {
    if (word == "{file}") word = folder / row.file;
    line += " '" + word + "'";
  }
  constexpr const char* kLimit = "ulimit -v 2000000; ";  // kB
  const auto result = runProgram({"bash", "-c",
                                  kLimit + std::string("exec '") + EXPLICA_EXECUTABLE + "'" + line +
                                      " --threads 1 --out '" + (folder / "out") + "'"});
  EXPECT_EQ(result.exitCode, 2) << result;
  EXPECT_NE(result.err.find(row.file), std::string::npos) << result;
  EXPECT_NE(result.err.find(row.sentence), std::string::npos) << result;
  EXPECT_EQ(result.err.find("internal error"), std::string::npos) << result;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

INSTANTIATE_TEST_SUITE_P(Table, HostileFiles, ::testing::ValuesIn(hostileFiles()),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace explica::testing
