// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace explica::harmonic {

/// How far the steps of a mask are believed to be shape.
struct LabelTrust {
  float pull = 3;         ///< to the middle of a link where the boundary is rough, against squared
                          ///< change of curvature in voxels; 3 flattens waves under five voxels
  float smooth = 0.002F;  ///< mean squared change of curvature per voxel from which the pull grows:
                          ///< the steps of a surface with slowly varying curvature leave so much
  float rough = 0.01F;    ///< and at which it is full: from a radius of ten voxels to flat within a
                          ///< voxel
};

/// The smoothest surface between two sides of a voxel mask: where it crosses the grid's links.
///
/// A link whose ends lie on different sides is crossed somewhere between its ends; that is all the
/// mask says.  The crossings in one plane of the grid make chains, and each crossing lies on two of
/// them (on one in two dimensions): a net like [Gibson1998]'s, with nodes on links in place of
/// cells.  First those places between the ends are taken that bend the net least: the sum over
/// chains of the squared curvature along the surface's normal, integrated over arc length.  It has
/// no length scale, so that steps of any width are straightened.  Then those whose curvature
/// varies least [MoretonSequin1992], so that cylinders and spheres cost nothing and convex parts do
/// not shrink.  A pull to the middle of the links, weak where the net is smooth and strong where
/// its curvature varies from voxel to voxel, says how much a link is believed against its
/// neighbours.  The surface never leaves the mask's staircase, and sheets that face each other do
/// not interact.  All in index space: steps are one voxel along every axis, whatever the spacing.
class LabelBoundary {
 public:
  /// @param side  1 inside, 0 outside, 255 unknown (ends the surface); first axis fastest
  /// @param axes  3, or 2: every slice on its own
  LabelBoundary(const std::vector<std::uint8_t>& side, const std::array<int, 3>& size, int axes,
                const LabelTrust& trust = {});

  /// Place on the link between voxel p and its neighbour along +axis, which lie on different sides:
  /// distance from p in voxels, in (0, 1).
  [[nodiscard]] double place(std::int32_t p, int axis) const;

  /// The surface's normal there, outward, of unit length in index space; zero where the link is not
  /// crossed.
  [[nodiscard]] Eigen::Vector3f normal(std::int32_t p, int axis) const;

 private:
  [[nodiscard]] std::int32_t find(std::int32_t p, int axis) const;
  /// From the lower end of a link to that of another, in voxels.
  [[nodiscard]] Eigen::Vector3f offset(std::size_t link, std::size_t other) const;
  void collect(const std::vector<std::uint8_t>& side);
  void join(const std::vector<std::uint8_t>& side);
  void findNormals(const std::vector<std::uint8_t>& side, int smoothings);
  void findCurvatures();
  void findPull(const LabelTrust& trust);
  [[nodiscard]] float curvatureOf(std::size_t link, int chain,
                                  const std::vector<float>& theta) const;
  enum class Energy { Curvature, Variation };
  void relax(Energy energy, int iterations);
  /// @tparam kChains  on which a crossing lies
  template <int kChains>
  void relaxChains(Energy energy, int iterations);

  std::array<int, 3> size_;
  std::array<std::int32_t, 3> strides_;
  int axes_;
  // Links are sorted by voxel, then axis.
  std::vector<std::int32_t> rowStart_;           ///< first link of each row of voxels
  std::vector<std::int32_t> low_;                ///< per link: voxel at its lower end
  std::vector<std::array<std::int32_t, 3>> at_;  ///< its subscripts
  std::vector<std::uint8_t> axis_;               ///< per link
  std::vector<float> theta_;                     ///< per link: place from the lower end
  /// Per link, chain (2) and side (2): the slot of the neighbour that points back, that is
  /// (4 neighbour + 2 chain + side); -1 where the chain ends.
  std::vector<std::array<std::int32_t, 4>> back_;
  std::vector<std::array<float, 3>> normal_;  ///< per link, outward, unit length in index space
  // Curvature = own theta + beside(0) theta(0) + beside(1) theta(1) + constant, per link and chain;
  // all 0 where the chain ends.
  std::vector<std::array<float, 2>> own_, constant_;
  std::vector<std::array<float, 4>> beside_;
  std::vector<std::array<float, 2>> length_;  ///< of arc around the link; 0 where the chain ends
  /// Per link, chain and side: 1 / distance to the neighbour; 0 if either has no curvature.
  std::vector<std::array<float, 4>> stiffness_;
  std::vector<float> pull_;  ///< per link, to its middle
};

}  // namespace explica::harmonic
