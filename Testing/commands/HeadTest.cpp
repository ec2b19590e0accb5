// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// From an image to a thickness that is known.

#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

namespace explica::testing {
namespace {

class CortexWithDura : public ::testing::TestWithParam<std::string> {};

TEST_P(CortexWithDura, IsAsThickAsItIs) {
  TemporaryFolder folder;
  auto run = explica({"phantom", "cortex", "--size", "48", "--dura", "1", "--dura-gap", "1",
                      "--ventricle", "4", "--noise", GetParam(), "--out", folder / "phantom"});
  ASSERT_EQ(run.exitCode, 0) << run;
  run = explica({"segment", folder / "phantom/t1.nii.gz", "--template", "none", "--accept",
                 "brain-volume", "--out", folder / "segment"});
  ASSERT_EQ(run.exitCode, 0) << run;
  const auto thickness = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"surface",
                                      "--inner-level",
                                      folder / "segment/wm.nii.gz",
                                      "--grey-share",
                                      folder / "segment/gm.nii.gz",
                                      "--faces",
                                      "8000",
                                      "--force",
                                      "--out",
                                      folder / "surface"};
    words.insert(words.end(), more.begin(), more.end());
    const auto result = explica(words);
    EXPECT_EQ(result.exitCode, 0) << result;
    return readJson(folder.path() / "surface/summary.json")["thickness_mean"].get<double>();
  };
  EXPECT_NEAR(thickness({}), 2.5, 0.1);
  // The fluid between cortex and dura is narrower than the voxels show: without its brightness the
  // border comes out 0.1 mm too far in.
  const double fluid =
      readJson(folder.path() / "segment/summary.json")["fluid_of_white"].get<double>();
  EXPECT_NEAR(fluid, 35.0 / 115.0, 0.03);
  EXPECT_NEAR(
      thickness({"--image", folder / "phantom/t1.nii.gz", "--fluid", std::to_string(fluid)}), 2.5,
      0.08);
}

INSTANTIATE_TEST_SUITE_P(TwoNoises, CortexWithDura, ::testing::Values("3", "6"));

}  // namespace
}  // namespace explica::testing
