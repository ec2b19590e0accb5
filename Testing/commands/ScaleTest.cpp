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
#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace explica::testing {
namespace {

std::vector<std::string> thickness(const TemporaryFolder& folder, double unit) {
  io::writeVolume(folder / "ball.nii.gz", wavyBall(unit));
  return {"thickness", folder / "ball.nii.gz", "--inner", "3", "--tissue", "2"};
}

std::vector<std::string> surface(const TemporaryFolder& folder, double unit) {
  io::writeVolume(folder / "ball.nii.gz", wavyBall(unit));
  return {"surface", folder / "ball.nii.gz", "--white-label", "3", "--grey-label", "2", "--faces",
          "6000"};
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

TEST_P(Scale, ByAPowerOfTwoChangesNoCount) {
  const nlohmann::ordered_json here = summaryAt(1);
  for (const double unit : {0x1p-10, 0x1p10}) {  // every length is scaled without rounding
    const nlohmann::ordered_json there = summaryAt(unit);
    for (const std::string& name : GetParam().counts) {
      if (name == "peak_memory_bytes") continue;
      EXPECT_EQ(there.at(name), here.at(name)) << name << " at " << unit;
    }
  }
}

TEST_P(Scale, ByAThousandChangesNeitherWorkNorMemoryByMoreThanATenth) {
  // Rounding decides where two ways are alike, for the ball's eight mirror images at once.
  const std::map<std::string, double> within = {{"trajectories_shortened", 0.2}};
  constexpr double kTenth = 0.1;
  const nlohmann::ordered_json here = summaryAt(1);
  for (const double unit : {1e-3, 1e3}) {
    const nlohmann::ordered_json there = summaryAt(unit);
    for (const std::string& name : GetParam().counts) {
      const double expected = here.at(name);
      EXPECT_GT(expected, 0) << name;
      const double share = within.contains(name) ? within.at(name) : kTenth;
      EXPECT_NEAR(there.at(name), expected, share * expected) << name << " at " << unit;
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
