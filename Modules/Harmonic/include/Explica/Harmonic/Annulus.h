// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/VolumeOnDemand.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace explica::harmonic {

/// What a voxel is to the tissue.
enum class Site : std::uint8_t {
  Tissue,    ///< solved for
  Inner,     ///< enclosed region; u = 0 at its boundary
  Outer,     ///< what lies around; u = 1 at its boundary
  Insulated  ///< neither: no flux crosses into it (cut plane, edge of the field of view)
};

/// Codes that stand for a voxel outside the tissue wherever a tissue number is expected.
inline constexpr std::int32_t kInner = -1, kOuter = -2, kInsulated = -3;

/// How the boundary lies between voxel centres.
enum class BoundaryModel {
  Subvoxel,   ///< where the level sets cross zero: Shortley-Weller stencil
  Staircase,  ///< at the first centre outside: the thesis's baseline
  Embedding   ///< grid values found so that u meets 0 and 1 on the level sets (thesis 3.2)
};
constexpr auto enumWords(BoundaryModel) {
  using enum BoundaryModel;
  return std::to_array<EnumWord<BoundaryModel>>(
      {{Subvoxel, "subvoxel"}, {Staircase, "staircase"}, {Embedding, "embedding"}});
}

/// Directions of a voxel's six links: -i, +i, -j, +j, -k, +k.
[[nodiscard]] constexpr int axisOf(int direction) {
  return direction >> 1;
}
[[nodiscard]] constexpr int signOf(int direction) {
  return (direction & 1) ? 1 : -1;
}
[[nodiscard]] constexpr int opposite(int direction) {
  return direction ^ 1;
}

/// Tissue between an inner and an outer boundary: the tissue's voxels, numbered, and for each of
/// their six links either the neighbour's number or what ends it, and where.
///
/// Only a box around the tissue is stored, one voxel wider than the tissue on each side.  Tissue is
/// numbered in four runs: even (i + j + k of the box) voxels with six tissue neighbours, other even
/// ones, odd ones with six tissue neighbours, other odd ones; each run in storage order.
/// A link may also end between two tissue voxels: there the outer boundary is a sheet without
/// thickness (a buried sulcus).
struct Annulus {
  Grid grid;                             ///< of the whole volume
  std::array<int, 3> first = {0, 0, 0};  ///< voxel of `grid` at the box's (0, 0, 0), may be -1
  std::array<int, 3> size = {0, 0, 0};   ///< voxels of the box along i, j, k
  std::vector<std::int32_t> numberAt;    ///< per box voxel: tissue number, or kInner...
  std::vector<std::int32_t> place;       ///< per tissue number: its box voxel
  std::vector<std::array<std::int32_t, 6>> links;  ///< per tissue number
  std::vector<std::array<float, 6>> fractions;  ///< per irregular voxel: boundary's place on each
                                                ///< link, (0, 1] of the spacing; 1 if not cut
  std::array<std::int32_t, 4> runEnd = {0, 0, 0, 0};
  BoundaryModel model = BoundaryModel::Subvoxel;
  bool planar = false;            ///< slices stand alone: no links along k
  std::size_t droppedVoxels = 0;  ///< tissue that misses one side, left out
  int droppedComponents = 0;
  std::array<int, 3> firstDropped{};  ///< a voxel of `grid` in the first of these pieces
  int components = 0;                 ///< 6-connected pieces of tissue that are solved for
  std::size_t directContacts = 0;     ///< voxel faces where inner and outer region touch
  int holes = 0;  ///< in the tissue, where they do on less area than the tissue is thick
  int ends = 0;   ///< of the tissue, where they do on more: a medial wall, a ventricle's base

  [[nodiscard]] std::size_t count() const { return place.size(); }
  [[nodiscard]] std::array<int, 3> boxSubscripts(std::int32_t number) const {
    const std::int32_t p = place[number];
    const std::int32_t row = p / size[0];
    return {p % size[0], row % size[1], row / size[1]};
  }
  /// Subscripts in `grid` of a tissue voxel.
  [[nodiscard]] std::array<int, 3> voxel(std::int32_t number) const {
    const auto s = boxSubscripts(number);
    return {s[0] + first[0], s[1] + first[1], s[2] + first[2]};
  }
  /// Continuous index in `grid` of a tissue voxel's centre.
  [[nodiscard]] Vector index(std::int32_t number) const {
    const auto s = voxel(number);
    return Vector(s[0], s[1], s[2]);
  }
  [[nodiscard]] Point world(std::int32_t number) const { return grid.toWorld(index(number)); }
  /// Position of a tissue voxel in the storage order of the whole volume.
  [[nodiscard]] std::size_t linear(std::int32_t number) const {
    const auto s = voxel(number);
    return grid.linear(s[0], s[1], s[2]);
  }
  /// Number of the tissue voxel at a voxel of `grid`; negative where there is none.
  [[nodiscard]] std::int32_t numberOf(const std::array<int, 3>& voxel) const {
    std::array<int, 3> s;
    for (int a = 0; a < 3; ++a) {
      s[a] = voxel[a] - first[a];
      if (s[a] < 0 || s[a] >= size[a]) return kInsulated;
    }
    return numberAt[s[0] + size[0] * (s[1] + size[1] * s[2])];
  }
  /// Row of `fractions`, or -1 for a voxel with six uncut links.
  [[nodiscard]] std::int32_t irregular(std::int32_t number) const {
    if (number < runEnd[0]) return -1;
    if (number < runEnd[1]) return number - runEnd[0];
    if (number < runEnd[2]) return -1;
    return number - runEnd[2] + runEnd[1] - runEnd[0];
  }
  [[nodiscard]] std::array<std::int32_t, 3> strides() const {
    return {1, size[0], size[0] * size[1]};
  }
};

/// Whether something at some of all places is to be said: in every good subject a thousandth has
/// it.
[[nodiscard]] constexpr bool isWorthAWarning(std::size_t some, std::size_t all) {
  return 1000 * some > all;
}

/// "(1, 2, 3)"
[[nodiscard]] std::string voxelText(const std::array<int, 3>& voxel);

/// Tissue voxels in the outermost layer of the image, along axes with more than one voxel; of
/// planar tissue within its slices.
[[nodiscard]] std::size_t countAtImageBorder(const Annulus& annulus);

/// Which labels play which part.
struct LabelRoles {
  std::vector<Label> inner;      ///< enclosed region
  std::vector<Label> tissue;     ///< voxels to solve for
  std::vector<Label> outer;      ///< surroundings; empty: every label not named elsewhere
  std::vector<Label> insulated;  ///< no flux crosses into these
};

template <class Visitor>
void describe(LabelRoles& roles, Visitor&& visit) {
  visit(Field{"inner", "", "labels of the enclosed region: white matter, blood pool"}, roles.inner);
  visit(Field{"tissue", "", "labels of the tissue between the two boundaries"}, roles.tissue);
  visit(Field{"outer", "", "labels outside the tissue (default: all other labels)"}, roles.outer);
  visit(Field{"insulated", "", "labels that neither side owns: no flux crosses into them"},
        roles.insulated);
}

/// How boundaries are found.
struct AnnulusOptions {
  BoundaryModel boundary = BoundaryModel::Subvoxel;
  bool openEnds = false;  ///< insulate the planes beyond the tissue's first and last slice
  bool perSlice = false;  ///< every slice on its own, in two dimensions
};

template <class Visitor>
void describe(AnnulusOptions& options, Visitor&& visit) {
  visit(Field{"boundary", "", "where the boundary lies between voxel centres"}, options.boundary);
  visit(Field{"open-ends", "", "insulate the planes beyond the tissue's first and last slice"},
        options.openEnds);
  visit(Field{"per-slice", "", "measure every slice (along k) on its own, in two dimensions"},
        options.perSlice);
}

/// On which side of a level set the enclosed region is.
enum class LevelInside {
  Automatic,  ///< the side that holds the smaller part of the volume's border
  Above,      ///< values above the level, as in a probability map
  Below       ///< values below the level, as in a signed distance
};
constexpr auto enumWords(LevelInside) {
  using enum LevelInside;
  return std::to_array<EnumWord<LevelInside>>(
      {{Automatic, "auto"}, {Above, "above"}, {Below, "below"}});
}

/// How a scalar volume describes a boundary.
struct LevelOptions {
  double level = 0;  ///< value on the boundary
  LevelInside inside = LevelInside::Automatic;
};

/// Annulus of a label volume.  The boundaries are the smoothest surfaces that leave every voxel
/// centre on its own side: of all places between the centres of two neighbouring voxels of
/// different label, those that bend the surface least.
/// Labels that are absent beside others of their role are warned of.
/// @throws InvalidInput  no label of a role is present (the message lists those that are), no
///                       tissue, no inner or outer region, roles that overlap, or no piece of
///                       tissue touches both sides
[[nodiscard]] Annulus annulusFromLabels(const Volume<Label>& labels, const LabelRoles& roles,
                                        const AnnulusOptions& options = {},
                                        const Monitor& monitor = {});

/// The same, which frees the labels as soon as they are read: they are the largest array of a
/// measurement, and the boundaries are made in their place.
[[nodiscard]] Annulus annulusFromLabels(Volume<Label>&& labels, const LabelRoles& roles,
                                        const AnnulusOptions& options = {},
                                        const Monitor& monitor = {});

/// Annulus of two level sets: the tissue is inside the outer and outside the inner one.
/// @param insulated  1 where no flux may enter; empty grid: nowhere
/// @throws InvalidInput  grids differ, a level that is nowhere crossed, or as annulusFromLabels
[[nodiscard]] Annulus annulusFromLevels(const Volume<float>& inner, const Volume<float>& outer,
                                        const LevelOptions& levels = {},
                                        const AnnulusOptions& options = {},
                                        const Volume<std::uint8_t>& insulated = {},
                                        const Monitor& monitor = {});

/// The same of sites.
[[nodiscard]] Annulus annulusFromSites(const Volume<Site>& sites,
                                       const AnnulusOptions& options = {},
                                       const Monitor& monitor = {});

/// Annulus of sites and two level sets in mm, negative inside.  The sites decide; where a level's
/// sign disagrees with a site, the boundary is put halfway along the link.
[[nodiscard]] Annulus annulusFromSites(const Volume<Site>& sites, const Volume<float>& innerLevel,
                                       const Volume<float>& outerLevel,
                                       const AnnulusOptions& options = {},
                                       const Monitor& monitor = {});

/// Where a boundary lies on the link from tissue voxel `voxel` of the grid to the neighbour along
/// axis direction / 2, downwards if that is even: share of the spacing, (0, 1].
/// @param inner  whether it is the inner boundary
using PlaceOnLink =
    std::function<double(const std::array<int, 3>& voxel, int direction, bool inner)>;

/// Annulus of sites whose boundaries are known link by link.
[[nodiscard]] Annulus annulusFromSites(const Volume<Site>& sites, const PlaceOnLink& placeOnLink,
                                       const AnnulusOptions& options = {},
                                       const Monitor& monitor = {});

/// A place where a boundary passes between two neighbouring tissue voxels: what is beyond it is
/// narrower than the link.
struct Cut {
  std::int32_t number = 0;  ///< tissue voxel
  int axis = 0;             ///< the other one is its neighbour along +axis
  double fraction = 0.5;    ///< boundary's place from `number`, in (0, 1)
  double rest = 0.5;        ///< its place from the other one, at most 1 - fraction
  bool inner = false;       ///< whether it is the inner boundary
};

/// The same tissue with more boundary; the numbering changes.
[[nodiscard]] Annulus withCuts(const Annulus& annulus, const std::vector<Cut>& cuts);

/// A field of tissue voxels on the whole volume's grid; `elsewhere` also where it is NaN.  The
/// annulus must outlive what is returned, here and in the next functions.
[[nodiscard]] VolumeOnDemand<float> spread(const Annulus& annulus, std::vector<double> values,
                                           float elsewhere = 0,
                                           std::optional<float> innerValue = {},
                                           std::optional<float> outerValue = {});

/// Labels of tissue voxels on the whole volume's grid; 0 elsewhere.
[[nodiscard]] VolumeOnDemand<Label> spreadLabels(const Annulus& annulus, std::vector<int> values);

/// Points given as offsets from the tissue's voxel centres, RAS mm, on the whole volume's grid; 0
/// elsewhere and where an offset is not finite.
[[nodiscard]] VectorsOnDemand spreadPoints(const Annulus& annulus,
                                           std::vector<Eigen::Vector3f> offsets);

/// 1 at the listed tissue voxels, 0 elsewhere.
[[nodiscard]] VolumeOnDemand<Label> maskOf(const Annulus& annulus,
                                           const std::vector<std::int32_t>& voxels);

/// 1 where a voxel has one of the labels.
[[nodiscard]] Volume<std::uint8_t> maskOf(const Volume<Label>& labels,
                                          const std::vector<Label>& wanted);

}  // namespace explica::harmonic
