// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace explica::harmonic {

/// How far the steps of a mask are believed to be shape.  Chosen so that generated shells and
/// spheroids keep their thickness, which a weak pull does, and that known points of a real cortex
/// have theirs, which wants a strong one.
struct LabelTrust {
  float pull = 10;        ///< to the middle of a link where the boundary is rough, against squared
                          ///< change of curvature in voxels; 3 flattens waves under five voxels
  float smooth = 0.006F;  ///< mean squared change of curvature per voxel from which the pull grows:
                          ///< the steps of a surface with slowly varying curvature leave a third
  float rough = 0.03F;    ///< and at which it is full: three times that from a radius of ten voxels
                          ///< to flat within a voxel
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
  /// One of a link's two chains there: its curvature is own theta + beside[0] theta(0) +
  /// beside[1] theta(1) + constant; all 0 where the chain ends.
  struct Bend {
    std::array<float, 2> beside{};
    std::array<float, 2> nearer{};  ///< 1 / distance to the neighbour
    float own = 0, constant = 0;
    float length = 0;  ///< of arc around the link
  };
  using Bends = std::array<Bend, 2>;
  struct Strip;
  template <int kTerms>
  struct Row;
  enum class Energy { Curvature, Variation };

  [[nodiscard]] std::int32_t find(std::int32_t row, std::int32_t p, int axis) const;
  [[nodiscard]] int axisAt(std::size_t link) const { return at_[link][3]; }
  /// From a link's crossing to that of another, in voxels.
  [[nodiscard]] std::array<float, 4> between(std::size_t link, std::size_t other) const {
    std::array<float, 4> way;
    for (int c = 0; c < 4; ++c) {
      way[c] =
          static_cast<float>(at_[other][c] - at_[link][c]) + (step_[other][c] - step_[link][c]);
    }
    return way;
  }
  void collect(const std::vector<std::uint8_t>& side);
  void join(const std::vector<std::uint8_t>& side);
  void findNormals(const std::vector<std::uint8_t>& side, int smoothings);
  void findCurvatures();
  void findPull(const LabelTrust& trust);
  [[nodiscard]] float curvatureOf(std::size_t link, int chain) const;
  template <int kReach>
  [[nodiscard]] Strip stripFrom(std::size_t link, int chain, int side) const;
  void relax(Energy energy, int iterations);
  /// @tparam kChains  on which a crossing lies
  /// @tparam kReach  of a row of the energy's Hessian along a chain, in links each way
  template <int kChains, int kReach>
  void relaxRows(int iterations);
  template <int kChains, int kReach>
  [[nodiscard]] Row<2 * kChains * kReach> rowOf(std::size_t link) const;

  std::array<int, 3> size_;
  std::array<std::int32_t, 3> strides_;
  int axes_;
  // Links are sorted by voxel, then axis.
  std::vector<std::int32_t> rowStart_;           ///< first link of each row of voxels
  std::vector<std::int32_t> low_;                ///< per link: voxel at its lower end
  std::vector<std::array<std::int32_t, 4>> at_;  ///< its subscripts, then the link's axis
  std::vector<float> theta_;                     ///< per link: place from the lower end
  /// Per link, chain (2) and side (2): the slot of the neighbour that points back, that is
  /// (4 neighbour + 2 chain + side); -1 where the chain ends.
  std::vector<std::array<std::int32_t, 4>> back_;
  /// Per link: from its lower end to its crossing.
  std::vector<std::array<float, 4>> step_;
  /// Per link, outward, unit length in index space, then 0.
  std::vector<std::array<float, 4>> normal_;
  std::vector<Bends> bend_;  ///< per link and chain
  std::vector<float> pull_;  ///< per link, to its middle
};

}  // namespace explica::harmonic
