// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Registration/Sessions.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Registration/AffineRegistration.h"
#include "Explica/Registration/HeadTransform.h"
#include "Filters.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::registration {
namespace {

using Motion = Eigen::Isometry3d;
constexpr std::array kSpacings = {6.0, 3.0, 1.5};  // mm, of a human head: folds show at the last
constexpr int kMostSteps = 30;                     // of a level
constexpr double kSmallStep =
    1e-3;  // mm at kHeadRadius: less than what a border's place is known to
constexpr double kHeadRadius = 100;  // mm
constexpr double kTukey = 4.685;     // deviations: 95 % efficient for normal noise [Holland1977]
constexpr int kUnknowns = 7;         // translation, rotation, logarithm of the gain
constexpr double kSmallestSpacing = 0.5;  // mm: finer voxels say no more of a cortex

/// Its square root: half of the way.
Motion halfOf(const Motion& motion) {
  const Eigen::AngleAxisd turn(motion.linear());
  const Eigen::Matrix3d half =
      Eigen::AngleAxisd(0.5 * turn.angle(), turn.axis()).toRotationMatrix();
  Motion result = Motion::Identity();
  result.linear() = half;
  result.translation() = (Eigen::Matrix3d::Identity() + half).inverse() * motion.translation();
  return result;
}

/// Cubes along the world's axes that hold what all sessions show.
Grid commonGrid(const std::vector<Grid>& grids, const std::vector<Motion>& toSession,
                double spacing) {
  Point low = Point::Constant(-kInfinity), high = Point::Constant(kInfinity);
  for (std::size_t s = 0; s < grids.size(); ++s) {
    Eigen::AlignedBox3d box;
    for (int c = 0; c < 8; ++c) {
      const Vector corner((c & 1) * (grids[s].size[0] - 1), (c >> 1 & 1) * (grids[s].size[1] - 1),
                          (c >> 2) * (grids[s].size[2] - 1));
      box.extend(toSession[s].inverse() * grids[s].toWorld(corner));
    }
    low = low.cwiseMax(box.min());
    high = high.cwiseMin(box.max());
  }
  if (!((high - low).minCoeff() > spacing)) {
    throw InvalidInput("sessions: they show no common part of a head");
  }
  Grid grid;
  grid.spacing = Vector::Constant(spacing);
  grid.origin = low;
  for (int a = 0; a < 3; ++a) {
    grid.size[a] = static_cast<int>(std::floor((high[a] - low[a]) / spacing)) + 1;
  }
  return grid;
}

/// The image where the motion takes the grid's voxels.
Volume<float> moved(const Volume<float>& image, const Motion& motion, const Grid& grid) {
  return pulled(image, {Eigen::Affine3d(motion.matrix()), {}}, grid);
}

/// Cubic convolution with a = -1/2 [Keys1981]; what lies outside counts as the border's value, and
/// as 0 beyond half a voxel.
float cubicAt(const Volume<float>& image, const Vector& index) {
  const auto& size = image.grid.size;
  std::array<std::array<int, 4>, 3> at{};
  std::array<std::array<float, 4>, 3> weight{};
  for (int a = 0; a < 3; ++a) {
    if (!(index[a] > -0.5 && index[a] < size[a] - 0.5)) return 0;
    const int low = static_cast<int>(std::floor(index[a]));
    const auto t = static_cast<float>(index[a] - low);
    weight[a] = {t * (t * (1 - 0.5F * t) - 0.5F), 1 + t * t * (1.5F * t - 2.5F),
                 t * (0.5F + t * (2 - 1.5F * t)), 0.5F * t * t * (t - 1)};
    for (int n = 0; n < 4; ++n) at[a][n] = std::clamp(low - 1 + n, 0, size[a] - 1);
  }
  float sum = 0;
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 4; ++j) {
      float row = 0;
      for (int i = 0; i < 4; ++i) row += weight[0][i] * image(at[0][i], at[1][j], at[2][k]);
      sum += weight[1][j] * weight[2][k] * row;
    }
  }
  return sum;
}

/// Both images halfway, and what is seen of a head there.
struct Halfway {
  Volume<float> a, b;
  std::vector<std::size_t> head;  ///< inner voxels brighter than the mean
};

Halfway halfwayOf(const std::array<Volume<float>, 2>& images, const Motion& motion) {
  const Motion half = halfOf(motion);
  const Grid grid = commonGrid({images[0].grid, images[1].grid}, {half.inverse(), half},
                               images[0].grid.spacing[0]);
  Halfway halfway{moved(images[0], half.inverse(), grid), moved(images[1], half, grid), {}};
  double sum = 0;
  for (std::size_t v = 0; v < halfway.a.size(); ++v) sum += halfway.a[v] + halfway.b[v];
  const auto mean = static_cast<float>(sum / static_cast<double>(halfway.a.size()));
  for (std::size_t v = 0; v < halfway.a.size(); ++v) {
    if (halfway.a[v] + halfway.b[v] <= mean) continue;
    const auto at = grid.subscripts(v);
    bool inner = true;
    for (int a = 0; a < 3; ++a) inner = inner && at[a] > 0 && at[a] + 1 < grid.size[a];
    if (inner) halfway.head.push_back(v);
  }
  if (halfway.head.size() < 100) throw InvalidInput("sessions: they show no common part of a head");
  return halfway;
}

double correlationOf(const Halfway& halfway) {
  Eigen::ArrayXd a(static_cast<Eigen::Index>(halfway.head.size())), b(a.size());
  for (Eigen::Index n = 0; n < a.size(); ++n) {
    a[n] = halfway.a[halfway.head[n]];
    b[n] = halfway.b[halfway.head[n]];
  }
  a -= a.mean();
  b -= b.mean();
  return (a * b).sum() / std::sqrt(a.square().sum() * b.square().sum());
}

/// Normal equations of a Gauss-Newton step.
struct Normal {
  Eigen::Matrix<double, kUnknowns, kUnknowns> matrix =
      Eigen::Matrix<double, kUnknowns, kUnknowns>::Zero();
  Eigen::Matrix<double, kUnknowns, 1> vector = Eigen::Matrix<double, kUnknowns, 1>::Zero();
  Normal& operator+=(const Normal& other) {
    matrix += other.matrix;
    vector += other.vector;
    return *this;
  }
};

/// 1.4826 of the median of absolute differences: the deviation, were they normal.
double deviationOf(const Halfway& halfway, double gain) {
  std::vector<float> off;
  off.reserve(halfway.head.size());
  for (const std::size_t v : halfway.head) {
    off.push_back(std::abs(halfway.a[v] - static_cast<float>(gain) * halfway.b[v]));
  }
  return 1.4826 * upperMedian(std::move(off));
}

/// The step (translation, rotation about the centre, logarithm of the gain) that lowers the
/// weighted sum of (a - gain b)^2 when each image moves by half of it, in opposite directions.
Eigen::Matrix<double, kUnknowns, 1> stepOf(const Halfway& halfway, double gain,
                                           const Point& centre) {
  const double deviation = deviationOf(halfway, gain);
  const Grid& grid = halfway.a.grid;
  const double rise = 0.25 / grid.spacing[0];  // mean of both images, over two voxels
  const std::array<std::size_t, 3> next = {1, static_cast<std::size_t>(grid.size[0]),
                                           static_cast<std::size_t>(grid.size[0]) * grid.size[1]};
  const auto both = [&](std::size_t v) { return halfway.a[v] + gain * halfway.b[v]; };
  const Normal sum =
      parallelSum(halfway.head.size(), 1 << 14, Normal{}, [&](std::size_t begin, std::size_t end) {
        Normal part;
        for (std::size_t n = begin; n < end; ++n) {
          const std::size_t v = halfway.head[n];
          const double residual = halfway.a[v] - gain * halfway.b[v];
          const double off = deviation > 0 ? residual / (kTukey * deviation) : 0;
          if (off * off >= 1) continue;
          const double weight = (1 - off * off) * (1 - off * off);
          Vector slope;
          for (int a = 0; a < 3; ++a) slope[a] = rise * (both(v + next[a]) - both(v - next[a]));
          const auto [i, j, k] = grid.subscripts(v);
          const Vector arm = grid.toWorld(Vector(i, j, k)) - centre;
          Eigen::Matrix<double, kUnknowns, 1> row;
          row << slope, arm.cross(slope), gain * halfway.b[v];
          part.matrix += weight * row * row.transpose();
          part.vector += weight * residual * row;
        }
        return part;
      });
  return sum.matrix.ldlt().solve(sum.vector);
}

Motion motionOf(const Vector& translation, const Vector& rotation, const Point& centre) {
  Motion motion = Motion::Identity();
  const double angle = rotation.norm();
  if (angle > 0) motion.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  motion.translation() = centre + translation - motion.linear() * centre;
  return motion;
}

/// The rotation nearest to a's affine map onto b; the head's centre goes where it does.
Motion startOf(const Volume<float>& a, const Volume<float>& b, const Monitor& monitor) {
  const Volume<float> head = headOf(a);
  const Eigen::Affine3d found = registerAffine(b, a, head, Pose::Upright, monitor).templateToImage;
  const Point centre = centreOf(head);
  Motion motion = Motion::Identity();
  motion.linear() = found.rotation();
  motion.translation() = found * centre - motion.linear() * centre;
  return motion;
}

}  // namespace

RigidRegistration registerRigidly(const Volume<float>& a, const Volume<float>& b,
                                  const Monitor& monitor) {
  RigidRegistration result;
  result.motion = startOf(a, b, monitor);
  for (const double spacing : kSpacings) {
    const std::array<Volume<float>, 2> images = {inCubes(a, spacing), inCubes(b, spacing)};
    for (int n = 0; n < kMostSteps; ++n) {
      checkpoint(monitor);
      const Halfway halfway = halfwayOf(images, result.motion);
      const Point centre = centreOf(halfway.a);
      const auto step = stepOf(halfway, result.gain, centre);
      const Motion half = halfOf(result.motion);
      result.motion = half * motionOf(step.head<3>(), step.segment<3>(3), centre) * half;
      result.motion.linear() = Eigen::Quaterniond(result.motion.linear()).toRotationMatrix();
      result.gain *= std::exp(step[6]);
      result.correlation = correlationOf(halfway);
      if (step.head<3>().norm() + kHeadRadius * step.segment<3>(3).norm() < kSmallStep) break;
    }
  }
  return result;
}

SessionAverage averageSessions(const std::vector<Volume<float>>& sessions, const Monitor& monitor) {
  if (sessions.size() < 2) throw InvalidInput("sessions: an average is of two at least");
  const auto count = static_cast<double>(sessions.size());
  SessionAverage average;
  std::vector<Motion> fromFirst = {Motion::Identity()};
  std::vector<float> gains = {1};
  for (std::size_t s = 1; s < sessions.size(); ++s) {
    monitor.progress(static_cast<double>(s) / count, "session " + std::to_string(s + 1));
    const RigidRegistration found = registerRigidly(sessions[0], sessions[s], monitor);
    fromFirst.push_back(found.motion);
    gains.push_back(static_cast<float>(found.gain));
    average.leastCorrelation = std::min(average.leastCorrelation, found.correlation);
  }
  const Point centre = centreOf(headOf(sessions[0]));
  Eigen::Vector4d turn = Eigen::Vector4d::Zero();
  Point place = Point::Zero();
  for (const Motion& motion : fromFirst) {
    const Eigen::Quaterniond q(motion.linear());
    turn += q.coeffs() * (q.w() < 0 ? -1 : 1);
    place += motion * centre / count;
  }
  Motion mean = Motion::Identity();
  mean.linear() = Eigen::Quaterniond(turn.normalized()).toRotationMatrix();
  mean.translation() = place - mean.linear() * centre;

  double spacing = kInfinity;
  std::vector<Grid> grids;
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    average.toSession.push_back(fromFirst[s] * mean.inverse());
    grids.push_back(sessions[s].grid);
    spacing = std::min(spacing, grids[s].spacing.minCoeff());
  }
  const Grid grid = commonGrid(grids, average.toSession, std::max(spacing, kSmallestSpacing));
  average.mean = Volume<float>(grid);
  for (std::size_t s = 0; s < sessions.size(); ++s) {
    checkpoint(monitor);
    Volume<float> session(grid);
    parallelFor(session.size(), [&](std::size_t v) {
      const auto [i, j, k] = grid.subscripts(v);
      const Point at = average.toSession[s] * grid.toWorld(Vector(i, j, k));
      session[v] = gains[s] * cubicAt(sessions[s], sessions[s].grid.toIndex(at));
      average.mean[v] += session[v] / static_cast<float>(count);
    });
    average.sessions.push_back(std::move(session));
  }
  return average;
}

}  // namespace explica::registration
