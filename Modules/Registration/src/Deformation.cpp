// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Registration/Deformation.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Filters.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::registration {
namespace {

constexpr std::size_t kFieldGrain = 16384;  // elements a task
constexpr double kLargestStep = 0.4;        // voxels, of one update
constexpr double kSmallestStep = 0.04;      // voxels: below, the level is done
constexpr int kPatience = 3;                // iterations without gain before the step is halved
constexpr double kLeastGain = 1e-4;         // of the mean squared correlation
constexpr float kNoContrast = 1e-5f;        // variance of a window, where the images reach about 1

/// A vector field by component, in voxels along the grid's axes.
using Field = std::array<Volume<float>, 3>;

Field zeroField(const Grid& grid) {
  return {Volume<float>(grid, 0.0f), Volume<float>(grid, 0.0f), Volume<float>(grid, 0.0f)};
}

template <class Work>
void forVoxels(std::size_t count, const Work& work) {
  parallelForBlocks(count, kFieldGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) work(v);
  });
}

/// What one resolution compares.
struct FieldLevel {
  Grid grid;
  Volume<float> image;
  Volume<float> moving;  ///< the template, affinely brought
  Volume<float> weight;
};

/// Box of continuous image indices that holds the region, with a margin in mm.
std::pair<Vector, Vector> boxOf(const Grid& image, const Volume<float>& region,
                                const Eigen::Affine3d& imageToTemplate, double margin) {
  const Eigen::Affine3d back = imageToTemplate.inverse();
  Vector low = Vector::Constant(kInfinity);
  Vector high = Vector::Constant(-kInfinity);
  for (std::size_t v = 0; v < region.size(); ++v) {
    if (!(region[v] > 0.01f)) continue;
    const auto [i, j, k] = region.grid.subscripts(v);
    const Vector at = image.toIndex(back * region.grid.toWorld(Vector(i, j, k)));
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  const Vector around = margin * image.spacing.cwiseInverse();
  return {low - around, high + around};
}

FieldLevel makeLevel(const Volume<float>& image, const Volume<float>& inTemplate,
                     const Volume<float>& region, const Eigen::Affine3d& imageToTemplate,
                     double spacing) {
  FieldLevel level;
  // Room for the margins of the coarser grids that are made of this one.
  const auto [low, high] = boxOf(image.grid, region, imageToTemplate, 2 * spacing);
  level.grid = cubicGrid(image.grid, low, high, spacing);
  level.image = resampled(image, level.grid);
  HeadTransform affine;
  affine.affine = imageToTemplate;
  const double present = inTemplate.grid.spacing.minCoeff();
  const double blur = 0.5 * std::sqrt(std::max(0.0, spacing * spacing - present * present));
  level.moving = pulled(smoothed(inTemplate, blur), affine, level.grid);
  level.weight = pulled(smoothed(region, blur), affine, level.grid);
  return level;
}

/// The same at a coarser spacing.
FieldLevel coarser(const FieldLevel& fine, double factor) {
  FieldLevel level;
  const auto& n = fine.grid.size;
  level.grid = cubicGrid(fine.grid, Vector::Zero(), Vector(n[0] - 1, n[1] - 1, n[2] - 1),
                         factor * fine.grid.spacing[0]);
  level.image = resampled(fine.image, level.grid);
  level.moving = resampled(fine.moving, level.grid);
  level.weight = resampled(fine.weight, level.grid);
  return level;
}

/// The volumes at each voxel's displaced place.
template <std::size_t Count>
std::array<Volume<float>, Count> displaced(const std::array<const Volume<float>*, Count>& volumes,
                                           const Field& u) {
  const Grid& grid = u[0].grid;
  std::array<Volume<float>, Count> result;
  for (Volume<float>& one : result) one = Volume<float>(grid);
  forLattice(grid, [&](int i, int j, int k) {
    const std::size_t v = grid.linear(i, j, k);
    const Cell cell(grid, Vector(i + u[0][v], j + u[1][v], k + u[2][v]));
    for (std::size_t c = 0; c < Count; ++c) result[c][v] = cell.of(*volumes[c]);
  });
  return result;
}

Volume<float> displaced(const Volume<float>& volume, const Field& u) {
  return std::move(displaced(std::array{&volume}, u)[0]);
}

/// Squared correlation in windows, and its derivative by the middle's moving value.
struct Windows {
  Volume<float> correlation;
  Volume<float> force;
};

Volume<float> meanProduct(const Volume<float>& a, const Volume<float>& b, int radius) {
  Volume<float> product(a.grid);
  forVoxels(a.size(), [&](std::size_t v) { product[v] = a[v] * b[v]; });
  return boxMean(std::move(product), radius);
}

Windows compare(const Volume<float>& fixed, const Volume<float>& moved, int radius) {
  const Volume<float> meanF = boxMean(fixed, radius);
  const Volume<float> meanM = boxMean(moved, radius);
  const Volume<float> mm = meanProduct(moved, moved, radius);
  Windows windows{meanProduct(fixed, moved, radius), meanProduct(fixed, fixed, radius)};
  forVoxels(fixed.size(), [&](std::size_t v) {
    const float sff = windows.force[v] - meanF[v] * meanF[v];
    const float smm = mm[v] - meanM[v] * meanM[v];
    const float sfm = windows.correlation[v] - meanF[v] * meanM[v];
    if (!(sff > kNoContrast && smm > kNoContrast)) {
      windows.force[v] = windows.correlation[v] = 0;
      return;
    }
    windows.correlation[v] = sfm > 0 ? sfm * sfm / (sff * smm) : 0;
    windows.force[v] =
        2 * sfm / (sff * smm) * ((fixed[v] - meanF[v]) - sfm / smm * (moved[v] - meanM[v]));
  });
  return windows;
}

double weightedMean(const Volume<float>& values, const Volume<float>& weight) {
  using Sums = Eigen::Vector2d;
  const Sums sums = parallelSum(values.size(), kFieldGrain, Sums(Sums::Zero()),
                                [&](std::size_t begin, std::size_t end) {
                                  Sums part = Sums::Zero();
                                  for (std::size_t v = begin; v < end; ++v) {
                                    part += static_cast<double>(weight[v]) * Sums(values[v], 1.0);
                                  }
                                  return part;
                                });
  return sums[1] > 0 ? sums[0] / sums[1] : 0;
}

/// Central differences, one-sided at the border.
float slopeAlong(const Volume<float>& volume, int i, int j, int k, int axis) {
  std::array<int, 3> low = {i, j, k};
  std::array<int, 3> high = {i, j, k};
  low[axis] = std::max(0, low[axis] - 1);
  high[axis] = std::min(volume.grid.size[axis] - 1, high[axis] + 1);
  if (low[axis] == high[axis]) return 0;
  return (volume(high[0], high[1], high[2]) - volume(low[0], low[1], low[2])) /
         static_cast<float>(high[axis] - low[axis]);
}

/// Divides by the length of the longest vector.
void normalise(Field& field) {
  float longest = 0;
  for (std::size_t v = 0; v < field[0].size(); ++v) {
    longest = std::max(
        longest, field[0][v] * field[0][v] + field[1][v] * field[1][v] + field[2][v] * field[2][v]);
  }
  if (!(longest > 0)) return;
  const float scale = 1 / std::sqrt(longest);
  for (auto& component : field) {
    forVoxels(component.size(), [&](std::size_t v) { component[v] *= scale; });
  }
}

/// The smooth direction of gain, its longest vector one voxel.
Field updateOf(const FieldLevel& level, const Volume<float>& moved, const Volume<float>& force,
               double width) {
  Field update = zeroField(level.grid);
  forLattice(level.grid, [&](int i, int j, int k) {
    const std::size_t v = level.grid.linear(i, j, k);
    const float size = level.weight[v] * force[v];
    if (size == 0) return;
    for (int a = 0; a < 3; ++a) update[a][v] = size * slopeAlong(moved, i, j, k, a);
  });
  for (auto& component : update) {
    component = smoothed(std::move(component), width * level.grid.spacing[0]);
  }
  normalise(update);
  return update;
}

/// u after an update v: x goes to x + v + u(x + v).
Field composed(const Field& u, Field v, double step, double width) {
  for (auto& component : v) {
    forVoxels(component.size(), [&](std::size_t n) { component[n] *= static_cast<float>(step); });
  }
  Field result = displaced(std::array{&u[0], &u[1], &u[2]}, v);
  for (int a = 0; a < 3; ++a) {
    forVoxels(result[a].size(), [&](std::size_t n) { result[a][n] += v[a][n]; });
    result[a] = smoothed(std::move(result[a]), width * u[a].grid.spacing[0]);
  }
  return result;
}

/// The field on a finer grid of the same axes.
Field refined(const Field& u, const Grid& grid) {
  Field result;
  const auto ratio = static_cast<float>(u[0].grid.spacing[0] / grid.spacing[0]);
  for (int a = 0; a < 3; ++a) {
    result[a] = volumeBy(grid, [&](const Vector& index) {
      Vector at = u[a].grid.toIndex(grid.toWorld(index));
      for (int b = 0; b < 3; ++b) at[b] = std::clamp(at[b], 0.0, u[a].grid.size[b] - 1.0);
      return ratio * valueAt(u[a], at);
    });
  }
  return result;
}

Field climb(const FieldLevel& level, Field u, const DeformationOptions& options,
            const Monitor& monitor) {
  double step = kLargestStep;
  double best = -1;
  int since = 0;
  Field bestField = u;
  for (int n = 0; n < options.maxIterations && step >= kSmallestStep; ++n) {
    checkpoint(monitor);
    const Volume<float> moved = displaced(level.moving, u);
    const Windows windows = compare(level.image, moved, options.radius);
    const double value = weightedMean(windows.correlation, level.weight);
    if (value > best + kLeastGain) {
      best = value;
      bestField = u;
      since = 0;
    } else if (++since >= kPatience) {
      u = bestField;
      step *= 0.5;
      since = 0;
      continue;
    }
    u = composed(u, updateOf(level, moved, windows.force, options.forceWidth), step,
                 options.fieldWidth);
  }
  return bestField;
}

/// Least determinant of the derivative of x + u(x).
double leastJacobian(const Field& u) {
  const Grid& grid = u[0].grid;
  double least = kInfinity;
  for (int k = 1; k + 1 < grid.size[2]; ++k) {
    for (int j = 1; j + 1 < grid.size[1]; ++j) {
      for (int i = 1; i + 1 < grid.size[0]; ++i) {
        Eigen::Matrix3d derivative = Eigen::Matrix3d::Identity();
        for (int a = 0; a < 3; ++a) {
          for (int b = 0; b < 3; ++b) derivative(a, b) += slopeAlong(u[a], i, j, k, b);
        }
        least = std::min(least, derivative.determinant());
      }
    }
  }
  return least;
}

/// What the image and the template, brought by the field, have in common.
Agreement agreementIn(const FieldLevel& level, const Field& u, int radius) {
  const Windows windows = compare(level.image, displaced(level.moving, u), radius);
  return {weightedMean(windows.correlation, level.weight), leastJacobian(u)};
}

/// The transform's displacement on a grid.
Field fieldOf(const HeadTransform& transform, const Grid& grid) {
  Field u = zeroField(grid);
  const Eigen::Affine3d back = transform.affine.inverse();
  forLattice(grid, [&](int i, int j, int k) {
    const Vector index(i, j, k);
    const Vector there = grid.toIndex(back * transform(grid.toWorld(index))) - index;
    for (int a = 0; a < 3; ++a) u[a](i, j, k) = static_cast<float>(there[a]);
  });
  return u;
}

/// Scaled so that the bright end of the values above 0 is about 1.
Volume<float> normalised(Volume<float> volume) {
  std::vector<float> sorted;
  for (const float value : volume.data) {
    if (value > 0) sorted.push_back(value);
  }
  if (sorted.empty()) throw InvalidInput("T1: holds no value above 0");
  const float scale = 1 / quantileOf(std::move(sorted), 0.99);
  forVoxels(volume.size(),
            [&](std::size_t v) { volume[v] = std::clamp(volume[v] * scale, 0.0f, 2.0f); });
  return volume;
}

}  // namespace

DeformationResult registerDeformation(const Volume<float>& image, const Volume<float>& inTemplate,
                                      const Volume<float>& region,
                                      const Eigen::Affine3d& imageToTemplate,
                                      const DeformationOptions& options, const Monitor& monitor) {
  const Volume<float> bright = normalised(image);
  const Volume<float> brightTemplate = normalised(inTemplate);
  const FieldLevel finest =
      makeLevel(bright, brightTemplate, region, imageToTemplate, options.spacing);
  Field u;
  FieldLevel level;
  int done = 0;
  for (const double factor : {4.0, 2.0, 1.0}) {
    monitor.progress(done++ / 3.0, "registration");
    level = factor > 1 ? coarser(finest, factor) : finest;
    u = u[0].size() == 0 ? zeroField(level.grid) : refined(u, level.grid);
    u = climb(level, std::move(u), options, monitor);
  }
  DeformationResult result;
  result.agreement = agreementIn(level, u, options.radius);
  result.transform.affine = imageToTemplate;
  result.transform.displacement = Volume<Eigen::Vector3f>(level.grid, Eigen::Vector3f::Zero());
  const Eigen::Matrix3f axes =
      (level.grid.direction * level.grid.spacing.asDiagonal()).cast<float>();
  forVoxels(u[0].size(), [&](std::size_t v) {
    result.transform.displacement[v] = axes * Eigen::Vector3f(u[0][v], u[1][v], u[2][v]);
  });
  monitor.progress(1, "registration");
  return result;
}

Agreement agreementOf(const Volume<float>& image, const Volume<float>& inTemplate,
                      const Volume<float>& region, const HeadTransform& transform,
                      const DeformationOptions& options) {
  const FieldLevel level = makeLevel(normalised(image), normalised(inTemplate), region,
                                     transform.affine, options.spacing);
  return agreementIn(level, fieldOf(transform, level.grid), options.radius);
}

}  // namespace explica::registration
