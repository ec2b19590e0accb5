// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Energy.h"

#include "Explica/Core/Parallel.h"

namespace explica::unfolding {

/// A term that is a sum over the faces of the region, or of the collar.
///
/// `Local` says what one face contributes, f counting all faces of the patch:
///   kOfCollar                    which faces
///   value(now, f, strength)      mm^2
///   forces(now, f, strength)     its derivatives by the three corners
///   stiffness(now, f, strength)  what blockOf() makes the blocks of its corners of
template <class Local>
class FaceSum : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    const std::size_t first = firstOf(now);
    return parallelSum(countOf(now), kGrain, 0.0, [&](std::size_t begin, std::size_t end) {
      double block = 0;
      for (std::size_t f = begin; f < end; ++f) block += Local::value(now, first + f, strength);
      return block;
    });
  }

  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    const std::size_t first = firstOf(now), count = countOf(now);
    std::vector<CornerForces> forces(count);
    parallelFor(count, kGrain,
                [&](std::size_t f) { forces[f] = Local::forces(now, first + f, strength); });
    for (std::size_t f = 0; f < count; ++f) {
      const auto& vertices = now.patch.faces[first + f].vertices;
      for (int k = 0; k < 3; ++k) gradient.row(vertices[k]) += forces[f][k].transpose();
    }
  }

  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    const std::size_t first = firstOf(now), count = countOf(now);
    const auto verticesOf = [&](std::int32_t f) { return now.patch.faces[f].vertices; };
    std::vector<decltype(Local::stiffness(now, 0, strength))> stiffness(count);
    parallelFor(count, kGrain,
                [&](std::size_t f) { stiffness[f] = Local::stiffness(now, first + f, strength); });
    addBlocks(now.patch.facesAround, first, count, verticesOf, unknown, system,
              [&](std::int32_t f, int i, int j) {
                return blockOf(now.shapes[f], stiffness[f - first], i, j);
              });
  }

 private:
  static constexpr std::size_t kGrain = 256;  // faces a task

  static std::size_t firstOf(const Configuration& now) {
    return Local::kOfCollar ? now.patch.regionFaces : 0;
  }
  static std::size_t countOf(const Configuration& now) {
    return Local::kOfCollar ? now.patch.ofCollar().size() : now.patch.regionFaces;
  }
};

}  // namespace explica::unfolding
