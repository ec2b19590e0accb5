// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Volume.h"

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace explica::sampling {

/// How values between voxel centres follow from the voxels.
enum class Interpolation {
  Nearest,  ///< the voxel in which the point lies
  Linear,   ///< trilinear, from 8 voxels
  Cubic     ///< cubic convolution with a = -1/2, from 64 voxels; exact for quadratic functions
            ///< [Keys1981]
};
constexpr auto enumWords(Interpolation) {
  using enum Interpolation;
  return std::to_array<EnumWord<Interpolation>>(
      {{Nearest, "nearest"}, {Linear, "linear"}, {Cubic, "cubic"}});
}

/// The label of a point at which no label is known.
inline constexpr Label kNoLabel = std::numeric_limits<Label>::lowest();

/// Values of volumes at points: prepared once for a grid and its points, then used for any number
/// of frames.
///
/// A voxel is not known where it lies outside the grid or the mask, or holds NaN or infinity.  A
/// point is known if the voxels that are carry at least half of its trilinear weight; those that
/// are not are left out and the weights of the others are scaled to 1.  So the border of what is
/// known runs between voxel centres, and a value is never mixed with a made-up one.  Cubic
/// interpolation falls back to linear where one of its 64 voxels is not known.  A nearest voxel is
/// known or not.
class Sampler {
 public:
  /// Frames that are taken together at best.
  static constexpr int kFramesAtOnce = 16;

  /// @param points  P x 3, in the world of `grid`, mm; not finite: not known
  /// @param mask    on the same grid: voxels that are 0 are not known
  /// @throws InvalidInput  a mask of another size
  Sampler(const Grid& grid, const Positions& points,
          Interpolation interpolation = Interpolation::Linear,
          const Volume<std::uint8_t>* mask = nullptr);

  /// Values of one or several frames.
  /// @param frames  F x voxels, frame after frame, each as a Volume's data
  /// @return F x P, frame after frame; NaN where not known
  /// @throws InvalidInput  not a whole number of frames
  ///
  /// Does not depend on the number of threads.
  [[nodiscard]] std::vector<float> sample(std::span<const float> frames) const;

  /// The label that carries the most weight among the known voxels; of equal ones that of the
  /// nearest voxel.  kNoLabel where not known.
  [[nodiscard]] std::vector<Label> sampleLabels(std::span<const Label> labels) const;

  [[nodiscard]] std::size_t pointCount() const { return corners_.size(); }

 private:
  struct Corner {
    std::array<std::int32_t, 3> voxel;  ///< lowest of the 8 voxels about the point; may be -1
    std::array<float, 3> fraction;      ///< of the way to the next voxel, in [0, 1)
    bool inside;                        ///< one of the 8 voxels is in the grid
  };

  /// Fills chunks_.
  void orderChunks();
  template <int F>
  void sampleBlock(const float* values, const std::uint8_t* whole, std::size_t frameCount,
                   std::vector<float>& result, std::size_t firstFrame) const;
  template <int F>
  void sampleOne(const Corner& corner, const float* values, const std::uint8_t* whole,
                 int frameCount, float* to) const;
  template <int F>
  void cubic(const Corner& corner, const float* values, float* to) const;
  template <int F>
  void linear(const Corner& corner, const float* values, float* to) const;
  void linearOfKnown(const Corner& corner, const float* values, int frameCount, float* to) const;
  void cubicOfKnown(const Corner& corner, const float* values, int frameCount, float* to) const;
  void nearest(const Corner& corner, const float* values, int frameCount, float* to) const;
  [[nodiscard]] bool allKnown(const Corner& corner, const std::uint8_t* whole, int reach) const;
  [[nodiscard]] bool masked(std::size_t voxel) const { return !mask_.empty() && mask_[voxel] == 0; }

  Grid grid_;
  Interpolation interpolation_;
  std::vector<Corner> corners_;
  /// Runs of points in the order in which they are taken: neighbours in the volume after each
  /// other, so that points of a column at all its depths find their voxels at hand.
  std::vector<std::uint32_t> chunks_;
  std::vector<std::uint8_t> mask_;
};

/// Values of one volume at points, as Sampler.
[[nodiscard]] std::vector<float> sampleVolume(const Volume<float>& volume, const Positions& points,
                                              Interpolation interpolation = Interpolation::Linear,
                                              const Volume<std::uint8_t>* mask = nullptr);

}  // namespace explica::sampling
