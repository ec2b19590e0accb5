// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Coarsening.h"

#include "Explica/Core/StopScope.h"
#include "Explica/Flattening/StarRelaxation.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/Predicates.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

namespace explica::flattening {
namespace {

constexpr int kLargestDegree = 9;    // of a removed vertex: larger stars leave needles
constexpr int kFullestDegree = 14;   // of the vertex that takes over its faces
constexpr double kLevelRatio = 3.5;  // vertices of one level over those of the next

/// Third side of a triangle with two sides and the angle between them; the way through the corner
/// where it is not convex.
double across(double a, double b, double angle) {
  if (angle >= kPi) return a + b;
  return std::sqrt(std::max(0.0, a * a + b * b - 2 * a * b * std::cos(angle)));
}

double angleBetween(double a, double b, double opposite) {
  return std::acos(std::clamp((a * a + b * b - opposite * opposite) / (2 * a * b), -1.0, 1.0));
}

/// Smallest angle over 60 degrees, 0 where the lengths make no triangle.
double qualityOf(double a, double b, double c) {
  if (!(a < b + c && b < c + a && c < a + b)) return 0;
  const double least =
      std::min({angleBetween(a, b, c), angleBetween(b, c, a), angleBetween(c, a, b)});
  return least / (kPi / 3);
}

/// The mesh while vertices leave it.
class Shrinking {
 public:
  Shrinking(const IntrinsicMesh& mesh, const Loop& rim)
      : faces_(mesh.faces),
        lengths_(mesh.lengths),
        alive_(static_cast<std::size_t>(mesh.faces.rows()), true),
        around_(static_cast<std::size_t>(mesh.vertexCount)),
        present_(static_cast<std::size_t>(mesh.vertexCount), false),
        nextOnRim_(static_cast<std::size_t>(mesh.vertexCount), -1),
        rimSize_(rim.size()) {
    for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        around_[faces_(f, k)].push_back(static_cast<std::int32_t>(f));
        if (!present_[faces_(f, k)]) ++count_;
        present_[faces_(f, k)] = true;
      }
    }
    for (std::size_t n = 0; n < rim.size(); ++n) nextOnRim_[rim[n]] = rim[(n + 1) % rim.size()];
  }

  [[nodiscard]] Eigen::Index count() const { return count_; }

  /// One pass over the vertices, those in the smallest stars first, none next to another.
  std::vector<Removal> pass(Eigen::Index smallest, double leastQuality) {
    std::vector<std::pair<double, std::int32_t>> order;
    for (std::size_t v = 0; v < present_.size(); ++v) {
      if (present_[v] && around_[v].size() <= kLargestDegree) {
        order.emplace_back(starSize(static_cast<std::int32_t>(v)), static_cast<std::int32_t>(v));
      }
    }
    std::ranges::sort(order);
    // Only the smaller stars go, so that the level stays even.
    order.resize((order.size() * 2 + 2) / 3);
    std::vector<bool> touched(present_.size(), false);
    std::vector<Removal> removals;
    for (const auto& [size, v] : order) {
      if (count_ <= smallest) break;
      if (touched[v]) continue;
      Removal removal;
      if (!tryRemove(v, leastQuality, removal)) continue;
      for (const std::int32_t u : removal.ring) touched[u] = true;
      removals.push_back(std::move(removal));
    }
    return removals;
  }

  [[nodiscard]] CoarseningLevel snapshot() const {
    CoarseningLevel level;
    const auto faces = std::ranges::count(alive_, true);
    level.mesh.faces.resize(faces, 3);
    level.mesh.lengths.resize(faces, 3);
    level.mesh.vertexCount = static_cast<Eigen::Index>(present_.size());
    Eigen::Index next = 0;
    for (std::size_t f = 0; f < alive_.size(); ++f) {
      if (!alive_[f]) continue;
      level.mesh.faces.row(next) = faces_.row(f);
      level.mesh.lengths.row(next++) = lengths_.row(f);
    }
    if (rimSize_ == 0) return level;
    std::int32_t first = 0;
    while (nextOnRim_[first] < 0) ++first;
    std::int32_t v = first;
    do {
      level.rim.push_back(v);
      v = nextOnRim_[v];
    } while (v != first);
    return level;
  }

 private:
  /// Neighbours of v in the faces' direction, with the lengths of spokes and of ring edges; on the
  /// rim the list is open.
  struct Star {
    Loop ring;
    std::vector<double> spokes, outer;
    std::vector<double> angles;  ///< at v, of face i between ring i and i + 1
    bool open = false;
  };

  [[nodiscard]] double starSize(std::int32_t v) const {
    double sum = 0;
    for (const std::int32_t f : around_[v]) sum += lengths_.row(f).sum();
    return sum;
  }

  [[nodiscard]] Star starOf(std::int32_t v) const {
    Star star;
    star.open = nextOnRim_[v] >= 0;
    const std::size_t degree = around_[v].size();
    std::vector<std::pair<std::int32_t, int>> corners;
    for (const std::int32_t f : around_[v]) {
      int k = 0;
      while (faces_(f, k) != v) ++k;
      corners.emplace_back(f, k);
    }
    std::size_t at = 0;
    if (star.open) {
      for (std::size_t n = 0; n < degree; ++n) {
        if (faces_(corners[n].first, (corners[n].second + 1) % 3) == nextOnRim_[v]) at = n;
      }
    }
    for (std::size_t n = 0; n < degree; ++n) {
      const auto [f, k] = corners[at];
      const std::int32_t to = faces_(f, (k + 2) % 3);
      star.ring.push_back(faces_(f, (k + 1) % 3));
      star.spokes.push_back(lengths_(f, k));
      star.outer.push_back(lengths_(f, (k + 1) % 3));
      star.angles.push_back(
          angleBetween(lengths_(f, k), lengths_(f, (k + 2) % 3), lengths_(f, (k + 1) % 3)));
      if (n + 1 == degree) {
        if (star.open) {
          star.ring.push_back(to);
          star.spokes.push_back(lengths_(f, (k + 2) % 3));
        }
        break;
      }
      for (std::size_t m = 0; m < degree; ++m) {
        if (faces_(corners[m].first, (corners[m].second + 1) % 3) == to) at = m;
      }
    }
    return star;
  }

  [[nodiscard]] bool joined(std::int32_t a, std::int32_t b) const {
    for (const std::int32_t f : around_[a]) {
      for (int k = 0; k < 3; ++k) {
        if (faces_(f, k) == b) return true;
      }
    }
    return false;
  }

  /// The fan of faces that replaces a star, from ring place `centre`.
  struct Fan {
    std::size_t centre = 0;
    std::vector<double> spokes;  ///< from the centre to the ring's places after it, in order
    double quality = -1;
  };

  [[nodiscard]] Fan fanFrom(const Star& star, std::size_t centre) const {
    const std::size_t size = star.ring.size();
    Fan fan;
    fan.centre = centre;
    const double total = std::accumulate(star.angles.begin(), star.angles.end(), 0.0);
    double angle = 0;
    fan.spokes.assign(size, 0);
    fan.quality = kInfinity;
    for (std::size_t n = 1; n < size; ++n) {
      const std::size_t place = star.open && centre > 0 ? centre - n : (centre + n) % size;
      const std::size_t face = star.open && centre > 0 ? place : (centre + n - 1) % size;
      angle += star.angles[face];
      double length = across(star.spokes[centre], star.spokes[place], angle);
      if (!star.open) {
        length = std::min(length, across(star.spokes[centre], star.spokes[place], total - angle));
      }
      const bool edgeOfStar = n == 1 || (!star.open && n + 1 == size);
      fan.spokes[n] = edgeOfStar ? star.outer[n == 1 ? face : (centre + n) % size] : length;
      if (n >= 2) {
        fan.quality =
            std::min(fan.quality, qualityOf(fan.spokes[n - 1], fan.spokes[n], star.outer[face]));
      }
      // A new edge must not join what is joined already.
      if (!edgeOfStar && joined(star.ring[centre], star.ring[place])) fan.quality = -1;
      if (fan.quality < 0) return fan;
    }
    if (around_[star.ring[centre]].size() + size > kFullestDegree + 4) fan.quality = -1;
    return fan;
  }

  bool tryRemove(std::int32_t v, double leastQuality, Removal& removal) {
    const Star star = starOf(v);
    const std::size_t size = star.ring.size();
    if (size < 3 || (star.open && rimSize_ <= 8)) return false;
    Fan best;
    if (star.open) {
      for (const std::size_t centre : {std::size_t{0}, size - 1}) {
        const Fan fan = fanFrom(star, centre);
        if (fan.quality > best.quality) best = fan;
      }
    } else {
      for (std::size_t centre = 0; centre < size; ++centre) {
        const Fan fan = fanFrom(star, centre);
        if (fan.quality > best.quality) best = fan;
      }
    }
    if (best.quality < leastQuality) return false;
    replace(v, star, best, removal);
    return true;
  }

  void replace(std::int32_t v, const Star& star, const Fan& fan, Removal& removal) {
    const std::size_t size = star.ring.size();
    const bool backwards = star.open && fan.centre > 0;
    removal.vertex = v;
    removal.onRim = star.open;
    for (std::size_t n = 0; n < size; ++n) {
      const std::size_t place = backwards ? fan.centre - n : (fan.centre + n) % size;
      removal.ring.push_back(star.ring[place]);
      removal.spokes.push_back(star.spokes[place]);
      if (star.open && n + 1 == size) break;
      removal.outer.push_back(star.outer[backwards ? place - 1 : place]);
    }
    const std::vector<std::int32_t> old = around_[v];
    std::size_t reused = 0;
    for (std::size_t n = 2; n < size; ++n) {
      const std::int32_t f = old[reused++];
      const std::int32_t a = removal.ring[0], b = removal.ring[n - 1], c = removal.ring[n];
      const std::size_t outer = backwards ? fan.centre - n : (fan.centre + n - 1) % size;
      setFace(f, backwards ? std::array{a, c, b} : std::array{a, b, c},
              backwards ? std::array{fan.spokes[n], star.outer[outer], fan.spokes[n - 1]}
                        : std::array{fan.spokes[n - 1], star.outer[outer], fan.spokes[n]});
    }
    for (; reused < old.size(); ++reused) detach(old[reused]);
    if (star.open) {
      const std::int32_t after = star.ring.front(), before = star.ring.back();
      nextOnRim_[before] = after;
      nextOnRim_[v] = -1;
      --rimSize_;
    }
    present_[v] = false;
    around_[v].clear();
    --count_;
  }

  void detach(std::int32_t f) {
    for (int k = 0; k < 3; ++k) std::erase(around_[faces_(f, k)], f);
    alive_[f] = false;
  }

  void setFace(std::int32_t f, const std::array<std::int32_t, 3>& corners,
               const std::array<double, 3>& lengths) {
    detach(f);
    alive_[f] = true;
    for (int k = 0; k < 3; ++k) {
      faces_(f, k) = corners[k];
      lengths_(f, k) = lengths[k];
      around_[corners[k]].push_back(f);
    }
  }

  Faces faces_;
  Positions lengths_;
  std::vector<bool> alive_;
  std::vector<std::vector<std::int32_t>> around_;
  std::vector<bool> present_;
  std::vector<std::int32_t> nextOnRim_;
  std::size_t rimSize_;
  Eigen::Index count_ = 0;
};

using Plane = Eigen::Vector2d;

double cross(const Plane& a, const Plane& b) {
  return a.x() * b.y() - a.y() * b.x();
}

Plane centroidOf(const std::vector<Plane>& polygon) {
  Plane sum = Plane::Zero(), mean = Plane::Zero();
  double area = 0;
  for (const Plane& p : polygon) mean += p / static_cast<double>(polygon.size());
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const Plane p = polygon[n] - mean, q = polygon[(n + 1) % polygon.size()] - mean;
    const double a = cross(p, q);
    area += a;
    sum += a * (p + q);
  }
  return area > 0 ? Plane(mean + sum / (3 * area)) : mean;
}

/// True if every face of v with two neighbours of its ring is positive.
bool seesRing(const std::vector<Plane>& ring, bool open, const Plane& p) {
  for (std::size_t n = 0; n + (open ? 1 : 0) < ring.size(); ++n) {
    if (geometry::orientation(ring[n], ring[(n + 1) % ring.size()], p) <= 0) return false;
  }
  return true;
}

/// The faces about a removed vertex, its ring counter-clockwise.
std::vector<StarFace> starOf(const Removal& removal, const std::vector<Plane>& ring) {
  std::vector<StarFace> star;
  for (std::size_t n = 0; n < removal.outer.size(); ++n) {
    const std::size_t m = (n + 1) % ring.size();
    const double low = 1e-3 * removal.outer[n];
    star.push_back({restFace({removal.spokes[n], removal.outer[n], removal.spokes[m]}, low),
                    ring[n], ring[m]});
  }
  return star;
}

/// The points from which the whole ring is seen, a convex polygon; of an open ring those within its
/// closing edge.
std::vector<Plane> kernelOf(const std::vector<Plane>& ring) {
  Plane low = ring.front(), high = ring.front();
  for (const Plane& p : ring) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  std::vector<Plane> kernel = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  for (std::size_t n = 0; n < ring.size() && !kernel.empty(); ++n) {
    const Plane &a = ring[n], edge = ring[(n + 1) % ring.size()] - a;
    kernel = clipped(kernel, [&](const Plane& p) { return cross(edge, p - a); });
  }
  return kernel;
}

/// Beside the vertex that the removed one merged with.
std::optional<Plane> besideNeighbour(const std::vector<Plane>& ring, bool open,
                                     std::size_t centre) {
  const Plane& from = ring[centre];
  return placeBeside(
      ring, centre, [&](const Plane& p) { return Plane(p - from); },
      [](const Plane& a, const Plane& b) { return std::atan2(cross(a, b), a.dot(b)); },
      [&](const Plane& way, double angle, double share) {
        return Plane(from + share * Plane(Eigen::Rotation2Dd(angle) * way));
      },
      [&](const Plane& p) { return seesRing(ring, open, p); });
}

/// Place of a rim vertex: on the segment from the first to the last of its ring, as near as
/// possible to the wanted share of the way.  Where the rim turns inwards there so sharply that the
/// segment does not see the ring, inside, so that the rim still cannot meet itself.
Plane rimPlace(const std::vector<Plane>& ring, double wanted) {
  constexpr double kMargin = 0.1;      // of the free stretch, kept from its ends
  constexpr double kLeastRoom = 1e-3;  // of the segment
  const Plane from = ring.front(), way = ring.back() - ring.front();
  double low = 0, high = 1;
  for (std::size_t n = 0; n + 1 < ring.size(); ++n) {
    const Plane edge = ring[n + 1] - ring[n];
    const double at0 = cross(edge, from - ring[n]), slope = cross(edge, way);
    if (slope > 0) low = std::max(low, -at0 / slope);
    if (slope < 0) high = std::min(high, -at0 / slope);
    if (slope == 0 && at0 <= 0) high = low;
  }
  const double room = high - low;
  if (room > kLeastRoom) {
    const Plane place =
        from + std::clamp(wanted, low + kMargin * room, high - kMargin * room) * way;
    if (seesRing(ring, true, place)) return place;
  }
  const auto kernel = kernelOf(ring);
  return kernel.size() < 3 ? from : centroidOf(kernel);
}

}  // namespace

std::vector<CoarseningLevel> coarsen(const IntrinsicMesh& mesh, const Loop& rim,
                                     Eigen::Index smallest, bool anyShape) {
  Shrinking shrinking(mesh, rim);
  std::vector<CoarseningLevel> levels = {shrinking.snapshot()};
  Eigen::Index levelCount = shrinking.count();
  double leastQuality = 0.25;
  while (shrinking.count() > smallest) {
    checkpoint();
    const auto removals = shrinking.pass(smallest, leastQuality);
    auto& list = levels.back().removals;
    list.insert(list.end(), removals.begin(), removals.end());
    // Where few vertices can go, poorer shapes are allowed, and then it is enough.
    if (static_cast<Eigen::Index>(removals.size()) * 25 < shrinking.count()) {
      // Some vertex of a closed surface can always go, if only with a face of no area.
      const bool last = rim.empty() && anyShape && leastQuality > 0;
      leastQuality /= 2;
      if (leastQuality < (anyShape ? 1e-6 : 0.03)) {
        if (!last) break;
        leastQuality = 0;
      }
    }
    if (static_cast<double>(shrinking.count()) * kLevelRatio < static_cast<double>(levelCount)) {
      levels.push_back(shrinking.snapshot());
      levelCount = shrinking.count();
    }
  }
  if (!levels.back().removals.empty()) levels.push_back(shrinking.snapshot());
  return levels;
}

Insertion::Insertion(const Loop& rim, Eigen::Index vertexCount, double areaWeight)
    : areaWeight_(areaWeight),
      next_(static_cast<std::size_t>(vertexCount), -1),
      first_(rim.front()) {
  for (std::size_t n = 0; n < rim.size(); ++n) next_[rim[n]] = rim[(n + 1) % rim.size()];
}

bool Insertion::clearOfRim(std::int32_t before, std::int32_t after, const Plane& place,
                           const FlatPositions& flat) const {
  const Plane a = flat.row(before).transpose(), b = flat.row(after).transpose();
  const Plane low = a.cwiseMin(b).cwiseMin(place), high = a.cwiseMax(b).cwiseMax(place);
  const int side = geometry::orientation(a, place, b);
  std::int32_t v = first_;
  do {
    const std::int32_t w = next_[v];
    const Plane p = flat.row(v).transpose(), q = flat.row(w).transpose();
    v = w;
    const bool far =
        (p.cwiseMin(q).array() > high.array()).any() || (p.cwiseMax(q).array() < low.array()).any();
    if (far) continue;
    // No other rim vertex in the triangle, and no rim edge through its two new sides.
    if (w != before && w != after && geometry::orientation(a, place, q) * side >= 0 &&
        geometry::orientation(place, b, q) * side >= 0 &&
        geometry::orientation(b, a, q) * side >= 0) {
      return false;
    }
    if (p == a && q == b) continue;  // the edge that is replaced
    for (const auto& [from, to, shared] : {std::tuple{a, place, a}, std::tuple{place, b, b}}) {
      if (p == shared || q == shared) continue;
      if (geometry::orientation(from, to, p) * geometry::orientation(from, to, q) <= 0 &&
          geometry::orientation(p, q, from) * geometry::orientation(p, q, to) <= 0) {
        return false;
      }
    }
  } while (v != first_);
  return true;
}

bool Insertion::insert(const Removal& removal, FlatPositions& flat) {
  std::vector<Plane> ring;
  for (const std::int32_t v : removal.ring) ring.push_back(flat.row(v).transpose());
  std::vector<StarFace> star = starOf(removal, ring);
  Plane place;
  if (removal.onRim) {
    std::int32_t after = removal.ring.front(), before = removal.ring.back();
    std::size_t centre = 0;
    double wanted = removal.spokes.front() / (removal.spokes.front() + removal.spokes.back());
    if (next_[before] != after) {  // the list runs along the rim: faces lie to its right
      std::swap(before, after);
      std::ranges::reverse(ring);
      centre = ring.size() - 1;
      wanted = 1 - wanted;
      for (StarFace& face : star) {
        std::swap(face.rest.gradient[1], face.rest.gradient[2]);
        std::swap(face.second, face.third);
        for (auto& g : face.rest.gradient) g = std::conj(g);
      }
    }
    place = rimPlace(ring, wanted);
    if (!seesRing(ring, true, place)) {
      const auto beside = besideNeighbour(ring, true, centre);
      if (!beside) return false;
      place = *beside;
    }
    const Plane relaxed = relaxedPlace(star, areaWeight_, place);
    for (double share = 1; share > 0.05; share /= 2) {
      const Plane tried = place + share * (relaxed - place);
      if (!seesRing(ring, true, tried) || !clearOfRim(before, after, tried, flat)) continue;
      place = tried;
      break;
    }
    next_[before] = removal.vertex;
    next_[removal.vertex] = after;
  } else {
    Plane mean = Plane::Zero();
    for (const Plane& p : ring) mean += p / static_cast<double>(ring.size());
    const auto kernel = kernelOf(ring);
    // Halfway between the kernel's middle, which is safe, and that of the neighbours.
    const Plane middle = kernel.size() < 3 ? ring.front() : centroidOf(kernel);
    place = seesRing(ring, false, mean) ? Plane((mean + middle) / 2) : middle;
    if (!seesRing(ring, false, place)) {
      const auto beside = besideNeighbour(ring, false, 0);
      if (!beside) return false;
      place = *beside;
    }
    const Plane relaxed = relaxedPlace(star, areaWeight_, place);
    if (seesRing(ring, false, relaxed)) place = relaxed;
  }
  flat.row(removal.vertex) = place.transpose();
  return true;
}

}  // namespace explica::flattening
