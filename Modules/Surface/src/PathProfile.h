// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"
#include "Explica/Geometry/MeshTopology.h"
#include "RibbonPaths.h"

#include <Eigen/Core>

#include <vector>

namespace explica::surface {

/// A trajectory, carried on straight beyond its ends.  Keeps a reference to it.
class Along {
 public:
  explicit Along(const Trajectory& path);
  /// Point at any arc length, mm.
  [[nodiscard]] Point at(double arc) const;

 private:
  const Trajectory& path_;
  double length_;
  Vector inward_ = Vector::Zero(), outward_ = Vector::Zero();  ///< unit ways beyond the ends
};

/// A point of it.
[[nodiscard]] Point along(const Trajectory& path, double arc);

/// The part of a trajectory between two borders; it is carried on straight where they lie beyond
/// its ends.
/// @param from  mm from the trajectory's start, may be negative
/// @param to    mm from its start, > from
[[nodiscard]] Trajectory between(const Trajectory& path, double from, double to);

/// Trilinear value; NaN off the image.
[[nodiscard]] double valueAt(const Volume<float>& image, const Point& p);

/// Median of the finite values; NaN if there is none.
[[nodiscard]] double median(std::vector<double> values);

/// Median length of the trajectories that have one, mm.
[[nodiscard]] double usualLength(const std::vector<Trajectory>& paths);

/// The vertices no more than two edges from one, itself among them, in order.
[[nodiscard]] std::vector<std::int32_t> withinTwoEdges(std::size_t vertex,
                                                       const geometry::MeshTopology& topology);

/// Values at each vertex, side by side.
using VertexRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Means over a vertex and its ring, `times` over; rows that begin with NaN are not known and take
/// no part.
/// @param values  V x any number
[[nodiscard]] VertexRows averaged(VertexRows values, const geometry::MeshTopology& topology,
                                  int times);

/// How often averaged() has to be told for a window of that deviation, mm, on a mesh of edges of
/// that length, mm: each time adds the variance of a vertex and six neighbours, 3/7 of a squared
/// edge in each direction.
[[nodiscard]] int timesFor(double deviation, double edge);

}  // namespace explica::surface
