// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace explica::correspondence {

inline constexpr int kBeside = 8;  ///< trajectories that are followed beside each other

/// A component of kBeside vectors or so many numbers: what stands side by side is computed at once.
struct alignas(64) Lane : std::array<double, kBeside> {};
using Lanes = std::array<Lane, 3>;

/// What a box voxel is as lowest corner of a cell, if the cell has no row of its own corners.
enum : std::int32_t {
  kWhole = -1,   ///< all its corners are tissue of one side
  kEmpty = -2,   ///< none is
  kDivided = -3  ///< kDivided - n: the n-th cell of several sides
};

/// What kernels read of a trajectories' field: see TrajectoryTracer::Field.
struct FieldView {
  const std::int32_t* cellAt = nullptr;  ///< per box voxel
  const std::int32_t* rankAt = nullptr;  ///< per box voxel
  const float* node = nullptr;           ///< per rank, gradient per voxel and u
  const float* cells = nullptr;          ///< per cell, eight such corners
  std::array<std::int32_t, 3> size{};    ///< voxels of the box
  std::array<double, 3> inverseSpacing{};
  double leastSlope = 0;  ///< 1/mm: below it there is no direction
  bool planar = false;    ///< every cell is odd; the third axis' inverse spacing is 0

  /// A sample in a cell that is none of the two common kinds.
  struct Odd {
    float value[4] = {0, 0, 0, 0};  ///< gradient per voxel
    double u = 0;
    std::int32_t home = -1;
    bool divided = false;  ///< the cell has more than one side
  };
  /// Takes a place and the tissue voxel that tells the side.
  Odd (*odd)(const void* field, const double* x, std::int32_t home) = nullptr;
  const void* field = nullptr;
};

/// Steps that are tried beside each other, by the third-order pair of Bogacki and Shampine.
/// Lengths in mm, positions and velocities (per mm) in voxels of the box.
struct StepLanes {
  Lanes x{}, velocity{};  ///< where each step begins
  Lane step{};
  std::array<std::int32_t, kBeside> home{};  ///< tissue voxel that tells the side
  int count = 0;                             ///< lanes that are taken, the first ones
  double uphill = 1;                         ///< 1 or -1

  Lanes k2{}, k3{}, k4{}, end{};
  Lane slope{}, error{}, u{};                   ///< at the end; error in voxels
  std::array<std::int32_t, kBeside> cell{};     ///< at the end, box voxel of its lowest corner
  std::array<std::int32_t, kBeside> nearest{};  ///< at the end, the corner, a bit an axis
  std::array<std::int32_t, kBeside> endHome{};  ///< of odd cells; else -2 where there is tissue
  std::array<bool, kBeside> divided{};          ///< as Odd's, at the end
  std::array<bool, kBeside> lost{};             ///< a stage found no tissue
};

/// Of each lane that is taken, what the step does; no lane's result depends on another's.  The same
/// numbers on every processor.
void tryStep(const FieldView& view, StepLanes& lanes);

}  // namespace explica::correspondence
