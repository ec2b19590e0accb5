// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <array>
#include <complex>
#include <vector>

namespace explica::flattening {

using FlatPositions = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;  ///< V x 2, mm

/// Of the way to the first face without area, in one step: of searches in the plane and on the
/// sphere.
inline constexpr double kShareOfWay = 0.8;

/// A triangulated surface known by its edge lengths alone.
struct IntrinsicMesh {
  Faces faces;        ///< F x 3
  Positions lengths;  ///< F x 3, mm: entry k is the edge of corners k and (k + 1) % 3
  Eigen::Index vertexCount = 0;
};

[[nodiscard]] IntrinsicMesh intrinsicOf(const TriangleMesh& mesh);

/// How a face's shape constrains the map: its area and the gradients of its three corner functions
/// in its own plane, as complex numbers (1/mm).
struct RestFace {
  double area = 0;
  std::array<std::complex<double>, 3> gradient;
};

/// Rest shape of one face from its edge lengths, the first from corner 0 to corner 1.
[[nodiscard]] RestFace restFace(const std::array<double, 3>& lengths, double smallestHeight,
                                bool* raised = nullptr);

/// Rest shapes of all faces.  A face lower than `smallestHeight` mm is given that height, so that
/// needles have a shape at all; `raised`, if given, receives their number.
[[nodiscard]] std::vector<RestFace> restFaces(const IntrinsicMesh& mesh, double smallestHeight,
                                              std::size_t* raised = nullptr);

/// Value and derivatives of an isotropic energy density of a linear map of the plane.
///
/// Written as z -> p z + q conj(z), the map has singular values |p| + |q| and |p| - |q| and
/// determinant |p|^2 - |q|^2, so that any isotropic density is a function of P = |p| and Q = |q|.
struct Density {
  double value = 0;
  double dP = 0, dQOverQ = 0;  ///< the latter is finite at Q = 0
  double dPP = 0, dPQ = 0, dQQ = 0;
};

/// Density of the flat map:
///
///     psi = 2 (P - 1)^2 + 2 Q^2  +  2 (D + 1/D - 2)  +  w (sqrt(e^2 + (D - 1)^2) - e),
///     D = P^2 - Q^2,  e = 0.006.
///
/// The first two terms are |J - R|^2, the squared distance from the nearest rotation (lengths); the
/// third is infinite where a face would vanish; the last is w times the absolute area error beyond
/// e.  Of all maps with one mean area error, the absolute value finds the one that keeps lengths
/// best: it gives up areas in few faces, where that helps most.
/// @param areaWeight  w >= 0
/// @return value +infinity where D <= 0
[[nodiscard]] Density mapDensity(double p, double q, double areaWeight);

/// The smallest positive root of a + b t + c t^2 with a > 0, or infinity: when a face vanishes.
[[nodiscard]] double firstRoot(double a, double b, double c);

/// Sum over faces of area times density, over the total area; without unit.
class MapEnergy {
 public:
  MapEnergy(const IntrinsicMesh& mesh, double areaWeight, double smallestHeight,
            std::vector<double> faceWeights = {});

  /// +infinity if a face is turned over or has no area.
  [[nodiscard]] double value(const FlatPositions& flat) const;

  /// Gradient with respect to the flat positions, V x 2, 1/mm.
  [[nodiscard]] FlatPositions gradient(const FlatPositions& flat) const;

  /// What a face adds: gradient and Hessian with respect to its corners x0 y0 x1 y1 x2 y2.
  struct FaceTerm {
    Eigen::Matrix<double, 6, 1> gradient;
    Eigen::Matrix<double, 6, 6> hessian;
  };
  /// @param convex  project the Hessian onto the positive semi-definite ones, in closed form: its
  ///                eigenvectors are the directions of |p|, |q| and of their arguments
  [[nodiscard]] FaceTerm faceTerm(const FlatPositions& flat, Eigen::Index face, bool convex) const;

  /// Largest share in (0, 1] of a step that leaves every face with at least a fifth of the area it
  /// would have to lose to vanish.
  [[nodiscard]] double largestStep(const FlatPositions& flat, const FlatPositions& step) const;

  [[nodiscard]] const Faces& faces() const { return faces_; }
  [[nodiscard]] const std::vector<RestFace>& rest() const { return rest_; }
  void setAreaWeight(double weight) { areaWeight_ = weight; }

 private:
  Faces faces_;
  std::vector<RestFace> rest_;
  std::vector<double> weight_;  ///< share of each face in the sum
  double areaWeight_;
};

}  // namespace explica::flattening
