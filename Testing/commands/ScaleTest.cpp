// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Commands on the same shape at a thousandth of its size and a thousand times its size: the work
// that they do and the memory that they take.  Nothing here depends on the clock.

#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"
#include "Explica/Testing/Grids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace explica::testing {
namespace {

/// A ball with twelve waves, white matter 3 in a ribbon 2, some sulci of it buried.
void writeWavyBall(const std::filesystem::path& path, double unit) {
  constexpr int n = 62;
  Volume<Label> labels(cubeGrid(n, unit));
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto at = labels.grid.subscripts(v);
    const Vector p = Vector(at[0], at[1], at[2]) - Vector::Constant(0.5 * (n - 1));
    const double r = p.norm(), flat = std::hypot(p.x(), p.y()) / r;
    const double wave = 4 * std::sin(12 * std::atan2(p.y(), p.x())) * flat * flat;
    labels[v] = r < 20 + wave ? 3 : r < 23 || r < 23 + wave ? 2 : 0;
  }
  io::writeVolume(path, labels);
}

std::vector<std::string> thickness(const TemporaryFolder& folder, double unit) {
  writeWavyBall(folder / "ball.nii.gz", unit);
  return {"thickness", folder / "ball.nii.gz", "--inner", "3", "--tissue", "2"};
}

std::vector<std::string> surface(const TemporaryFolder& folder, double unit) {
  writeWavyBall(folder / "ball.nii.gz", unit);
  return {"surface", folder / "ball.nii.gz", "--white", "3", "--grey", "2", "--faces", "6000"};
}

std::vector<std::string> unfold(const TemporaryFolder& folder, double unit) {
  io::writeSurface(folder / "sphere.surf.gii", geometry::makeFoldedSphere(3, 30 * unit));
  return {
      "unfold",   folder / "sphere.surf.gii", "--center",    "0,0," + std::to_string(26.25 * unit),
      "--radius", std::to_string(12 * unit),  "--viewpoint", "0,0," + std::to_string(500 * unit)};
}

/// A command and the counts of its summary that say how much it did.
struct Work {
  std::string name;
  std::function<std::vector<std::string>(const TemporaryFolder&, double unit)> words;
  std::vector<std::string> counts;
};
void PrintTo(const Work& work, std::ostream* out) {
  *out << work.name;
}

class Scale : public ::testing::TestWithParam<Work> {
 protected:
  static nlohmann::ordered_json summaryAt(double unit) {
    const TemporaryFolder folder;
    auto words = GetParam().words(folder, unit);
    words.insert(words.end(), {"--threads", "1", "--out", folder / "out"});
    const auto result = explica(words);
    EXPECT_EQ(result.exitCode, 0) << result;
    return readJson(folder / "out/summary.json");
  }
};

TEST_P(Scale, ByAThousandChangesNeitherWorkNorMemoryByMoreThanATenth) {
  constexpr double kTenth = 0.1;
  const nlohmann::ordered_json here = summaryAt(1);
  for (const double unit : {1e-3, 1e3}) {
    const nlohmann::ordered_json there = summaryAt(unit);
    for (const std::string& name : GetParam().counts) {
      const double expected = here.at(name);
      EXPECT_GT(expected, 0) << name;
      EXPECT_NEAR(there.at(name), expected, kTenth * expected) << name << " at " << unit;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Commands, Scale,
                         ::testing::Values(Work{"Thickness",
                                                thickness,
                                                {"voxels", "iterations", "traced_fraction",
                                                 "sulcal_voxels_recovered", "peak_memory_bytes"}},
                                           Work{"Surface",
                                                surface,
                                                {"vertices", "faces", "white_voxels", "grey_voxels",
                                                 "vertices_ended_at_bank", "trajectories_shortened",
                                                 "sulcal_links_recovered", "peak_memory_bytes"}},
                                           Work{"Unfold",
                                                unfold,
                                                {"iterations", "region_faces", "collar_faces",
                                                 "peak_memory_bytes"}}),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace explica::testing
