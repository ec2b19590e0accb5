// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Flatten.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/StateFile.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Stopwatch.h"
#include "Explica/Flattening/RimContact.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/Predicates.h"
#include "LayFlat.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::flattening {
namespace {

/// Mean of |area / area of the reference - 1| over the surface's faces, those of no area left out.
double meanAreaError(const Disc& disc, const FlatPositions& flat) {
  const Eigen::VectorXd areas = geometry::faceAreas(disc.mesh);
  double sum = 0;
  for (Eigen::Index f = 0; f < disc.mesh.faceCount(); ++f) {
    if (!(areas[f] > 0)) continue;
    const auto a = flat.row(disc.mesh.faces(f, 0));
    const Eigen::RowVector2d u = flat.row(disc.mesh.faces(f, 1)) - a;
    const Eigen::RowVector2d v = flat.row(disc.mesh.faces(f, 2)) - a;
    sum += std::abs((u[0] * v[1] - u[1] * v[0]) / (2 * areas[f]) - 1);
  }
  return sum / static_cast<double>(disc.mesh.faceCount());
}

FlatPositions rounded(const FlatPositions& flat) {
  return flat.cast<float>().cast<double>();
}

void centre(FlatPositions& flat, Eigen::Index count) {
  flat.rowwise() -= flat.topRows(count).colwise().mean();
}

/// The turn after which an axis of the reference points up as well as it can.
Eigen::Matrix2d turnUp(const Disc& disc, const FlatPositions& flat) {
  constexpr double kLeast = 0.3;  // of a unit gradient: below it the piece lies across the axis
  const Eigen::Index count = disc.mesh.vertexCount();
  const FlatPositions known = flat.topRows(count);
  const Eigen::Matrix2d moments = known.transpose() * known;
  Eigen::Matrix2d turn = Eigen::Matrix2d::Identity();  // rows of the new frame: right of up, and up
  for (const int axis : {2, 1}) {
    const Eigen::VectorXd height =
        disc.mesh.positions.col(axis).array() - disc.mesh.positions.col(axis).mean();
    const Eigen::Vector2d slope = moments.inverse() * (known.transpose() * height);
    if (!(slope.norm() > kLeast) && axis == 2) continue;
    if (!(slope.norm() > 0)) return turn;
    const Eigen::Vector2d up = slope.normalized();
    turn << up.y(), -up.x(), up.x(), up.y();
    return turn;
  }
  return turn;
}

/// Centred, turned, and as it is written.
FlatPositions placed(const Disc& disc, FlatPositions flat, const Eigen::Matrix2d& turn) {
  centre(flat, disc.mesh.vertexCount());
  flat = (flat * turn.transpose()).eval();
  return rounded(flat.topRows(disc.mesh.vertexCount()));
}

void requireInRange(const FlattenOptions& options) {
  const auto positive = [](const char* name, double value) {
    if (!(value > 0) || !std::isfinite(value)) {
      throw InvalidInput(std::string(name) + ": must be above 0");
    }
  };
  positive("area-tolerance", options.areaTolerance);
  positive("contact-range", options.contactRange);
  positive("tolerance", options.tolerance);
  positive("max-iterations", options.maxIterations);
  if (options.frames < 0) throw InvalidInput("frames: must not be negative");
}

}  // namespace

std::uint64_t sumOver(const Disc& disc) {
  const auto bytes = [](const auto& m) {
    return std::string_view(reinterpret_cast<const char*>(m.data()),
                            static_cast<std::size_t>(m.size()) * sizeof(*m.data()));
  };
  return checkSum(bytes(disc.mesh.faces), checkSum(bytes(disc.mesh.positions)));
}

std::int64_t countTurnedOver(const Faces& faces, const FlatPositions& flat) {
  std::int64_t count = 0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    count +=
        geometry::orientation(flat.row(faces(f, 0)).transpose(), flat.row(faces(f, 1)).transpose(),
                              flat.row(faces(f, 2)).transpose()) <= 0;
  }
  return count;
}

FlatMap flatten(const Disc& disc, const FlattenOptions& options, const Monitor& monitor,
                const FlattenState* resume) {
  requireInRange(options);
  if (!(geometry::totalArea(disc.mesh) > 0)) {
    throw InvalidInput("surface: it has no area, so that nothing can be kept");
  }
  const std::uint64_t sum = sumOver(disc);
  if (resume != nullptr && resume->level >= 0 && resume->disc != sum) {
    throw InvalidInput("state: it belongs to another surface, or to other cuts");
  }
  const IntrinsicDisc piece = intrinsicDisc(disc);
  const auto areaError = [&](const FlatPositions& flat) { return meanAreaError(disc, flat); };
  Laid laid = layFlat(piece, areaError, options, monitor, resume);
  const StopScope kept(nullptr);
  FlatMap map;
  map.energy = laid.energy;
  map.iterations = laid.iterations;
  map.termination = laid.termination;
  map.areaWeight = laid.state.areaWeight;
  map.state = std::move(laid.state);
  map.state.disc = sum;
  (void)restFaces(piece.mesh, kNeedleHeight * piece.mesh.lengths.mean(), &map.raisedFaces);
  centre(laid.positions, disc.mesh.vertexCount());
  const Eigen::Matrix2d turn = turnUp(disc, laid.positions);
  for (FlatPositions& frame : laid.frames) {
    map.frames.push_back(placed(disc, std::move(frame), turn));
  }
  map.positions = placed(disc, std::move(laid.positions), turn);
  map.turnedOver = countTurnedOver(disc.mesh.faces, map.positions);
  map.rimCrossings = static_cast<std::int64_t>(rimCrossings(disc.rim, map.positions).size());
  return map;
}

}  // namespace explica::flattening
