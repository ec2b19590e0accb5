// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace explica::unfolding {

/// Area ratios of a collar's faces, in the mean and at most, beyond which it has given way; from
/// the first on stretching is held back.
inline constexpr double kCollarMean = 2, kCollarMost = 8;

/// The terms of the objective that an unfolding lowers, mm^2.
///
/// A0 is a face's area at the start, w(A0) the same but less for needles, c = A / A0 - 1 its area
/// error, n its normal, d the mean direction to the viewpoints, s = l / l0 - 1 an edge's strain.
enum class Term {
  Visibility,  ///< sum over the region's faces of w (1 - n . d)
  Area,        ///< sum over the region's faces of w (lambda c + weight/2 c^2), lambda a multiplier
  Spring,    ///< weight times the sum over the region's edges of e r(s), r = s^2 for small strains
  Lift,      ///< weight/2 times the sum of w (deficit / radius)^2, deficit from where it has room
  Guide,     ///< weight times the sum over vertices of a h(way to the vertex's place in a flat map)
  Collar,    ///< weight times the sum over faces that move outside the region, see CollarEnergy
  Overhang,  ///< weight times the sum of what such faces that stand over the region hide of it
  Contact,   ///< weight times the sum over near pairs of barrier(distance), see ContactPotential
  Knot       ///< weight times the double integral of 1 / |x - y|^2, see KnotEnergy
};

/// What the program tells about a term.  Columns of evolution.tsv, checkpoints, inflations and
/// Python's records follow from these rows.
struct TermInfo {
  Term term;
  std::string_view name;  ///< the account's: energy_NAME
  double weight;          ///< its strength where nothing else is said, no unit
  /// Whether a whole closed surface feels it, too (Inflation): it has no surroundings and no map.
  bool closed = true;
};

inline constexpr std::array kTerms = {
    TermInfo{Term::Visibility, "visibility", 1},    TermInfo{Term::Area, "area", 20},
    TermInfo{Term::Spring, "spring", 60},           TermInfo{Term::Lift, "lift", 60, false},
    TermInfo{Term::Guide, "guide", 100, false},     TermInfo{Term::Collar, "collar", 2e-4, false},
    TermInfo{Term::Overhang, "overhang", 1, false}, TermInfo{Term::Contact, "contact", 0.2},
    TermInfo{Term::Knot, "knot", 3e-4, false},
};
inline constexpr std::size_t kTermCount = kTerms.size();
static_assert(
    [] {
      for (std::size_t n = 0; n < kTermCount; ++n) {
        if (static_cast<std::size_t>(kTerms[n].term) != n) return false;
      }
      return true;
    }(),
    "rows stand in the order of Term");

/// One number per term.
struct TermValues {
  std::array<double, kTermCount> values = {};

  [[nodiscard]] constexpr double& operator[](Term term) {
    return values[static_cast<std::size_t>(term)];
  }
  [[nodiscard]] constexpr const double& operator[](Term term) const {
    return values[static_cast<std::size_t>(term)];
  }
  [[nodiscard]] constexpr double sum() const {
    double total = 0;
    for (const double value : values) total += value;
    return total;
  }
};

/// Strengths of the terms; may be changed between steps.
struct UnfoldWeights : TermValues {
  constexpr UnfoldWeights() {
    for (const TermInfo& info : kTerms) (*this)[info.term] = info.weight;
  }
};

}  // namespace explica::unfolding
