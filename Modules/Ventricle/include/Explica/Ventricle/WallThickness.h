// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Correspondence/Ribbon.h"
#include "Explica/Ventricle/LongAxis.h"
#include "Explica/Ventricle/SliceAlignment.h"

#include <array>
#include <vector>

namespace explica::ventricle {

/// Why a voxel of the wall has no part in means.
enum class LeftOut : std::uint8_t {
  None,       ///< it has
  Opening,    ///< within a wall's thickness of a gap in the ring: the outflow tract
  Valve,      ///< in a slice that the valve plane cuts, or beyond the cavity's basal end
  Cap,        ///< apical cap of thick slices: no cavity in the slice, or the wall lies too flat
  Unreached,  ///< its trajectory does not arrive
};
constexpr auto enumWords(LeftOut) {
  using enum LeftOut;
  return std::to_array<EnumWord<LeftOut>>({{None, "none"},
                                           {Opening, "opening"},
                                           {Valve, "valve"},
                                           {Cap, "cap"},
                                           {Unreached, "unreached"}});
}

/// How thickness is measured.
enum class WallMethod {
  Automatic,  ///< by slice where slices are three times as thick as pixels and more, else in space
  Slices,
  Space
};
constexpr auto enumWords(WallMethod) {
  using enum WallMethod;
  return std::to_array<EnumWord<WallMethod>>(
      {{Automatic, "auto"}, {Slices, "slices"}, {Space, "space"}});
}

struct WallOptions {
  WallMethod method = WallMethod::Automatic;
};

template <class Visitor>
void describe(WallOptions& options, Visitor&& visit) {
  visit(Field{"measure", "",
              "thickness slice by slice, corrected for how obliquely the slice cuts the wall, or "
              "in space (auto: by slice where slices are three times as thick as pixels)"},
        options.method);
}

/// Thickness of a frame's wall, per tissue number of `annulus`.
struct WallThickness : correspondence::Ribbon {
  correspondence::Correspondence correspondence;
  bool bySlice = false;
  std::vector<double> plain;      ///< mm, length of the trajectory: within the slice if by slice
  std::vector<double> thickness;  ///< mm, by slice corrected for obliquity, else as plain
  std::vector<LeftOut> leftOut;
  std::vector<Slice> slices;
  Volume<std::uint8_t> reasons;  ///< LeftOut of every wall voxel of the grid; 255 elsewhere

  [[nodiscard]] bool counts(std::size_t n) const { return leftOut[n] == LeftOut::None; }
};

/// Thickness of the wall of one frame.
///
/// By slice: trajectories of the two-dimensional harmonic function say which places of the two
/// boundaries face a voxel; the thickness there is the sum of its distances from both boundaries as
/// they go on across the neighbouring slices (Obliquity.h), which for parallel straight boundaries
/// is the length within the slice times the cosine of their slope.  Slices are aligned first: a
/// jump between breath holds is no slope.  In space: trajectories of the three-dimensional
/// function; what lies beyond the plane through the cavity's contacts with the outside (the valve
/// plane) is insulated.
/// @param heart  with this module's labels
/// @param axis   with the ends of this frame's cavity
/// @param alignment  of the slices, from all frames (alignSlices)
/// @throws InvalidInput  no wall, or none that lies between cavity and outside
[[nodiscard]] WallThickness measureWall(const Volume<Label>& heart, const LongAxis& axis,
                                        const SliceAlignment& alignment,
                                        const WallOptions& options = {},
                                        const Monitor& monitor = {});

/// Means over columns: every voxel counts by 1 / thickness, so that a column counts once however
/// thick it is.
class ColumnMean {
 public:
  void add(double thickness, double plain);
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double mean() const;
  [[nodiscard]] double plain() const;
  [[nodiscard]] double deviation() const;
  [[nodiscard]] double lowest() const { return count_ > 0 ? lowest_ : kNaN; }
  [[nodiscard]] double highest() const { return count_ > 0 ? highest_ : kNaN; }

 private:
  std::size_t count_ = 0;
  double columns_ = 0, plainColumns_ = 0, sum_ = 0, lowest_ = kInfinity, highest_ = 0;
};

}  // namespace explica::ventricle
