// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "BrainBorder.h"

#include "Explica/Core/Parallel.h"
#include "Filters.h"

#include <algorithm>
#include <cmath>

namespace explica::registration {
namespace {

constexpr double kWhite = 1.15;       // brightest brain; white matter varies by some per cent
constexpr double kBrightest = 1.6;    // fat; what is brighter counts as that
constexpr double kFloor = 1e-3;       // density of what no tissue explains
constexpr double kIndependent = 0.5;  // of the samples along a profile, blurred as images are
constexpr double kSpread = 5;         // mm, of offsets: a template's error in other heads
constexpr double kRoughness = 0.5;    // mm, of an offset beside its neighbours': dura is smooth
constexpr double kRim = 8;            // mm inside the border in which fluid is counted
constexpr double kStep = 1;           // mm between samples
constexpr int kRounds = 5;            // of the field between two updates of the profile's model
constexpr double kSmooth = 1e-3;      // of a gradient beside 1: no foot is found where it vanishes

double normalDensity(double x, const BrightnessLevel& level) {
  const double z = (x - level.mean) / level.deviation;
  return std::exp(-0.5 * z * z) / (level.deviation * std::sqrt(2 * kPi));
}

double below(double z) {
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

/// Densities of brightness in the brain's rim, in the shell beyond it, and anywhere.
struct ProfileModel {
  BrightnessLevel fluid, bone;
  double fluidShare = 0.4;
  double boneShare = 0.7;

  [[nodiscard]] double fluidPart(double r) const { return fluidShare * normalDensity(r, fluid); }
  /// Fluid, or anything between it and white matter: grey and white matter and mixed voxels.
  [[nodiscard]] double brain(double r) const {
    const double tissue =
        below((r - fluid.mean) / fluid.deviation) - below((r - kWhite) / (2 * fluid.deviation));
    return fluidPart(r) + (1 - fluidShare) * std::max(0.0, tissue) / (kWhite - fluid.mean) + kFloor;
  }
  [[nodiscard]] double bonePart(double r) const {
    return boneShare * normalDensity(std::max(r, bone.mean), bone);
  }
  /// Bone, or anything: dura, marrow, fat, muscle.
  [[nodiscard]] double skull(double r) const {
    return bonePart(r) + (1 - boneShare) / kBrightest + kFloor;
  }
  [[nodiscard]] static double anything() { return 1 / kBrightest; }
};

/// Brightness along a normal; sample s covers kStep from (s - 2 reach) * kStep outward.
using Profile = std::vector<float>;

struct Neighbour {
  std::size_t place;
  double weight;
};

/// Smooth Gaussian belief of one offset.
struct Belief {
  double mean = 0, variance = 0;
};

class BorderField {
 public:
  BorderField(const BrainBrightness& brightness, const Volume<float>& distance,
              const BorderOptions& options)
      : options_(options),
        reach_(static_cast<int>(std::lround(options.reach / kStep))),
        shell_(std::max(1, static_cast<int>(std::lround(options.shell / kStep)))) {
    model_.fluid = brightness.fluid;
    model_.bone = brightness.bone;
    placeFeet(distance);
    readProfiles(brightness.relative);
    joinNeighbours();
    belief_.assign(places_.size(), {0, kSpread * kSpread});
  }

  void improve() {
    takeLikelihoods();
    for (int round = 0; round < kRounds; ++round) {
      updateBeliefs();
    }
    updateModel();
  }

  [[nodiscard]] std::vector<BorderPlace> result() {
    for (std::size_t p = 0; p < places_.size(); ++p) {
      places_[p].offset = belief_[p].mean;
      places_[p].deviation = std::sqrt(belief_[p].variance);
      places_[p].open = isOpen(p);
    }
    return std::move(places_);
  }

  [[nodiscard]] bool empty() const { return places_.empty(); }

 private:
  /// Voxels near the border every few mm, moved onto it along the gradient.
  void placeFeet(const Volume<float>& distance) {
    const Grid& grid = distance.grid;
    const double h = grid.spacing.minCoeff();
    const int stride = std::max(1, static_cast<int>(std::lround(options_.apart / h)));
    const auto at = [&](const Point& p) { return valueAt(distance, grid.toIndex(p)); };
    const auto slope = [&](const Point& p) {
      Vector g;
      for (int a = 0; a < 3; ++a) {
        g[a] = (at(p + h * Vector::Unit(a)) - at(p - h * Vector::Unit(a))) / (2 * h);
      }
      return g;
    };
    for (int k = 0; k < grid.size[2]; k += stride) {
      for (int j = 0; j < grid.size[1]; j += stride) {
        for (int i = 0; i < grid.size[0]; i += stride) {
          if (std::abs(distance(i, j, k)) > 0.5 * stride * h) continue;
          Point foot = grid.toWorld(Vector(i, j, k));
          Vector g = slope(foot);
          for (int n = 0; n < 3 && g.squaredNorm() > kSmooth; ++n) {
            foot -= at(foot) * g / g.squaredNorm();
            g = slope(foot);
          }
          const bool found = g.squaredNorm() > kSmooth && std::abs(at(foot)) < 0.5 * h;
          if (found) places_.push_back({foot, g.normalized()});
        }
      }
    }
  }

  void readProfiles(const Volume<float>& relative) {
    const int count = 3 * reach_ + shell_;
    profile_.resize(places_.size());
    parallelFor(places_.size(), 64, [&](std::size_t p) {
      for (int s = 0; s < count; ++s) {
        const Point at = places_[p].foot + (s - 2 * reach_ + 0.5) * kStep * places_[p].outward;
        profile_[p].push_back(valueAt(relative, relative.grid.toIndex(at)));
      }
    });
  }

  void joinNeighbours() {
    neighbours_.resize(places_.size());
    const double width = options_.neighbours;
    parallelFor(places_.size(), 64, [&](std::size_t p) {
      for (std::size_t q = 0; q < places_.size(); ++q) {
        const double squared = (places_[p].foot - places_[q].foot).squaredNorm();
        const double facing = places_[p].outward.dot(places_[q].outward);
        if (p == q || squared > 4 * width * width || facing <= 0) continue;
        neighbours_[p].push_back({q, facing * std::exp(-2 * squared / (width * width))});
      }
    });
  }

  /// Sample of the profile that begins at an offset.
  [[nodiscard]] int sampleAt(double offset) const {
    return 2 * reach_ + static_cast<int>(std::lround(offset / kStep));
  }

  void takeLikelihoods() {
    const int states = 2 * reach_ + 1;
    likelihood_.assign(places_.size(), std::vector<double>(static_cast<std::size_t>(states)));
    parallelFor(places_.size(), 64, [&](std::size_t p) {
      const auto& r = profile_[p];
      std::vector<double> inside(r.size() + 1, 0), beyond(r.size() + 1, 0);
      for (std::size_t s = 0; s < r.size(); ++s) {
        const double x = std::clamp<double>(r[s], 0, kBrightest);
        inside[s + 1] = inside[s] + std::log(model_.brain(x) / ProfileModel::anything());
        beyond[s + 1] = beyond[s] + std::log(model_.skull(x) / ProfileModel::anything());
      }
      for (int state = 0; state < states; ++state) {
        const int s = reach_ + state;
        likelihood_[p][state] = kIndependent * (inside[s] + beyond[s + shell_] - beyond[s]);
      }
    });
  }

  [[nodiscard]] double around(std::size_t p) const {
    double weight = 0, sum = 0;
    for (const Neighbour& n : neighbours_[p]) {
      weight += n.weight;
      sum += n.weight * belief_[n.place].mean;
    }
    return weight > 0 ? sum / weight : mean_;
  }

  void updateBeliefs() {
    std::vector<double> log(static_cast<std::size_t>(2 * reach_ + 1));
    for (std::size_t p = 0; p < places_.size(); ++p) {
      const double near = around(p);
      double most = -kInfinity;
      for (int state = 0; state <= 2 * reach_; ++state) {
        const double x = (state - reach_) * kStep;
        log[state] = likelihood_[p][state] - 0.5 * (x - mean_) * (x - mean_) / (kSpread * kSpread) -
                     0.5 * (x - near) * (x - near) / (kRoughness * kRoughness);
        most = std::max(most, log[state]);
      }
      double total = 0, first = 0, second = 0;
      for (int state = 0; state <= 2 * reach_; ++state) {
        const double x = (state - reach_) * kStep;
        const double weight = std::exp(log[state] - most);
        total += weight;
        first += weight * x;
        second += weight * x * x;
      }
      const double mean = first / total;
      belief_[p] = {mean, std::max(0.0, second / total - mean * mean)};
    }
  }

  /// How often the rim is fluid and the shell bone, and how dark bone is.
  void updateModel() {
    double fluid = 0, rim = 0, bone = 0, shell = 0;
    const int depth = static_cast<int>(std::lround(kRim / kStep));
    for (std::size_t p = 0; p < places_.size(); ++p) {
      const int s = sampleAt(belief_[p].mean);
      for (int d = 1; d <= depth; ++d, ++rim) {
        const double r = profile_[p][s - d];
        fluid += model_.fluidPart(r) / model_.brain(r);
      }
      for (int d = 0; d < shell_; ++d, ++shell) {
        const double r = profile_[p][s + d];
        bone += model_.bonePart(r) / model_.skull(r);
      }
    }
    model_.fluidShare = std::clamp(fluid / rim, 0.05, 0.95);
    model_.boneShare = std::clamp(bone / shell, 0.05, 0.95);
    double sum = 0;
    for (const Belief& belief : belief_) sum += belief.mean;
    mean_ = sum / static_cast<double>(belief_.size());
  }

  /// Brighter than half way from fluid to white matter just inside and just beyond the border.
  [[nodiscard]] bool isOpen(std::size_t p) const {
    const double half = 0.5 * (model_.fluid.mean + 1);
    const int s = sampleAt(belief_[p].mean);
    const auto& r = profile_[p];
    const auto tissue = [&](float x) { return x > half && x < kWhite; };
    return tissue(r[s - 2]) && tissue(r[s - 1]) && tissue(r[s]) && tissue(r[s + 1]);
  }

  BorderOptions options_;
  int reach_, shell_;  ///< samples
  ProfileModel model_;
  std::vector<BorderPlace> places_;
  std::vector<Profile> profile_;
  std::vector<std::vector<Neighbour>> neighbours_;
  std::vector<std::vector<double>> likelihood_;  ///< logarithms, by place and offset
  std::vector<Belief> belief_;
  double mean_ = 0;  ///< of the offsets, mm
};

}  // namespace

std::vector<BorderPlace> findBorder(const BrainBrightness& brightness,
                                    const Volume<float>& distance, const BorderOptions& options) {
  BorderField field(brightness, distance, options);
  if (field.empty()) return {};
  for (int n = 0; n < options.iterations / kRounds; ++n) field.improve();
  return field.result();
}

}  // namespace explica::registration
