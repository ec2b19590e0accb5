// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Visibility/GlobalFlow.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/GlobalFlow.h"
#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::visibility {

namespace {

constexpr std::size_t kFlowGrain = 32;  // faces a task: each meets all others

/// A face as the measure sees it.
struct Faces {
  Positions centre, normal;  ///< F x 3; unit
  Eigen::VectorXd area;
};

Faces facesOf(const TriangleMesh& mesh) {
  Faces faces{Positions(mesh.faceCount(), 3), Positions(mesh.faceCount(), 3),
              Eigen::VectorXd(mesh.faceCount())};
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const Vector a = mesh.positions.row(mesh.faces(f, 0)), b = mesh.positions.row(mesh.faces(f, 1)),
                 c = mesh.positions.row(mesh.faces(f, 2));
    const Vector cross = 0.5 * (b - a).cross(c - a);
    faces.centre.row(f) = (a + b + c).transpose() / 3;
    faces.area[f] = cross.norm();
    faces.normal.row(f) = cross.transpose() / std::max(faces.area[f], 1e-300);
  }
  return faces;
}

/// A step that rises smoothly over [0, width], and its slope.
struct SoftStep {
  double value = 0, slope = 0;
  SoftStep(double c, double width) {
    if (c <= 0) return;
    const double t = c / width;
    value = t >= 1 ? 1 : t * t * (3 - 2 * t);
    slope = t >= 1 ? 0 : 6 * t * (1 - t) / width;
  }
};

/// What one face has of the measure, and the measure's derivatives by its area vector and centre.
struct Share {
  double value = 0;
  Vector byArea = Vector::Zero(), byCentre = Vector::Zero();
};

/// Adds the pair (i, j) as i sees it: i's plane has j before it (`looking`), or j's has i.
void addPair(const Faces& faces, Eigen::Index i, Eigen::Index j, bool looking, double width,
             Share& share) {
  const Vector d = (faces.centre.row(j) - faces.centre.row(i)).transpose();
  const double length = d.norm();
  if (!(length > 0)) return;
  const Vector unit = d / length, ni = faces.normal.row(i), nj = faces.normal.row(j);
  // The measure's d goes from the face that looks to the one that hides.
  const double sign = looking ? 1 : -1, ci = sign * ni.dot(unit), cj = sign * nj.dot(unit);
  const SoftStep mine(looking ? ci : -ci, width), theirs(looking ? -cj : cj, width);
  const double areas = faces.area[i] * faces.area[j], both = mine.value * theirs.value;
  if (both == 0 && mine.slope * theirs.value == 0 && mine.value * theirs.slope == 0) return;
  if (looking) share.value += areas * both;
  const double byCi = areas * mine.slope * theirs.value * (looking ? 1 : -1);
  const double byCj = areas * mine.value * theirs.slope * (looking ? -1 : 1);
  share.byArea +=
      faces.area[j] * both * ni + byCi / std::max(faces.area[i], 1e-300) * (sign * unit - ci * ni);
  const Vector byUnit = sign * (byCi * ni + byCj * nj);
  share.byCentre -= (byUnit - byUnit.dot(unit) * unit) / length;
}

/// Takes derivatives by a face's area vector and centre to its corners.
void addToCorners(const TriangleMesh& mesh, Eigen::Index f, const Share& share,
                  Positions& gradient) {
  for (int c = 0; c < 3; ++c) {
    const Vector next = mesh.positions.row(mesh.faces(f, (c + 1) % 3)),
                 last = mesh.positions.row(mesh.faces(f, (c + 2) % 3));
    gradient.row(mesh.faces(f, c)) +=
        (0.5 * (next - last).cross(share.byArea) + share.byCentre / 3).transpose();
  }
}

double volumeOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const Vector a = mesh.positions.row(mesh.faces(f, 0)), b = mesh.positions.row(mesh.faces(f, 1)),
                 c = mesh.positions.row(mesh.faces(f, 2));
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

/// A third of the area of each vertex's faces.
Eigen::VectorXd vertexShares(const TriangleMesh& mesh, const Eigen::VectorXd& areas) {
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(mesh.vertexCount());
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int c = 0; c < 3; ++c) shares[mesh.faces(f, c)] += areas[f] / 3;
  }
  return shares;
}

GlobalValue valueOf(const TriangleMesh& mesh, const GlobalFlowOptions& options, const Point& centre,
                    double radius) {
  return options.measure == GlobalMeasure::HiddenArea ? hiddenAreaValue(mesh, centre, radius)
                                                      : softSelfOcclusion(mesh, options.softness);
}

/// Shortest and mean edge.
std::pair<double, double> edgesOf(const TriangleMesh& mesh) {
  double least = kInfinity, sum = 0;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int c = 0; c < 3; ++c) {
      const double length =
          (mesh.positions.row(mesh.faces(f, c)) - mesh.positions.row(mesh.faces(f, (c + 1) % 3)))
              .norm();
      least = std::min(least, length);
      sum += length;
    }
  }
  return {least, sum / (3.0 * static_cast<double>(mesh.faceCount()))};
}

}  // namespace

GlobalValue hiddenAreaValue(const TriangleMesh& mesh, const Point& centre, double radius) {
  const double farthest =
      (mesh.positions.rowwise() - centre.transpose()).rowwise().norm().maxCoeff();
  if (!(farthest < radius)) {
    throw InvalidInput("viewing sphere: the surface reaches " + std::to_string(farthest) +
                       " mm from its centre, beyond the radius of " + std::to_string(radius) +
                       " mm");
  }
  GlobalValue result{0, Positions::Zero(mesh.vertexCount(), 3)};
  const double byArea = 2 * kPi * radius * radius, byVolume = 6 * kPi * radius;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    std::array<Vector, 3> p;
    for (int c = 0; c < 3; ++c) p[c] = mesh.positions.row(mesh.faces(f, c)).transpose() - centre;
    const Vector cross = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]);
    const double area = cross.norm();
    result.value += byArea * area + byVolume * p[0].dot(p[1].cross(p[2])) / 6;
    const Vector normal = cross / std::max(area, 1e-300);
    for (int c = 0; c < 3; ++c) {
      const Vector &next = p[(c + 1) % 3], &last = p[(c + 2) % 3];
      result.gradient.row(mesh.faces(f, c)) +=
          (byArea * 0.5 * (next - last).cross(normal) + byVolume / 6 * next.cross(last))
              .transpose();
    }
  }
  return result;
}

GlobalValue softSelfOcclusion(const TriangleMesh& mesh, double softness) {
  if (!(softness > 0 && softness <= 1)) throw InvalidInput("softness must lie above 0, at most 1");
  const Faces faces = facesOf(mesh);
  const auto count = static_cast<std::size_t>(mesh.faceCount());
  std::vector<Share> shares(count);
  parallelForBlocks(count, kFlowGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        if (j == i) continue;
        const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
        addPair(faces, a, b, true, softness, shares[i]);
        addPair(faces, a, b, false, softness, shares[i]);
      }
    }
  });
  GlobalValue result{0, Positions::Zero(mesh.vertexCount(), 3)};
  for (std::size_t f = 0; f < count; ++f) {
    result.value += shares[f].value;
    addToCorners(mesh, static_cast<Eigen::Index>(f), shares[f], result.gradient);
  }
  return result;
}

GlobalFlow descendGlobalMeasure(const TriangleMesh& mesh, const GlobalFlowOptions& options,
                                const Monitor& monitor) {
  if (options.maxIterations < 1) throw InvalidInput("max-iterations must be positive");
  if (!(options.step > 0 && options.step <= 1)) throw InvalidInput("step must lie between 0 and 1");
  const Point centre = mesh.positions.colwise().mean();
  const double farthest =
      (mesh.positions.rowwise() - centre.transpose()).rowwise().norm().maxCoeff();
  const double meanEdge = edgesOf(mesh).second;
  GlobalFlow flow;
  flow.mesh = mesh;
  flow.radius = kFarAway * farthest;
  flow.termination = Termination::MaxIterations;
  GlobalValue now = valueOf(flow.mesh, options, centre, flow.radius);
  const auto record = [&](int iteration) {
    flow.history.push_back(
        {iteration, now.value, facesOf(flow.mesh).area.sum(), volumeOf(flow.mesh)});
  };
  record(0);
  for (int iteration = 1; iteration <= options.maxIterations; ++iteration) {
    if (monitor.shouldStop()) {
      flow.termination = Termination::Interrupted;
      break;
    }
    const Positions velocity = now.gradient.array().colwise() /
                               vertexShares(flow.mesh, facesOf(flow.mesh).area).array().max(1e-300);
    const double steepest = velocity.rowwise().norm().maxCoeff();
    if (!(steepest > 0) || now.value <= kNothingLeft * flow.history.front().measure) {
      flow.termination = Termination::Converged;
      break;
    }
    const double left = 1 - (iteration - 1.0) / options.maxIterations;
    flow.mesh.positions -= options.step * meanEdge * left / steepest * velocity;
    now = valueOf(flow.mesh, options, centre, flow.radius);
    record(iteration);
    if (edgesOf(flow.mesh).first < kGone * meanEdge) {
      flow.termination = Termination::Stalled;
      break;
    }
    monitor.progress(static_cast<double>(iteration) / options.maxIterations, "descending");
  }
  return flow;
}

}  // namespace explica::visibility
