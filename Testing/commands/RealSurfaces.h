// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/IO/SurfaceFile.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace explica::testing {

/// Tests on surfaces of real heads; skipped where there are none.
class RealSurfaces : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(data())) GTEST_SKIP() << "skipped: no real data";
  }

  static std::filesystem::path data() { return EXPLICA_REAL_DATA; }
  static std::filesystem::path average() { return data() / "fsaverage5/pial_left.gii.gz"; }
  /// One person's, 305,782 faces, 103 pairs of which intersect.
  static std::filesystem::path individual() { return data() / "s1_pycortex_lh/pia_lh.gii"; }

  /// Words that unfold about the vertex farthest along (x, y, z) from the centroid, without --out.
  static std::vector<std::string> unfoldAbout(const std::filesystem::path& surface,
                                              const Vector& along, double radius,
                                              const std::string& surround) {
    const TriangleMesh mesh = io::readSurface(surface).mesh;
    const Point centroid = mesh.positions.colwise().mean().transpose();
    Eigen::Index farthest = 0;
    (void)((mesh.positions.rowwise() - centroid.transpose()) * along).maxCoeff(&farthest);
    char direction[80];
    std::snprintf(direction, sizeof direction, "--direction=%g,%g,%g", along[0], along[1],
                  along[2]);
    return {"unfold",   surface.string(),       "--vertex", std::to_string(farthest),
            "--radius", std::to_string(radius), direction,  "--surround",
            surround};
  }
};

}  // namespace explica::testing
